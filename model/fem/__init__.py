"""Finite elements of a line: beams, mesh, connectors, global matrices."""
