"""Tools of several kernels: small linear algebra, interpolation, threads, compilation with numba."""
