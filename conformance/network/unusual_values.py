"""Unusual values: a section compared with the others of its track, a passage with the others of its section.

A section that differs in all passages points to the line, such as a wrong tension. A passage that differs points to
the measurement, such as a zero that drifts.
"""

from collections import defaultdict
from collections.abc import Iterator, Mapping
from itertools import chain

import numpy as np

from pantocheck.conformance.results.network_format import SectionGroup, SectionPassage, UnusualValue

COMPARED = ("mean_force_N", "std_force_N")
"""Quantities that are compared."""

FEWEST_SECTIONS, FEWEST_PASSAGES = 8, 3
"""Smallest number of sections of a track, or of passages over a section, among which one can be unusual."""

UNUSUAL_DEVIATION = 4.5
"""Smallest deviation that is listed, in robust standard deviations: seven of a million Gaussian values exceed it."""

LEAST_SCALE_SHARE = 0.01
"""Smallest robust standard deviation over the expected value: differences of 1 % are never unusual."""

GroupedPassages = list[tuple[SectionGroup, list[SectionPassage]]]
"""Groups with their passages."""


def find_unusual(rows: GroupedPassages) -> list[UnusualValue]:
    """Unusual sections and passages of one track, class of speed, direction and pantograph; the largest first."""
    found = chain.from_iterable((*_find_sections(rows, name), *_find_passages(rows, name)) for name in COMPARED)
    return sorted(found, key=lambda x: (-abs(x.deviation), x.section.from_km, x.run or "", x.quantity))


def _find_sections(rows: GroupedPassages, name: str) -> Iterator[UnusualValue]:
    medians = {i: float(np.median(values)) for i, values in _list_values(rows, name).items()}
    if len(medians) < FEWEST_SECTIONS:
        return
    values = np.array(list(medians.values()))
    expected = float(np.median(values))
    scale = _find_scale(values - expected, expected)
    for i, value in medians.items():
        if abs(value - expected) > UNUSUAL_DEVIATION * scale:
            yield _describe(rows[i][0], None, name, value, expected, scale)


def _find_passages(rows: GroupedPassages, name: str) -> Iterator[UnusualValue]:
    known = {i: values for i, values in _list_values(rows, name).items() if len(values) >= FEWEST_PASSAGES}
    residuals = [np.array(values) - np.median(values) for values in known.values()]
    if not residuals:
        return
    whole = np.concatenate(residuals)
    for i, values in known.items():
        group, passages = rows[i]
        expected = float(np.median(values))
        scale = _find_scale(whole, expected)
        for passage in passages:
            value = passage.values.get(name)
            if value is not None and abs(value - expected) > UNUSUAL_DEVIATION * scale:
                yield _describe(group, passage.run, name, value, expected, scale)


def _list_values(rows: GroupedPassages, name: str) -> Mapping[int, list[float]]:
    found = defaultdict[int, list[float]](list)
    for i, (_, passages) in enumerate(rows):
        for passage in passages:
            if name in passage.values:
                found[i].append(passage.values[name])
    return found


def _find_scale(residuals: np.ndarray, expected: float) -> float:
    """Robust standard deviation of residuals, by the median of their sizes."""
    return max(1.4826 * float(np.median(np.abs(residuals))), LEAST_SCALE_SHARE * abs(expected))


def _describe(
    group: SectionGroup, run: str | None, name: str, value: float, expected: float, scale: float
) -> UnusualValue:
    return UnusualValue(
        section=group.section,
        speed_km_h=group.speed_km_h,
        run=run,
        quantity=name,
        value=value,
        expected=expected,
        deviation=round((value - expected) / scale, 2),
    )
