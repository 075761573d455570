"""Campaigns: many runs of cases with varied inputs, from a file or from the command line."""
