"""Modes of a line and modal damping."""
