"""Check of the numbers and curves of a case against its embedded signals: they are computed from the samples again."""

from collections.abc import Iterator, Mapping

import numpy as np
from pydantic import TypeAdapter

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.figure_data import Traces
from pantocheck.conformance.core.packed_samples import MOST_SAMPLES, PackedDamaged, SignalSamples
from pantocheck.conformance.core.results_part import Number
from pantocheck.conformance.documents.authenticity_check import (
    EXACT,
    ROUNDED,
    NumberTree,
    compare_numbers,
    format_exact,
    shorten_details,
)
from pantocheck.conformance.grading.contact_loss_list import build_contact_losses, find_force_places, find_uplift_place
from pantocheck.conformance.grading.results_building import key_by_owner, select_finite
from pantocheck.conformance.quantities.force_quantities import LINE_QUANTITIES, PANTOGRAPH_QUANTITIES
from pantocheck.conformance.quantities.stated_quantities import OVERLAP_QUANTITIES, STATED_QUANTITIES
from pantocheck.conformance.records.evaluated_signals import UnpackedSignals, settling_samples, unpack_signals
from pantocheck.conformance.records.traces import build_pantograph_traces
from pantocheck.conformance.results.results_format import CaseResult

SIGNAL_QUANTITIES = frozenset(
    quantity.name for quantity in (*PANTOGRAPH_QUANTITIES, *STATED_QUANTITIES, *OVERLAP_QUANTITIES, *LINE_QUANTITIES)
)
"""Quantities that follow from the signals of a record."""

RATE_DIGITS = 1e-8
"""Relative tolerance of the sampling rate, which is printed with nine digits."""


MOST_DRAWN = 80_000
"""Largest number of samples of a record whose drawn times, of six digits, each name one sample."""


def check_signals(case: CaseResult) -> Iterator[str]:
    """Contradictions between the embedded signals of a case and its quantities, curves and places."""
    samples = case.signals
    if samples is None:
        return
    stated = {"sampling rate": case.run.rate_Hz, "analysis section": list(case.run.evaluated_m or ())}
    embedded: NumberTree = {"sampling rate": samples.rate_Hz, "analysis section": list(samples.evaluated_m)}
    yield from _compare(stated, embedded, RATE_DIGITS)
    if case.profile is None and samples.excluded_m:
        yield "stretches are left out of the embedded signals, which only a profile can state"
    try:
        signals = unpack_signals(samples, case.run.filter)
        yield from _check_quantities(case.quantities, signals, samples)
        for reading in case.readings:
            if reading.reason is None:
                again = unpack_signals(samples, reading.filter, reading.evaluated_m)
                texts = _check_quantities(reading.quantities, again, samples)
                yield from (f"reading '{reading.id}', {text}" for text in texts)
    except PackedDamaged as error:
        yield f"the embedded signals: {error}"
        return
    yield from _check_curves(case, signals)


def _check_quantities(
    quantities: Mapping[str, Mapping[str, Number]], signals: UnpackedSignals, samples: SignalSamples
) -> Iterator[str]:
    """Every quantity of the signals must be stated with its value, and no other one."""
    computed = key_by_owner(select_finite(signals.evaluation.values))
    if not samples.uplift:
        computed.pop("0", None)
    for owner in dict.fromkeys((*computed, *quantities)):
        if owner == "0" and not samples.uplift:
            continue
        stated = {name: value for name, value in quantities.get(owner, {}).items() if name in SIGNAL_QUANTITIES}
        texts = _compare(stated, computed.get(owner, {}), EXACT)
        yield from (f"pantograph {owner}: {text}" if owner != "0" else text for text in texts)


def _check_curves(case: CaseResult, signals: UnpackedSignals) -> Iterator[str]:
    """Curves, spectra and histograms are rounded to six digits; levels and places are not."""
    supports = {support for trace in case.traces.values() for support in trace.supports_m}
    traces = build_pantograph_traces(signals.pantographs, sorted(supports))
    places = find_force_places(signals.pantographs)
    losses = build_contact_losses(signals.pantographs)
    yield from _compare(_dump_levels(case.traces), _dump_levels(traces), EXACT)
    yield from _compare(_dump("curves of pantograph", case.traces), _dump("curves of pantograph", traces), ROUNDED)
    yield from _compare(_dump("contact losses", case.contact_losses), _dump("contact losses", losses), EXACT)
    if signals.time is not None:
        yield from _check_uplift_curves(case, signals, signals.time)
        places |= find_uplift_place(signals.line, signals.time)
    yield from _compare(_dump("place of an extreme", case.places), _dump("place of an extreme", places), EXACT)


