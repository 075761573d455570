"""Values between the suite and a system of another distribution: plain numbers and arrays."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from numpy.typing import ArrayLike


@dataclass(frozen=True)
class DeliveredPassage:
    """Simulated passage of p pantographs in running order, n samples.

    Parameters
    ----------
    time_s : (n,) array_like
        Equidistant times [s].
    position_m : (p, n) or (n,) array_like
        Contact points along the track [m].
    force_N : (p, n) or (n,) array_like
        Contact forces [N], not filtered unless `filter_applied_Hz` says so.
    contact_height_m : (p, n) or (n,) array_like, optional
        Heights of the contact points [m].
    support_position_m : (s,) array_like, optional
        Positions of supports [m].
    support_uplift_m : (s, n) array_like, optional
        Uplift of the contact wire at these supports [m].
    filter_applied_Hz : float, optional
        Cut-off frequency of a low-pass that was applied to the force [Hz].
    static : mapping of str to float
        Quantities of the line at rest, by name.
    notes : tuple of str
        Remarks for the reader of the report.
    """

    time_s: ArrayLike
    position_m: ArrayLike
    force_N: ArrayLike
    contact_height_m: ArrayLike | None = None
    support_position_m: ArrayLike | None = None
    support_uplift_m: ArrayLike | None = None
    filter_applied_Hz: float | None = None
    static: Mapping[str, float] = field(default_factory=dict)
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class CaseSkipped:
    """The system does not run this case; `reason` is one line for the report."""

    reason: str


@dataclass(frozen=True)
class CaseSystem:
    """System under test.

    Parameters
    ----------
    name, version : str
        Name and version in reports.
    run : callable
        Function of a case, as a program receives it in a `run` message (docs/systems.md): all inputs, no limits. It
        returns a `DeliveredPassage` or a `CaseSkipped`.
    """

    name: str
    version: str
    run: Callable[[Mapping[str, Any]], DeliveredPassage | CaseSkipped]


@dataclass(frozen=True)
class SystemFactory:
    """Object of an entry point `pantocheck.systems`, whose name stands before the colon of `--system NAME:TEXT`.

    Parameters
    ----------
    open : callable
        Function of the text behind the colon that returns a `CaseSystem`. Every process that runs cases calls it.
    """

    open: Callable[[str], CaseSystem]
