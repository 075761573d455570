"""Finite elements of a line in its initial state."""
