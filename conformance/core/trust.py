"""Trust in a number: the kind of its source decides whether the number may decide a verdict."""

from typing import Literal, get_args

Trust = Literal["primary", "secondary", "provisional"]
"""`primary`: read in the document that defines it; `secondary`: printed in another public source;
`provisional`: not traced to a printed source; it counts only if the user lowers the required trust."""

Own = Literal["own"]
"""Limit or tolerance of the user, whatever source it names: it decides a verdict, and never that of the library."""

LimitTrust = Trust | Own
"""Trust in a limit of a file."""

Computed = Literal["computed"]
"""Converged solution, confirmed by a second formulation: it limits the verification only, and no user can select it."""

LEVELS: tuple[Trust, ...] = get_args(Trust)


def decides_verdict(trust: LimitTrust | Computed | None, lowest: Trust | Computed) -> bool:
    """Whether a limit of this trust decides a verdict, if `lowest` is the lowest trust that counts.

    With `computed`, computed limits count and no others; with any other level, computed limits do not count. The user's
    own limits, and bounds without a trust, which are those of a baseline, count with every other level.
    """
    if trust is None or trust == "own":
        return lowest != "computed"
    if trust == "computed" or lowest == "computed":
        return trust == lowest
    return LEVELS.index(trust) <= LEVELS.index(lowest)


StudiedPart = Literal["wires", "droppers", "supports", "damping", "pantograph", "contact", "run"]
"""Part of a case to which an input belongs."""
