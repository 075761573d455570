"""Criteria as tests of pytest."""
