"""Comparison of the line of the record with the line of a fit.

A fit with another line pairs modes that do not correspond, and its confidence intervals do not include this error.
"""

from collections.abc import Iterator, Sequence
from itertools import pairwise

from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.drops.drop_record import UNKNOWN_LINE
from pantocheck.conformance.drops.mode_matching import KIND_OF_WIRE, find_wire
from pantocheck.conformance.results.damping_format import LineComparison, LineDifference
from pantocheck.conformance.results.identified_modes import MeasuredLine, Mode
from pantocheck.model import Catenary, Kind

SPAN_TOLERANCE = 0.1
"""Largest difference between the lengths of a span [m]; it changes the frequencies of the span by about 0.2 %."""

TENSION_TOLERANCE = 0.01
"""Largest relative difference between the tensions of a wire [-]; it changes a fitted coefficient by about 1 %."""

SensorFacts = tuple[int, str, float | None]
"""Number of a sensor, its wire in the record, and its position [m]; None if not known."""


def compare_line(modes: Sequence[Mode], line: Catenary) -> LineComparison:
    """Compare spans, tensions and sensor positions of the records of identified modes with a line."""
    records: dict[MeasuredLine, list[str]] = {}
    for mode in modes:
        records.setdefault(mode.line or UNKNOWN_LINE, []).append(mode.record)
    differences, missing = [], []
    for measured, names in records.items():
        prefix = f"{', '.join(sorted(set(names)))}: " if len(records) > 1 else ""
        facts = (*_compare_spans(measured, line), *_compare_tensions(measured, line))
        differences += [row.model_copy(update={"fact": prefix + row.fact}) for row in facts]
        missing += [prefix + fact for fact in _list_missing(measured)]
    sensors = sorted({(s.sensor, s.wire, s.position_m) for mode in modes for s in mode.sensor_shape}, key=str)
    return _add_sensors(differences, missing, sensors, line)


def compare_record_line(measured: MeasuredLine, sensors: Sequence[SensorFacts], line: Catenary) -> LineComparison:
    """Compare spans, tensions and sensor positions of one record with a line."""
    differences = [*_compare_spans(measured, line), *_compare_tensions(measured, line)]
    return _add_sensors(differences, list(_list_missing(measured)), sensors, line)


def refuse_other_line(comparison: LineComparison, source: str) -> None:
    """Refuse a line that is not the line of the record; `source` is the name of the file of the modes.

    Raises:
        InputError: The comparison has differences; the message names all of them.
    """
    if comparison.differences:
        raise InputError(
            source,
            f"the line of the record is not that of --line: {list_differences(comparison.differences)}",
            "Name the line of the record with --line. The option --other-line permits another line and marks the "
            "result.",
        )


def warn_about_line(comparison: LineComparison) -> tuple[str, ...]:
    """Warnings about the line of a fit; none for a consistent one."""
    warnings = []
    if comparison.differences:
        warnings.append(
            "The line of the fit is not the line of the record, so that the errors of the coefficients can exceed "
            f"their intervals: {list_differences(comparison.differences)}."
        )
    if comparison.refuted:
        warnings.append(f"The natural frequencies contradict the line: {list_differences(comparison.refuted)}.")
    if comparison.missing:
        warnings.append(
            "The line of the fit is not confirmed, because the modes do not state all properties of the line of the "
            f"record: {'; '.join(comparison.missing)}."
        )
    return tuple(warnings)


def list_differences(differences: Sequence[LineDifference]) -> str:
    """Differences as text in one line."""
    return "; ".join(f"{row.fact} is {row.record} in the record, {row.line} on the line" for row in differences)


def _add_sensors(
    differences: list[LineDifference], missing: list[str], sensors: Sequence[SensorFacts], line: Catenary
) -> LineComparison:
    """Comparison of a line with the differences and missing facts of the sensors, too."""
    for number, wire, position in sensors:
        if wire not in KIND_OF_WIRE or position is None:
            missing.append(f"wire and position of sensor {number}")
        else:
            differences += _compare_sensor(number, wire, position, line)
    state = "contradicted" if differences else "unconfirmed" if missing else "consistent"
    return LineComparison(state=state, differences=tuple(differences), missing=tuple(dict.fromkeys(missing)))


def _compare_spans(measured: MeasuredLine, line: Catenary) -> Iterator[LineDifference]:
    if not measured.spans_m:
        return
    spans = _span_lengths(line)
    if len(spans) != len(measured.spans_m):
        yield LineDifference(fact="number of spans", record=str(len(measured.spans_m)), line=str(len(spans)))
    numbers: dict[tuple[float, float], list[str]] = {}
    for number, (length, here) in enumerate(zip(measured.spans_m, spans, strict=False), 1):
        if abs(length - here) > SPAN_TOLERANCE:
            numbers.setdefault((length, round(here, 6)), []).append(str(number))
    for (length, here), spans_with_it in numbers.items():
        fact = f"length of span {', '.join(spans_with_it)}"
        yield LineDifference(fact=fact, record=f"{length:g} m", line=f"{here:g} m")


def _compare_tensions(measured: MeasuredLine, line: Catenary) -> Iterator[LineDifference]:
    for kind, tension in (
        (Kind.CONTACT_WIRE, measured.contact_wire_tension_N),
        (Kind.MESSENGER_WIRE, measured.messenger_wire_tension_N),
    ):
        here = next((wire.tension for wire in line.wires if wire.kind is kind), None)
        if tension is not None and (here is None or abs(tension - here) > TENSION_TOLERANCE * here):
            name = kind.replace("_", " ")
            found = f"no {name}" if here is None else f"{here:g} N"
            yield LineDifference(fact=f"tension of the {name}", record=f"{tension:g} N", line=found)


def _compare_sensor(number: int, wire: str, position: float, line: Catenary) -> Iterator[LineDifference]:
    kind = KIND_OF_WIRE[wire]
    if find_wire(line, kind, position) is None:
        ends = [(w.start, w.end) for w in line.wires if w.kind is kind]
        name = kind.replace("_", " ")
        reach = f"{min(ends)[0]:g} m to {max(end for _, end in ends):g} m" if ends else f"no {name}"
        yield LineDifference(fact=f"position of sensor {number} on the {name}", record=f"{position:g} m", line=reach)


def _list_missing(measured: MeasuredLine) -> Iterator[str]:
    if not measured.spans_m:
        yield "lengths of the spans"
    if measured.contact_wire_tension_N is None:
        yield "tension of the contact wire"
    if measured.messenger_wire_tension_N is None:
        yield "tension of the messenger wire"


def _span_lengths(line: Catenary) -> list[float]:
    """Lengths of the spans of a line [m], between its supports and the outermost ends of its contact wires."""
    start, end = min(wire.start for wire in line.contact_wires), max(wire.end for wire in line.contact_wires)
    supports = {support.position for support in line.messenger_supports}
    return [b - a for a, b in pairwise(sorted({start, end, *supports}))]
