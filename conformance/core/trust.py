"""Trust in a number: the kind of its source decides whether the number may decide a verdict."""

from typing import Literal, get_args

Trust = Literal["primary", "secondary", "provisional"]
"""`primary`: read in the document that defines it; `secondary`: printed in another public source;
`provisional`: not traced to a printed source; it counts only if the user lowers the required trust."""

Computed = Literal["computed"]
"""Converged solution, confirmed by a second formulation: it limits the verification only, and no user can select it."""

LEVELS: tuple[Trust, ...] = get_args(Trust)


def decides_verdict(trust: Trust | Computed | None, lowest: Trust | Computed) -> bool:
    """Whether a limit of this trust decides a verdict, if `lowest` is the lowest trust that counts.

    With `computed`, computed limits count and no others; with any other level, computed limits do not count. Bounds
    without a trust are those of a baseline: they have no published source, and count with every other level.
    """
    if trust is None:
        return lowest != "computed"
    if trust == "computed" or lowest == "computed":
        return trust == lowest
    return LEVELS.index(trust) <= LEVELS.index(lowest)
