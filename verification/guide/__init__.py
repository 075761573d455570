"""Verification and validation guide: computations of its parts, and the driver that stores them."""
