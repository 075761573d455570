"""From a record to its quantities: what can be computed, and why the rest cannot."""

from collections.abc import Mapping
from dataclasses import dataclass

from pantocheck.conformance.quantities.filters import LowPass
from pantocheck.conformance.quantities.force_quantities import LINE_QUANTITIES, PANTOGRAPH_QUANTITIES
from pantocheck.conformance.quantities.sampling import WHOLE_RECORD
from pantocheck.conformance.quantities.signals import ForceSignals, LineSignals, PantographSignals
from pantocheck.conformance.quantities.unavailable import QuantityUnavailable
from pantocheck.conformance.records.record import Record

Value = float | tuple[float, ...]
"""A number, or one number per dropper or mode."""

LINE = 0
"""In place of a pantograph's number: a quantity of the line itself."""


@dataclass(frozen=True)
class Evaluation:
    """Quantities of a run, by pantograph (from 1 in running order; 0: the line) and name.

    Parameters
    ----------
    values : dict[int, dict[str, Value]]
        What could be computed.
    skipped : dict[int, dict[str, str]]
        Why the others could not.
    """

    values: dict[int, dict[str, Value]]
    skipped: dict[int, dict[str, str]]


def pantograph_signals(record: Record, pantograph: int, low_pass: LowPass) -> PantographSignals:
    """Signals of one pantograph of a record, numbered from 1."""
    at = pantograph - 1
    return PantographSignals(
        rate=record.rate,
        position=record.position[at],
        force=record.force[at],
        evaluated=record.evaluated,
        low_pass=low_pass,
        filter_applied_Hz=record.filter_applied_Hz,
        contact_height=None if record.contact_height is None else record.contact_height[at],
    )


def line_signals(record: Record) -> LineSignals:
    """Signals of the line of a record."""
    return LineSignals(record.evaluated, record.support_position, record.support_uplift)


def evaluate_record(record: Record, low_pass: LowPass) -> Evaluation:
    """Every quantity of a record; one that the record cannot support is skipped with its reason.

    Parameters
    ----------
    record : Record
        Of a run or a measurement.
    low_pass : LowPass
        Filter of the graded force.
    """
    numbered = range(1, record.pantographs + 1)
    return evaluate_signals({i: pantograph_signals(record, i, low_pass) for i in numbered}, line_signals(record))


def evaluate_signals(pantographs: Mapping[int, ForceSignals], line: LineSignals) -> Evaluation:
    """Every quantity of the signals of pantographs, by number, and of a line; what they cannot support is skipped."""
    values: dict[int, dict[str, Value]] = {LINE: {}}
    skipped: dict[int, dict[str, str]] = {LINE: {}}
    for pantograph, signals in pantographs.items():
        values[pantograph], skipped[pantograph] = {}, {}
        for quantity in PANTOGRAPH_QUANTITIES:
            try:
                values[pantograph][quantity.name] = float(quantity.compute(signals, WHOLE_RECORD))
            except QuantityUnavailable as reason:
                skipped[pantograph][quantity.name] = str(reason)
    for line_quantity in LINE_QUANTITIES:
        try:
            values[LINE][line_quantity.name] = line_quantity.compute(line)
        except QuantityUnavailable as reason:
            skipped[LINE][line_quantity.name] = str(reason)
    return Evaluation(values, skipped)
