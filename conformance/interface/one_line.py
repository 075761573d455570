"""Values of the Python interface in one line, for the prompt of an interpreter and for notebooks."""

import textwrap

LONGEST_DESCRIPTION = 160
"""Longest line that describes a value: two lines of a terminal of 80 columns."""


def describe_in_one_line(value: object, *facts: str) -> str:
    """Class of a value with facts about it, shortened to one line."""
    return f"<{type(value).__name__} {textwrap.shorten(', '.join(facts), LONGEST_DESCRIPTION, placeholder=' ...')}>"
