"""Uncertainty that follows from a record alone: position of the analysis section, and length of the record."""

from collections.abc import Mapping, Sequence

import numpy as np

from pantocheck.conformance.cases.start_and_section import shift_section
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.criterion import ComponentName
from pantocheck.conformance.core.near_limit import BOUNDED_COMPONENTS
from pantocheck.conformance.quantities.evaluation import LINE, ChannelSignals, Value, ValuesByOwner, evaluate_signals
from pantocheck.conformance.quantities.line_signals import LineSignals
from pantocheck.conformance.quantities.pantograph_signals import PantographSignals
from pantocheck.conformance.quantities.stated_quantities import SignalsOutside
from pantocheck.conformance.quantities.uncertainty import DRAWS, Component, SampleParts, Uncertainty, draw_sample
from pantocheck.conformance.records.length_uncertainty import (
    FEWEST_SPANS,
    FEWEST_SPANS_INTERVAL,
    ExtremeInterval,
    LengthUncertainty,
    SpanInterval,
    SubRecordRange,
    draw_deviations,
    length_uncertainties,
    uplift_uncertainties,
)
from pantocheck.conformance.records.record_preparation import PreparedRecord
from pantocheck.conformance.records.record_resolution import resolution_component, sampling_component

SAMPLE_SAFETY_FACTOR = 1.25
"""Safety factor on the largest change of a few shifted sections or starts, which are a sample of all of them."""

MIN_SECTIONS = 3
"""Smallest number of shifted sections that give a largest change."""

ONE_RUN = Component("not known: the record holds one run")


def assess_uncertainty(record: PreparedRecord, span_m: float, digest: str) -> Uncertainty:
    """Uncertainty of the quantities of a record without a case.

    Args:
        record: Signals of the record.
        span_m: Length of a span [m].
        digest: SHA-256 of the samples of the force in hexadecimal, the seed of the bootstrap.
    """
    sections = shift_section(record.section, span_m)
    lengths = find_lengths(record.evaluated_pantographs, record.line, span_m, record.speed)
    components: dict[ComponentName, Component] = {
        "discretisation": ONE_RUN,
        "start": ONE_RUN,
        "section": shift_component(record, sections),
        "length": length_component(lengths, span_m),
        "sampling": sampling_component(record, None),
        "resolution": resolution_component(record),
        "line": Component("does not apply: there is no line file"),
    }
    if record.alignments or record.place_uncertainty:
        components["alignment"] = alignment_component(record)
    parts = SampleParts(
        record.evaluation.values,
        [record.evaluate_section(section).values for section in sections],
        draw_lengths(lengths, digest),
        bounds=add_bounds(components),
    )
    return Uncertainty(components, record.evaluation.values, draw_sample(parts, digest))


def alignment_component(record: PreparedRecord) -> Component:
    """Uncertainty from the clocks of several sources: the largest change inside their 95 % intervals."""
    values, (start, end), distance = record.evaluation.values, record.section, record.place_uncertainty
    others = [evaluate_signals({}, line).values for line in record.shifted_lines]
    if distance:
        others += [record.evaluate_section((start + d, end + d)).values for d in (-distance, distance)]
    widths: dict[int, dict[str, Value]] = {}
    for owner, quantities in values.items():
        depends = bool(distance) or owner == LINE
        for name, value in quantities.items():
            found = [other.get(owner, {}).get(name) for other in others if owner in other] if depends else []
            if isinstance(value, float) and all(isinstance(x, float) for x in found):
                changes = (abs(x - value) for x in found if isinstance(x, float))
                widths.setdefault(owner, {})[name] = max(changes, default=0.0)
    return Component("clocks of the sources at either end of their 95 % intervals", widths)


def add_bounds(components: Mapping[ComponentName, Component]) -> dict[int, dict[str, float]]:
    """Largest changes by sampling rate, resolution and clocks together."""
    bounds: dict[int, dict[str, float]] = {}
    for component in (components[name] for name in BOUNDED_COMPONENTS if name in components):
        for owner, quantities in component.half_widths.items():
            for quantity, width in quantities.items():
                if not isinstance(width, tuple):
                    part = bounds.setdefault(owner, {})
                    part[quantity] = part.get(quantity, 0.0) + width
    return bounds


def shift_component(signals: ChannelSignals, sections: Sequence[tuple[float, float]]) -> Component:
    """Uncertainty from the position of the analysis section: the largest change when it is shifted, widened.

    Args:
        signals: Signals of the record.
        sections: Shifted sections [m, m].
    """
    widths = section_spread(signals, sections)
    if not widths:
        return Component("not known: the record does not extend beyond the analysis section")
    return Component("analysis section shifted by up to three quarters of a span either way", widen_changes(widths))


