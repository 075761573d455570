"""Faces of the suite: commands, pytest plugin, Python interface."""
