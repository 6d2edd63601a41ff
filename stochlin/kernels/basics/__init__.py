"""Arrays, small linear algebra, interpolation, threads, compile tools: what several kernels share."""
