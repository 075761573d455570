"""Measured values of a line beside those of its model."""
