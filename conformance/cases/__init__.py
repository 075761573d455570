"""Cases, limits, profiles and the library."""
