"""Suggestions for an unknown name."""

from collections.abc import Sequence
from difflib import get_close_matches


def suggest_names(name: str, known: Sequence[str], prefix: str = "") -> str:
    """Sentence with the known names that resemble an unknown name, behind a prefix, or with the first known names."""
    # Users often write the last part of an id only.
    tails = {item.rsplit("/", 1)[-1]: item for item in known}
    lowered = {item.lower(): item for item in known}
    # A typing error has one near match; weaker matches are offered as a choice.
    close = get_close_matches(name.lower(), list(lowered), n=1, cutoff=0.9) or get_close_matches(
        name.lower(), list(lowered), n=3, cutoff=0.5
    )
    close = [lowered[match] for match in close]
    if not close and name in tails:
        close = [tails[name]]
    if close:
        return f"Did you mean {' or '.join(prefix + item for item in close)} ?"
    if not known:
        return "None are known."
    return f"Known are: {', '.join(known[:12])}{', ...' if len(known) > 12 else ''}"
