"""Supports of a measured line, from the positions and the span length in its record."""

from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np

from pantocheck.conformance.quantities.line_signals import SUPPORT_TOLERANCE_M, supports_inside


def list_line_supports(
    listed: Sequence[float], span_m: float | None, section: tuple[float, float]
) -> tuple[float, ...] | None:
    """Positions of the supports of a section: the listed ones, and one more where their distance exceeds a span.

    Args:
        listed: Positions of the supports in the record [m].
        span_m: Length of the longest span [m]; None if it is not known.
        section: Start and end of the analysis section [m].

    Returns:
        Positions in increasing order [m]; None if the span length is not known.
    """
    if span_m is None:
        return None
    positions = np.unique(np.asarray(listed, dtype=np.float64))
    inside = [float(position) for position in positions[supports_inside(positions, section)]]
    return tuple(sorted((*inside, *_missing_supports(inside, span_m, section)))) if inside else ()


def _missing_supports(inside: list[float], span_m: float, section: tuple[float, float]) -> Iterator[float]:
    start, end = section
    yield from (inside[0] - span_m * (i + 1) for i in range(_spans(inside[0] - start, span_m)))
    yield from (inside[-1] + span_m * (i + 1) for i in range(_spans(end - inside[-1], span_m)))
    for left, right in pairwise(inside):
        spans = int(np.ceil((right - left - SUPPORT_TOLERANCE_M) / span_m))
        yield from (left + (right - left) * i / spans for i in range(1, spans))


def _spans(distance: float, span_m: float) -> int:
    """Number of whole spans in a distance [m]; a support at the section limit belongs to the section."""
    return max(0, int((distance + SUPPORT_TOLERANCE_M) // span_m))
