"""Tools of several kernels: small linear algebra, interpolation, threads, compilation by numba."""
