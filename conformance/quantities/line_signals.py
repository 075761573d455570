"""Uplift of the contact wire at the supports, from which quantities are computed."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.quantities.unavailable import ChannelMissing, SupportsMissing

LONGEST_STEP_M = 2.5
"""Longest distance between two samples of a whole stretch [m]: the rest before a passage has at least 20."""

SUPPORT_TOLERANCE_M = 0.5
"""Largest distance between the stated and the real position of a support [m].

Positions are rounded, and surveyed with an accuracy of some decimetres. A span is at least ten times as long, so that
supports are not confused. A support at this distance outside the analysis section still belongs to the section."""

RUN_OUT_M = 5.0
"""Distance that every pantograph runs beyond a support, so that the record contains the largest uplift there [m].

In simulation and measurement, the uplift is largest when a pantograph is within some decimetres of the support."""

UPLIFT_STRETCH_M = 60.0
"""Distance of the last pantograph beyond a support up to which the uplift there counts [m].

Reflections and speeds near the wave speed move the largest uplift by tens of metres. Uplift beyond this distance does
not count, so that it may be missing."""


@dataclass(frozen=True)
class LineSignals:
    """Uplift of the contact wire at the supports."""

    section: tuple[float, float]
    """Start and end of the analysis section [m]."""
    support_position: RealArray | None = None
    """Positions of the supports along the track, (s,) [m], or None."""
    support_uplift: RealArray | None = None
    """Uplift at each support, (s, n) [m], or None; NaN where it is not known."""
    line_supports: tuple[float, ...] | None = None
    """Positions of all supports of the line [m]; None if they are not known."""
    last_position: RealArray | None = None
    """Positions of the last pantograph, (n,) [m], or (s, n) if every support has its own times; None if unknown."""
    fault: str | None = None
    """Reason why no uplift counts; None: it counts."""
    run_end: float | None = None
    """Position to which the last pantograph runs [m], so that a shorter record is recognised; None: unknown."""

    @property
    def supports(self) -> RealArray:
        """Positions of the k supports of the analysis section, both ends included, (k,) [m]; errors as in `uplift`."""
        return self._at_supports[0]

    @property
    def uplift(self) -> RealArray:
        """Uplift at the k supports of the analysis section, both ends included, (k, n) [m]; NaN after the passage.

        Raises:
            ChannelMissing: The record has no uplift, none inside the analysis section, or values are missing that
                count.
        """
        return self._at_supports[1]

    @property
    def largest_uplift(self) -> float:
        """Largest uplift that counts at any of these supports [m]; errors as in `uplift`."""
        return float(self.uplift[self.largest_uplift_index])

    @property
    def largest_uplift_index(self) -> tuple[int, int]:
        """Support and sample of the largest uplift that counts, indices of `uplift`; errors as in `uplift`."""
        support, sample = np.unravel_index(np.argmax(self._counted_uplift), self.uplift.shape)
        return int(support), int(sample)

    @property
    def largest_uplifts(self) -> RealArray:
        """Largest uplift that counts at each of these supports, (k,) [m]; errors as in `uplift`."""
        return np.asarray(self._counted_uplift.max(axis=1))

    @property
    def _counted_uplift(self) -> RealArray:
        supports, uplift, last_position = self._at_supports
        counted = counted_samples(supports, uplift, last_position)
        return np.where(counted, uplift, -np.inf)

    def check_supports(self) -> None:
        """Check that every support of the analysis section has an uplift.

        Raises:
            SupportsMissing: A support has no uplift, the supports of the line are not known, or the record ends too
                early behind the last support: the largest uplift may be missing in the record.
        """
        measured = self.supports
        if self.line_supports is None:
            raise SupportsMissing(
                "the record does not state span_m, the length of the longest span, "
                "so that the supports of the analysis section are not known"
            )
        line = np.asarray(self.line_supports, dtype=np.float64)
        expected = line[supports_inside(line, self.section)]
        distance = np.abs(expected[:, None] - measured).min(axis=1)
        missing = expected[~(distance <= SUPPORT_TOLERANCE_M)]
        if missing.size:
            places = ", ".join(f"{position:g} m" for position in missing[:5])
            stated = np.abs(missing[:, None] - self.support_position).min(axis=1) <= SUPPORT_TOLERANCE_M
            cut = (
                f"; samples are needed from {UPLIFT_STRETCH_M:g} m before to {UPLIFT_STRETCH_M:g} m past the support"
                if stated.any()
                else ""
            )
            raise SupportsMissing(
                f"the record has no uplift at {missing.size} of {expected.size} supports of the analysis section: "
                f"{places}{', ...' if missing.size > 5 else ''}{cut}"
            )
        positions = self._at_supports[2]
        if positions is None:
            return
        ends = np.max(positions, axis=-1, where=np.isfinite(positions), initial=-np.inf)
        pairs = zip(np.broadcast_to(ends, measured.shape), measured, strict=True)
        end, place = max(pairs, key=lambda pair: float(pair[1] - pair[0]))
        needed = place + RUN_OUT_M
        if self.run_end is not None:
            needed = max(needed, min(place + UPLIFT_STRETCH_M, self.run_end - LONGEST_STEP_M))
        if not end >= needed:
            raise SupportsMissing(
                f"the record ends at {end:.6g} m; for the largest uplift of the support at {place:g} m "
                f"it must extend to {needed:g} m"
            )

    @cached_property
    def _at_supports(self) -> tuple[RealArray, RealArray, RealArray | None]:
        if self.fault is not None:
            raise SupportsMissing(self.fault)
        if self.support_position is None or self.support_uplift is None:
            raise ChannelMissing("the record has no uplift at supports")
        # A passing pantograph lifts the wire at every support; an exactly constant channel is that of a dead sensor.
        known = np.isfinite(self.support_uplift)
        lowest, highest = (np.where(known, self.support_uplift, limit) for limit in (np.inf, -np.inf))
        moves = highest.max(axis=1) > lowest.min(axis=1)
        inside = supports_inside(self.support_position, self.section) & moves
        if not inside.any():
            start, end = self.section
            raise ChannelMissing(f"the record has no uplift at a support between {start:g} m and {end:g} m")
        supports, uplift = self.support_position[inside], self.support_uplift[inside]
        own = self.last_position is not None and self.last_position.ndim == 2
        last_position = self.last_position[inside] if own and self.last_position is not None else self.last_position
        gaps = has_gaps(supports, uplift, last_position)
        if gaps.any():
            places = ", ".join(f"{position:g} m" for position in supports[gaps][:5])
            raise SupportsMissing(
                f"the uplift is incomplete at {gaps.sum()} of {gaps.size} supports of the analysis section: "
                f"{places}{', ...' if gaps.sum() > 5 else ''}; it must be known until the last pantograph is "
                f"{UPLIFT_STRETCH_M:g} m past the support"
            )
        return supports, uplift, last_position


def counted_samples(supports: RealArray, uplift: RealArray, last_position: RealArray | None) -> NDArray[np.bool_]:
    """Samples whose uplift counts, (s, n): from the start until the last pantograph is far enough past the support.

    Args:
        supports: Positions of the supports, (s,) [m].
        uplift: Uplift at the supports, (s, n) [m].
        last_position: Positions of the last pantograph, (n,) or (s, n) [m]; None: every sample counts.
    """
    if last_position is None:
        return np.ones(uplift.shape, dtype=np.bool_)
    return np.asarray(last_position <= supports[:, None] + UPLIFT_STRETCH_M)


def has_gaps(supports: RealArray, uplift: RealArray, last_position: RealArray | None) -> NDArray[np.bool_]:
    """Whether values that count are missing at each support, (s,); parameters as of `counted_samples`."""
    return np.asarray((~np.isfinite(uplift) & counted_samples(supports, uplift, last_position)).any(axis=1))


def supports_inside(supports: RealArray, section: tuple[float, float]) -> NDArray[np.bool_]:
    """Whether each support lies inside a section, both ends included; positions [m]."""
    start, end = section
    return (supports >= start - SUPPORT_TOLERANCE_M) & (supports <= end + SUPPORT_TOLERANCE_M)


def stack_supports(rows: Sequence[tuple[RealArray, RealArray]]) -> tuple[RealArray, RealArray]:
    """Uplift and positions of the last pantograph at supports with their own times, (s, n) [m] each.

    Shorter rows end with samples that are missing and do not count.

    Args:
        rows: Uplift, and positions of the last pantograph, of each support, (n,) [m].
    """
    shape = (len(rows), max(uplift.size for uplift, _ in rows))
    together, positions = np.full(shape, np.nan), np.full(shape, np.inf)
    for number, (uplift, last) in enumerate(rows):
        together[number, : uplift.size], positions[number, : uplift.size] = uplift, last
    return together, positions
