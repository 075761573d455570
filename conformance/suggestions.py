"""Suggestions for a name that does not exist."""

from collections.abc import Sequence
from difflib import get_close_matches


def nearest(name: str, known: Sequence[str]) -> str:
    """A sentence that says which known name was probably meant, or which there are."""
    # An id is often given by its last part alone.
    tails = {item.rsplit("/", 1)[-1]: item for item in known}
    lowered = {item.lower(): item for item in known}
    close = [lowered[match] for match in get_close_matches(name.lower(), list(lowered), n=3, cutoff=0.5)]
    if not close and name in tails:
        close = [tails[name]]
    if close:
        return f"Did you mean {' or '.join(close)} ?"
    if not known:
        return "None are known."
    return f"Known are: {', '.join(known[:12])}{', ...' if len(known) > 12 else ''}"
