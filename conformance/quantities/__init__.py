"""Quantities: definition, unit, source and computation of every number that can be graded."""
