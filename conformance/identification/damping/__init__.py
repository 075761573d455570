"""Damping model of a line from its identified modes."""
