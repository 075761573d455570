"""Verification of the reference simulator against closed forms: one file per topic."""
