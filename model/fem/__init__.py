"""Finite elements of a line: beams, mesh, connectors, global matrices."""

from pantocheck.model.kernel_cache import provide_kernel_cache

provide_kernel_cache()  # before numba is imported
