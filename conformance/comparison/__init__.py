"""Comparisons of two sources over one axis."""
