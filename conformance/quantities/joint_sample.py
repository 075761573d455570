"""Joint sample of the quantities of a case: their possible values, with the correlation between them.

A draw takes one of the runs and sections that were evaluated. It adds a deviation by the length of the record, one by
mesh and time step, one by sampling rate and resolution, and one by each direction of the tolerances of the line. All
quantities share the draw. The sample gives the interval of a value, and the probability that one value, or all values
of a case, lie inside their limits (JCGM 101).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.near_limit import QUANTILE_95
from pantocheck.conformance.core.rounding import round_digits
from pantocheck.conformance.quantities.evaluation import ValuesByOwner
from pantocheck.conformance.quantities.uncertainty import JointSample

DRAWS = 1000
"""Number of draws: a probability of 0.5 is known within 3 %, one of 0.95 within 1.4 %."""

DRAW_DIGITS = 6
"""Significant digits of a draw in results.json."""


@dataclass(frozen=True)
class SampleParts:
    """Parts of a joint sample; quantities by pantograph (0: the line) and name."""

    values: ValuesByOwner
    """Values of the run."""
    members: Sequence[ValuesByOwner] = ()
    """Values of the other starts and sections, each as likely as the run itself."""
    deviations: Mapping[int, Mapping[str, RealArray]] = field(default_factory=dict)
    """Deviations by the length of the record, (DRAWS,)."""
    mesh_changes: Mapping[int, Mapping[str, float]] = field(default_factory=dict)
    """Half-widths by mesh and time step, with the sign of the change to the finer mesh."""
    bounds: Mapping[int, Mapping[str, float]] = field(default_factory=dict)
    """Largest changes by sampling rate and resolution."""
    line_changes: Sequence[Mapping[int, Mapping[str, float]]] = ()
    """Changes by one standard deviation of the line along each principal direction of its tolerances."""


def draw_sample(parts: SampleParts, digest: str) -> JointSample:
    """Draw the joint sample of all quantities with one value.

    The members are a few of all possible ones: their distance from their mean is widened as that of a further
    member of a normal population, by sqrt((n + 1) / (n - 1)). Where a member lacks a quantity, the value of the run
    stands for it.

    Args:
        parts: Parts of the sample; a quantity with mesh and time step alone has no draws.
        digest: SHA-256 in hexadecimal, the seed of the random numbers.
    """
    random = np.random.default_rng(int(digest[:16], 16))
    member = random.integers(0, len(parts.members) + 1, DRAWS)
    mesh = random.standard_normal(DRAWS) / QUANTILE_95
    bound = random.uniform(-1.0, 1.0, DRAWS)
    line = random.standard_normal((len(parts.line_changes), DRAWS))
    scatter = (parts.deviations, parts.bounds, *parts.members, *parts.line_changes)
    sample: dict[int, dict[str, tuple[float, ...]]] = {}
    for owner, quantities in parts.values.items():
        for name, value in quantities.items():
            if isinstance(value, tuple) or not np.isfinite(value):
                continue
            draws = _widen_members(value, [part.get(owner, {}).get(name) for part in parts.members])[member]
            scaled = [(1.0, parts.deviations), (mesh, parts.mesh_changes), (bound, parts.bounds)]
            for factor, changes in (*scaled, *zip(line, parts.line_changes, strict=True)):
                draws = draws + factor * changes.get(owner, {}).get(name, 0.0)
            if np.ptp(draws) > 0 and any(name in part.get(owner, {}) for part in scatter):
                sample.setdefault(owner, {})[name] = tuple(round_digits(draws, DRAW_DIGITS))
    return sample


def _widen_members(value: float, others: Sequence[object]) -> RealArray:
    """Values of the run and of the members, widened about their mean."""
    numbers = np.array([value, *(other if isinstance(other, float | int) else value for other in others)])
    if numbers.size == 1:
        return numbers
    return np.asarray(numbers.mean() + np.sqrt((numbers.size + 1) / (numbers.size - 1)) * (numbers - numbers.mean()))
