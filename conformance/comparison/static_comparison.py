"""Comparison of a static record with the model of its line."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from pantocheck.conformance.array_types import IntegerArray, RealArray
from pantocheck.conformance.cases.case import json_digest
from pantocheck.conformance.cases.geometry import Geometry
from pantocheck.conformance.cases.line_file import LineFile
from pantocheck.conformance.comparison.static_comparison_format import (
    ComparedValues,
    SpanDifferences,
    StaticComparison,
)
from pantocheck.conformance.comparison.static_criteria import grade_tolerance
from pantocheck.conformance.comparison.static_differences import (
    find_static_outliers,
    refuse_other_unit,
    select_section,
)
from pantocheck.conformance.comparison.static_record import StaticRecord, StaticValue
from pantocheck.conformance.comparison.value_pair import ValuePair
from pantocheck.conformance.grading.verdicts import worst_verdict
from pantocheck.conformance.results.results_building import build_suite
from pantocheck.conformance.simulation.catenary_model import build_catenary
from pantocheck.conformance.simulation.static_quantities import sample_span
from pantocheck.model import DiscretisedLine, discretise
from pantocheck.model.statics.elasticity import rest_height, static_uplift

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
    record: StaticRecord, line: LineFile, element: float, tolerances: Mapping[str, float]
) -> StaticComparison:
    """Compare a static record with the model of its line.

    Parameters
    ----------
    record : StaticRecord
        Measured values.
    line : LineFile
        Content of the line file.
    element : float
        Largest element length [m].
    tolerances : mapping of str to float
        Largest accepted differences by name of the criterion, from `static_criteria.CRITERIA`.

    Returns
    -------
    StaticComparison
        Content of static_comparison.json.

    Raises
    ------
    InputError
        A column is evidently in another unit, or counts heights from another datum.
    """
    catenary, sidecar = build_catenary(line), record.sidecar
    model, fine_model = (
        _LineModel(discretise(catenary, length), sidecar.force_N or ()) for length in (element, element / 2)
    )
    spans = sidecar.evaluated_spans or (1, line.geometry.spans)
    section = line.geometry.section(*spans)
    pairs = {name: _pair_values(record, name, model, fine_model) for name in record.values}
    criteria = tuple(
        grade_tolerance(quantity, tolerance, pairs, sidecar, section) for quantity, tolerance in tolerances.items()
    )
    return StaticComparison(
        suite=build_suite(),
        line=line.title,
        line_digest=json_digest(line.model_dump(mode="json")),
        record=record.source,
        record_digest=record.digest,
        verdict=worst_verdict(criterion.verdict for criterion in criteria),
        element_m=element,
        force_N=sidecar.force_N or (),
        evaluated_spans=spans,
        evaluated_m=section,
        largest_distance_m=sidecar.largest_distance_m,
        values=tuple(_describe(name, pair, line.geometry, section, model) for name, pair in pairs.items()),
        criteria=criteria,
        note=sidecar.note,
    ).rounded()


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
    return np.concatenate(positions or [np.zeros(0)])


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