LengthsByOwner = Mapping[int, Mapping[str, LengthUncertainty]]
"""Uncertainty from the length of a record, by pantograph (0: the line) and name of the quantity."""


def find_lengths(
    pantographs: Mapping[int, PantographSignals | SignalsOutside], line: LineSignals, span_m: float, speed: float
) -> LengthsByOwner:
    """Uncertainty of every quantity from the length of the record; empty for a record of few spans.

    Args:
        pantographs: Signals by number from 1.
        line: Signals of the line.
        span_m: Length of a span [m].
        speed: Speed of the train [m/s].
    """
    found = {number: length_uncertainties(signals, span_m / speed) for number, signals in pantographs.items()}
    if not any(found.values()):
        return {}
    uplift = uplift_uncertainties(line)
    return ({LINE: uplift} if uplift else {}) | found


def draw_lengths(lengths: LengthsByOwner, digest: str) -> dict[int, dict[str, RealArray]]:
    """Joint deviations of the quantities by the length of the record.

    Those of intervals keep their correlation. A range, which states no share of true values, has equally likely
    deviations inside it, without correlation.

    Args:
        lengths: Uncertainties from `find_lengths`.
        digest: SHA-256 in hexadecimal, the seed of the random numbers.
    """
    found = {(owner, name): x for owner, part in lengths.items() for name, x in part.items()}
    intervals = {key: x for key, x in found.items() if isinstance(x, SpanInterval)}
    drawn = draw_deviations(intervals, DRAWS, digest)
    random = np.random.default_rng(int(digest[16:32], 16))
    deviations: dict[int, dict[str, RealArray]] = {}
    for (owner, name), uncertainty in found.items():
        flat = uncertainty.half_width * random.uniform(-1.0, 1.0, DRAWS)
        deviations.setdefault(owner, {})[name] = drawn.get((owner, name), flat)
    return deviations


def length_component(lengths: LengthsByOwner, span_m: float) -> Component:
    """Uncertainty from the length of the record, from `find_lengths`."""
    if not lengths:
        return Component(f"not known: the analysis section is shorter than {FEWEST_SPANS} spans")
    widths = {owner: {name: x.half_width for name, x in part.items()} for owner, part in lengths.items()}
    return Component(_describe_length([x for part in lengths.values() for x in part.items()], span_m), widths)


def _describe_length(found: Sequence[tuple[str, LengthUncertainty]], span_m: float) -> str:
    ranges = [name for name, uncertainty in found if isinstance(uncertainty, SubRecordRange)]
    of_halves = f"range of the values of half records, spans of {span_m:g} m"
    if len(ranges) == len(found):
        return f"{of_halves}; fewer than {FEWEST_SPANS_INTERVAL} spans are too few for an interval of stated coverage"
    interval = f"interval from the fluctuations along the record, measured coverage 89 to 99 %, spans of {span_m:g} m"
    extremes = [name for name, uncertainty in found if isinstance(uncertainty, ExtremeInterval)]
    if extremes:
        interval += f"; interval without a stated share for {', '.join(dict.fromkeys(extremes))}"
    return f"{interval}; {of_halves}, for {', '.join(dict.fromkeys(ranges))}" if ranges else interval


def section_spread(signals: ChannelSignals, sections: Sequence[tuple[float, float]]) -> dict[int, dict[str, float]]:
    """Largest difference of each quantity from its value in other sections [m, m]; at least `MIN_SECTIONS` have it."""
    shifted = [signals.evaluate_section(section).values for section in sections]
    return largest_changes(signals.evaluation.values, shifted, MIN_SECTIONS)


def widen_changes(changes: Mapping[int, Mapping[str, float]]) -> dict[int, dict[str, float]]:
    """Half-widths from the largest changes of a sample, by pantograph and name."""
    return {owner: {name: SAMPLE_SAFETY_FACTOR * x for name, x in part.items()} for owner, part in changes.items()}


def largest_changes(values: ValuesByOwner, others: Sequence[ValuesByOwner], fewest: int) -> dict[int, dict[str, float]]:
    """Largest difference of each quantity from its value in other evaluations.

    Args:
        values: Quantities by pantograph and name.
        others: The same quantities of other runs or sections.
        fewest: Smallest number of evaluations with a quantity; a quantity with fewer is left out.
    """
    changes: dict[int, dict[str, float]] = {}
    for owner, quantities in values.items():
        for name, value in quantities.items():
            found = [other.get(owner, {}).get(name) for other in others]
            numbers = [number for number in found if isinstance(number, float | int)]
            if isinstance(value, float | int) and len(numbers) >= fewest:
                changes.setdefault(owner, {})[name] = float(max(abs(number - value) for number in numbers))
    return changes
