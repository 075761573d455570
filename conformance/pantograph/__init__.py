"""Pantograph files, force laws, responses and fits."""
