"""Assessing a record by a profile: acceptance of a line, or a simulation against a line test."""
