"""Runs of a case on a system, and checks of their records."""
