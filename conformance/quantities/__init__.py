"""Signals, filters, frequency bands and statistics, and the definition of every quantity."""
