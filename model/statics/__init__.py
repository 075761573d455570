"""Static solutions of a line, and its elasticity."""
