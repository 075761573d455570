"""Trust in a number: the kind of its source decides whether the number may decide a verdict."""

from typing import Literal, get_args

Trust = Literal["primary", "secondary", "provisional"]
"""`primary`: read in the document that defines it; `secondary`: printed in another public source;
`provisional`: not traced to a printed source; it counts only if the user lowers the required trust."""

LEVELS: tuple[Trust, ...] = get_args(Trust)


def limit_counts(trust: Trust, lowest: Trust) -> bool:
    """Whether a limit of this trust decides a verdict, if `lowest` is the lowest trust that counts."""
    return LEVELS.index(trust) <= LEVELS.index(lowest)
