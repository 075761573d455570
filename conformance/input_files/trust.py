"""Trust in a number: its source decides whether it may carry a verdict."""

from typing import Literal, get_args

Trust = Literal["primary", "secondary", "provisional"]
"""`primary`: read in the document that defines it; `secondary`: printed in another public source;
`provisional`: not traced to any printed source, so informative unless the user lowers the required trust."""

LEVELS: tuple[Trust, ...] = get_args(Trust)


def limit_counts(trust: Trust, lowest: Trust) -> bool:
    """Whether a limit of this trust carries a verdict when `lowest` is the lowest level that counts."""
    return LEVELS.index(trust) <= LEVELS.index(lowest)
