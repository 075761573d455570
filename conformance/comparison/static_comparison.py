"""Comparison of a static record with the model of its line."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from pantocheck.conformance.cases.case import json_digest
from pantocheck.conformance.comparison.comparison_limits import ComparisonLimit
from pantocheck.conformance.comparison.static_differences import (
    CRITERIA,
    ValuePair,
    find_static_outliers,
    grade_static_difference,
    refuse_other_unit,
    select_section,
)
from pantocheck.conformance.comparison.static_record import StaticRecord
from pantocheck.conformance.core.array_types import IntegerArray, RealArray
from pantocheck.conformance.core.validation_messages import name_rows
from pantocheck.conformance.core.verdicts import worst_verdict
from pantocheck.conformance.grading.results_building import build_suite
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.line.geometry import Geometry
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.results.comparison_format import (
    ComparedSource,
    ComparedValues,
    SpanDifferences,
    StaticComparison,
    StaticQuantity,
    StaticValue,
)
from pantocheck.conformance.runs.static_quantities import sample_span
from pantocheck.model import DiscretisedLine, discretise
from pantocheck.model.statics.elasticity import rest_height, static_uplift

LISTED_ROWS = 20
"""Largest number of rows that a caveat names."""

MILLI = 1e3
"""Millimetres in a metre: elasticities are reported in mm/N, heights in mm."""


@dataclass(frozen=True)
class _LineModel:
    """Line in finite elements, and the static forces of its elasticity."""

    line: DiscretisedLine
    forces: tuple[float, ...]

    def compute(self, name: StaticValue, position: RealArray) -> RealArray:
        """Contact wire height [m], or elasticity [m/N]: difference of uplifts over difference of forces."""
        if name == "contact_wire_height":
            return rest_height(self.line, position)
        low, high = (0.0, *self.forces)[-2:]
        before = static_uplift(self.line, position, low) if low else np.zeros(position.size)
        return (static_uplift(self.line, position, high) - before) / (high - low)


def compare_statics(
    record: StaticRecord, line: LineFile, element: float, limits: Sequence[ComparisonLimit]
) -> StaticComparison:
    """Compare a static record with the model of its line.

    Args:
        record: Measured values.
        line: Content of the line file.
        element: Largest element length [m].
        limits: Largest accepted differences, from `build_tolerances`.

    Returns:
        Content of static_comparison.json.

    Raises:
        InputError: A column is evidently in another unit, or counts heights from another datum.
    """
    catenary, sidecar = build_catenary(line), record.sidecar
    model, fine_model = (
        _LineModel(discretise(catenary, length), sidecar.force_N or ()) for length in (element, element / 2)
    )
    spans = sidecar.evaluated_spans or (1, line.geometry.spans)
    section = line.geometry.section(*spans)
    pairs = {name: _pair_values(record, name, model, fine_model) for name in record.values}
    criteria = tuple(grade_static_difference(limit, pairs, sidecar, section) for limit in limits)
    values = tuple(_describe(name, pair, line.geometry, section, model) for name, pair in pairs.items())
    return StaticComparison(
        suite=build_suite(),
        model=ComparedSource(name=line.title, digest=json_digest(line.model_dump(mode="json"))),
        record=ComparedSource(name=record.source, digest=record.digest),
        verdict=worst_verdict(criterion.verdict for criterion in criteria),
        element_m=element,
        force_N=sidecar.force_N or (),
        evaluated_spans=spans,
        evaluated_m=section,
        largest_distance_m=sidecar.largest_distance_m,
        values=values,
        criteria=criteria,
        warnings=tuple(_list_warnings(values, limits)),
        note=sidecar.note,
    ).rounded()


def build_tolerances(stated: Mapping[StaticQuantity, float | None]) -> tuple[ComparisonLimit, ...]:
    """Limits of the differences for which the user states a tolerance."""
    return tuple(
        ComparisonLimit(quantity=quantity, upper=tolerance)
        for quantity, tolerance in stated.items()
        if tolerance is not None
    )


def _list_warnings(values: Sequence[ComparedValues], limits: Sequence[ComparisonLimit]) -> Iterator[str]:
    """Caveats: values without tolerance, missing or far from the others."""
    graded = {value for quantity, value in CRITERIA.items() for limit in limits if limit.quantity == quantity}
    for part in values:
        name = part.name.replace("_", " ")
        if graded and part.name not in graded:
            yield f"{name}: no tolerance was given, so that the differences are not graded"
        if part.missing_rows:
            yield f"{name}: no value in {_name_rows(part.missing_rows)}"
        if part.outlier_rows:
            yield (
                f"{name}: the differences of {_name_rows(part.outlier_rows)} are outliers among those of the record; "
                "they count"
            )


def _name_rows(rows: tuple[int, ...]) -> str:
    return name_rows(np.array(rows), LISTED_ROWS)


def _pair_values(record: StaticRecord, name: StaticValue, model: _LineModel, fine_model: _LineModel) -> ValuePair:
    """Measured values of one kind, and those of the model with two meshes."""
    measured = record.values[name]
    present = np.flatnonzero(np.isfinite(measured))
    position = record.position[present]
    computed = model.compute(name, position)
    refuse_other_unit(record, name, measured[present], computed)
    return ValuePair(
        position=position,
        measured=measured[present],
        model=computed,
        fine_model=fine_model.compute(name, position),
        row=record.row[present],
        missing_row=np.sort(record.row[np.isnan(measured)]),
    )


def _describe(
    name: StaticValue, pair: ValuePair, geometry: Geometry, section: tuple[float, float], model: _LineModel
) -> ComparedValues:
    """Part of the report on one kind of values."""
    difference, inside = pair.model - pair.measured, select_section(pair.position, section)
    evaluated = MILLI * difference[inside]
    outliers = find_static_outliers(name, difference, pair.model)
    spans = _list_spans(pair, geometry)
    curve = _place_curve(name, spans, model)
    return ComparedValues(
        name=name,
        unit="mm/N" if name == "elasticity" else "mm",
        row=tuple(map(int, pair.row)),
        position_m=tuple(pair.position),
        measured=tuple(MILLI * pair.measured),
        model=tuple(MILLI * pair.model),
        difference=tuple(MILLI * difference),
        missing_rows=tuple(map(int, pair.missing_row)),
        outlier_rows=tuple(sorted(map(int, pair.row[outliers]))),
        mean_difference=float(evaluated.mean()) if evaluated.size else 0.0,
        rms_difference=float(np.sqrt(np.mean(evaluated**2))) if evaluated.size else 0.0,
        spans=spans,
        curve_position_m=tuple(curve),
        curve=tuple(MILLI * model.compute(name, curve)),
    )


def _place_curve(name: StaticValue, spans: tuple[SpanDifferences, ...], model: _LineModel) -> RealArray:
    """Positions of the curve of the model: the nodes of the mesh for heights, few for elasticities, which cost time."""
    nodes = model.line.mesh.position
    positions = [
        np.append(sample_span(span.start_m, span.end_m), span.end_m)
        if name == "elasticity"
        else nodes[(nodes >= span.start_m) & (nodes <= span.end_m)]
        for span in spans
        if span.values
    ]
    return np.concatenate(positions)


def _list_spans(pair: ValuePair, geometry: Geometry) -> tuple[SpanDifferences, ...]:
    """Differences span by span; a value at a support belongs to the span that begins there."""
    number = np.clip(np.searchsorted(geometry.span_limits, pair.position, side="right"), 1, geometry.spans)
    return tuple(_describe_span(n, geometry, pair, np.flatnonzero(number == n)) for n in range(1, geometry.spans + 1))


def _describe_span(number: int, geometry: Geometry, pair: ValuePair, index: IntegerArray) -> SpanDifferences:
    start, end = geometry.span(number)
    if not index.size:
        return SpanDifferences(
            number=number, start_m=start, end_m=end, values=0, measured=None, model=None,
            mean_difference=None, largest_difference=None,
        )  # fmt: skip
    measured, model = MILLI * pair.measured[index], MILLI * pair.model[index]
    difference = model - measured
    return SpanDifferences(
        number=number,
        start_m=start,
        end_m=end,
        values=index.size,
        measured=(measured.min(), measured.max()),
        model=(model.min(), model.max()),
        mean_difference=difference.mean(),
        largest_difference=difference[np.argmax(np.abs(difference))],
    )