def _check_uplift_curves(case: CaseResult, signals: UnpackedSignals, time: RealArray) -> Iterator[str]:
    """Every drawn point must be that of the signals or, where they are not embedded, below the largest uplift."""
    drawn, samples = {curve.support_m: curve for curve in case.uplift}, case.signals
    if samples is None or time.size > MOST_DRAWN:
        return
    for support in samples.uplift:
        curve, uplift = drawn.get(support.support_m), 1e3 * support.uplift_m.unpack()
        if curve is None or not np.isfinite(uplift).any():
            continue
        points, values = np.array(curve.time_s), np.array(curve.uplift_mm)
        indices = np.rint((points - time[0]) * samples.rate_Hz).astype(int) - support.first
        within = (indices >= 0) & (indices < uplift.size)
        expected = np.where(within, uplift[np.where(within, indices, 0)], values)
        wrong = ~(np.abs(values - expected) <= ROUNDED * np.nanmax(np.abs(uplift)))
        if wrong.any():
            first = int(np.argmax(wrong))
            texts = map(format_exact, (values[first], points[first], expected[first]))
            place = f"uplift at {support.support_m:g} m"
            yield "{}: {} mm at {} s drawn, {} follows from the embedded signals".format(place, *texts)


def _dump(name: str, part: object) -> NumberTree:
    """Part of a result as numbers and texts under a name for messages; an empty one for None."""
    return {name: TypeAdapter(object).dump_python(part or {})}


def _dump_levels(traces: Mapping[str, Traces]) -> NumberTree:
    return {f"drawn levels of pantograph {key}": [trace.mean_N, trace.std_N] for key, trace in traces.items()}


def _compare(stated: NumberTree, computed: NumberTree, tolerance: float) -> tuple[str, ...]:
    if stated == computed:  # most documents were made by the same machine, and curves have thousands of points
        return ()
    differences = compare_numbers(stated, computed, tolerance).differences
    return shorten_details([text.replace("computed", "follows from the embedded signals") for text in differences])


def find_signal_gaps(case: CaseResult) -> Iterator[str]:
    """Missing signals: a record with samples embeds them, unless they are too many."""
    forces = [key for key, values in case.quantities.items() if key != "0" and "mean_force_N" in values]
    sampled = bool(case.traces) or case.run.rate_Hz is not None
    if forces and not sampled and case.record is not None and case.record.state == "consistent":
        yield "the sampling rate is missing, and a record without samples cannot be consistent"
    if not forces or not sampled:
        return
    if case.signals is None:
        if _count_samples(case) <= MOST_SAMPLES:
            yield "the evaluated signals are missing"
        return
    yield from (f"the signals of pantograph {key} are missing" for key in forces if key not in case.signals.pantographs)
    rate = case.signals.rate_Hz
    lengths = [(curve.time_s[-1] - curve.time_s[0]) * rate for curve in case.uplift if curve.time_s]
    has_uplift = any(quantity.name in case.quantities.get("0", {}) for quantity in LINE_QUANTITIES)
    if has_uplift and not case.signals.uplift and (not lengths or max(lengths) < MOST_SAMPLES):
        yield "the signals of the uplift are missing"


def _count_samples(case: CaseResult) -> float:
    """Samples of the force that a case needs: its analysis sections, and the settling of its filters on both sides."""
    run, sections = case.run, [reading.evaluated_m for reading in case.readings]
    if run.evaluated_m is None or run.rate_Hz is None or not run.speed_km_h:
        return 0.0
    sections.append(run.evaluated_m)
    length = max(end for _, end in sections) - min(start for start, _ in sections)
    filters = (run.filter, *(reading.filter for reading in case.readings))
    settling = max(settling_samples(low_pass, run.rate_Hz) for low_pass in filters)
    return length / (run.speed_km_h / 3.6) * run.rate_Hz + 2 * settling
