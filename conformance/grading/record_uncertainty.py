"""Uncertainty that follows from a record alone: position of the analysis section, and length of the record."""

from collections.abc import Mapping, Sequence

from pantocheck.conformance.cases.start_and_section import shift_section
from pantocheck.conformance.quantities.evaluation import LINE, SectionedSignals, ValuesByOwner
from pantocheck.conformance.quantities.line_signals import LineSignals
from pantocheck.conformance.quantities.pantograph_signals import PantographSignals
from pantocheck.conformance.quantities.stated_quantities import SignalsOutside
from pantocheck.conformance.quantities.uncertainty import Component, Uncertainty
from pantocheck.conformance.records.length_uncertainty import (
    FEWEST_SPANS,
    FEWEST_SPANS_95,
    LengthUncertainty,
    SubRecordRange,
    length_uncertainties,
    uplift_uncertainties,
)
from pantocheck.conformance.records.record_preparation import PreparedRecord

SAMPLE_SAFETY_FACTOR = 1.25
"""Safety factor on the largest change of a few shifted sections or starts, which are a sample of all of them."""

MIN_SECTIONS = 3
"""Smallest number of shifted sections that give a largest change."""

ONE_RUN = Component("not known: the record holds one run")


def assess_uncertainty(record: PreparedRecord, span_m: float) -> Uncertainty:
    """Uncertainty of the quantities of a record without a case.

    Args:
        record: Signals of the record.
        span_m: Length of a span [m].
    """
    return Uncertainty(
        {
            "discretisation": ONE_RUN,
            "start": ONE_RUN,
            "section": shift_component(record, shift_section(record.section, span_m)),
            "length": length_component(record.evaluated_pantographs, record.line, span_m, record.speed),
        }
    )


def shift_component(signals: SectionedSignals, sections: Sequence[tuple[float, float]]) -> Component:
    """Uncertainty from the position of the analysis section: the largest change when it is shifted, widened.

    Args:
        signals: Signals of the record.
        sections: Shifted sections [m, m].
    """
    widths = section_spread(signals, sections)
    if not widths:
        return Component("not known: the record does not extend beyond the analysis section")
    return Component("analysis section shifted by up to three quarters of a span either way", widen_changes(widths))


def length_component(
    pantographs: Mapping[int, PantographSignals | SignalsOutside], line: LineSignals, span_m: float, speed: float
) -> Component:
    """Uncertainty from the length of the record.

    Args:
        pantographs: Signals by number from 1.
        line: Signals of the line.
        span_m: Length of a span [m].
        speed: Speed of the train [m/s].
    """
    found = {number: length_uncertainties(signals, span_m / speed) for number, signals in pantographs.items()}
    if not any(found.values()):
        return Component(f"not known: the analysis section is shorter than {FEWEST_SPANS} spans")
    uplift = uplift_uncertainties(line)
    found = ({LINE: uplift} if uplift else {}) | found
    widths = {owner: {name: x.half_width for name, x in part.items()} for owner, part in found.items()}
    return Component(_describe_length([x for part in found.values() for x in part.items()], span_m), widths)


def _describe_length(found: Sequence[tuple[str, LengthUncertainty]], span_m: float) -> str:
    ranges = [name for name, uncertainty in found if isinstance(uncertainty, SubRecordRange)]
    of_halves = f"range of the values of half records, spans of {span_m:g} m"
    if len(ranges) == len(found):
        return f"{of_halves}; fewer than {FEWEST_SPANS_95} spans are too few for a 95 % interval"
    interval = f"95 % interval from the fluctuations along the record, spans of {span_m:g} m"
    return f"{interval}; {of_halves}, for {', '.join(dict.fromkeys(ranges))}" if ranges else interval


def section_spread(signals: SectionedSignals, sections: Sequence[tuple[float, float]]) -> dict[int, dict[str, float]]:
    """Largest difference of each quantity from its value when the analysis section is shifted.

    Args:
        signals: Signals of the run.
        sections: Start and end of every section of the same length [m, m].

    Returns:
        Spread in the units of the quantities, by pantograph and name; quantities available in fewer than `MIN_SECTIONS`
        sections are left out.
    """
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
