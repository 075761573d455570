"""Assessing a record by a profile: acceptance of a line, or a simulation against a line test."""

from pantocheck.conformance.assessment.grading import assess
from pantocheck.conformance.assessment.subject import Subject, subject_of

__all__ = ["Subject", "assess", "subject_of"]
