"""Time integration: Newmark steps of wires, connectors, contacts and modal dampers."""

from pantocheck.model.kernel_cache import provide_kernel_cache

provide_kernel_cache()  # before numba is imported
