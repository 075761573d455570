"""Figures of all reports."""
