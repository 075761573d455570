"""Check of the drawn curves of a case against its stated quantities."""

import math
from collections.abc import Iterator, Mapping
from itertools import pairwise

from pantocheck.conformance.core.figure_data import Traces
from pantocheck.conformance.documents.authenticity_check import ROUNDED, format_exact, same_number, select_first
from pantocheck.conformance.quantities.bands import BANDS
from pantocheck.conformance.results.results_format import CaseResult

THINNED_FORCE = 0.02
"""Largest relative difference of the deviation of a thinned 20 Hz curve, sampled ten times per period or more.

On the library cases the difference is below 0.001; a curve of another run differs by more than 0.02."""

THINNED_UPLIFT = 0.02
"""Largest relative difference of the highest point of a thinned uplift curve; on the library cases below 0.003."""

UPLIFT = "max_uplift_at_support_mm"


def check_trace(quantities: Mapping[str, float], trace: Traces) -> Iterator[str]:
    """Contradictions between the curves of a pantograph and its quantities."""
    for drawn, name in ((trace.mean_N, "mean_force_N"), (trace.std_N, "std_force_N")):
        if name in quantities and drawn is not None and not same_number(drawn, quantities[name], ROUNDED):
            yield f"{name} {format_exact(quantities[name])} stated, {format_exact(drawn)} drawn"
    force = trace.force_20_N
    if force:
        yield from _check_extremes(quantities, force)
        yield from _check_deviation(quantities, trace.position_m, force)
    if trace.histogram is not None:
        yield from _check_histogram(quantities, trace.histogram.edges_N, trace.histogram.share_pct)
    yield from _check_bands(quantities, trace.spectrum.frequency_Hz, trace.spectrum.amplitude_N)


def check_uplift(case: CaseResult) -> Iterator[str]:
    """Contradiction between the uplift curves of a case and its largest uplift."""
    stated = [values[UPLIFT] for values in map(select_first, case.quantities.values()) if UPLIFT in values]
    drawn = [value for curve in case.uplift for value in curve.uplift_mm]
    if not stated or not drawn:
        return
    value, highest = max(stated), max(drawn)
    if not highest * (1 - ROUNDED) <= value <= highest * (1 + THINNED_UPLIFT):
        yield f"{UPLIFT} {format_exact(value)} stated, {format_exact(highest)} drawn"


def _check_extremes(quantities: Mapping[str, float], force: list[float]) -> Iterator[str]:
    """The drawn force is thinned: it may miss the extremes, but must not exceed them."""
    slack = ROUNDED * max(map(abs, force))
    if "max_force_N" in quantities and max(force) > quantities["max_force_N"] + slack:
        yield f"max_force_N {format_exact(quantities['max_force_N'])} stated, {format_exact(max(force))} drawn"
    if "min_force_N" in quantities and min(force) < quantities["min_force_N"] - slack:
        yield f"min_force_N {format_exact(quantities['min_force_N'])} stated, {format_exact(min(force))} drawn"


def _check_deviation(quantities: Mapping[str, float], position: list[float], force: list[float]) -> Iterator[str]:
    """The curve itself must have the stated mean and deviation, unless its samples are extremes of a long record."""
    steps = [b - a for a, b in pairwise(position)]
    extremes_alone = not steps or max(steps) > 1.5 * min(steps)
    if extremes_alone or not {"mean_force_N", "std_force_N"} <= quantities.keys():
        return
    mean = math.fsum(force) / len(force)
    deviation = math.sqrt(math.fsum((value - mean) ** 2 for value in force) / len(force))
    stated, slack = quantities["std_force_N"], THINNED_FORCE * max(quantities["std_force_N"], abs(mean) * ROUNDED)
    if abs(deviation - stated) > slack or abs(mean - quantities["mean_force_N"]) > slack:
        texts = map(format_exact, (quantities["mean_force_N"], stated, mean, deviation))
        yield "mean {} and deviation {} stated, {} and {} follow from the drawn curve".format(*texts)


def _check_histogram(quantities: Mapping[str, float], edges_N: list[float], share_pct: list[float]) -> Iterator[str]:
    """Mean, deviation and extremes must follow from the classes within the width of one class."""
    if not same_number(math.fsum(share_pct), 100.0, 1e-3):
        yield "the shares of the drawn histogram do not add up to 100 %"
        return
    centres = [(a + b) / 2 for a, b in pairwise(edges_N)]
    width = max(b - a for a, b in pairwise(edges_N))
    mean = math.fsum(c * p for c, p in zip(centres, share_pct, strict=True)) / 100
    deviation = math.sqrt(math.fsum((c - mean) ** 2 * p for c, p in zip(centres, share_pct, strict=True)) / 100)
    occupied = [pair for pair, share in zip(pairwise(edges_N), share_pct, strict=True) if share > 0]
    expected = {
        "mean_force_N": (mean, width / 2),
        "std_force_N": (deviation, width / 2),
        "min_force_N": (math.fsum(occupied[0]) / 2, width / 2),
        "max_force_N": (math.fsum(occupied[-1]) / 2, width / 2),
    }
    for name, (value, slack) in expected.items():
        if name in quantities and abs(quantities[name] - value) > slack * (1 + 1e-3) + ROUNDED * abs(value):
            yield f"{name} {format_exact(quantities[name])} stated, about {value:.4g} follows from the histogram"


def _check_bands(quantities: Mapping[str, float], frequency: list[float], amplitude: list[float]) -> Iterator[str]:
    """RMS values of the bands must follow from the drawn spectrum by Parseval, if it has all its lines."""
    steps = [b - a for a, b in pairwise(frequency)]
    complete = steps and max(steps) - min(steps) <= ROUNDED * max(frequency)
    if not complete:
        return
    for low, high, name in BANDS:
        # Rounding may have moved a line onto an edge, so that its band is unknown.
        doubtful = any(abs(f - edge) <= ROUNDED * edge for f in frequency for edge in (low, high) if edge)
        if name not in quantities or doubtful:
            continue
        power = sum(a * a / 2 for f, a in zip(frequency, amplitude, strict=True) if low < f <= high)
        if not same_number(quantities[name], math.sqrt(power), ROUNDED):
            yield (
                f"{name} {format_exact(quantities[name])} stated, {format_exact(math.sqrt(power))} follows from the "
                "spectrum"
            )
