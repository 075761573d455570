"""Grading: cases by their limits, records by profiles, results by a baseline."""
