"""Comparison of a static record with the model of its line."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pantocheck.conformance.cases.case import json_digest
from pantocheck.conformance.comparison.comparison_limits import ComparisonLimit, grade_difference, unit_of_difference
from pantocheck.conformance.comparison.static_record import StaticRecord, StaticSidecar
from pantocheck.conformance.core.array_types import IntegerArray, RealArray
from pantocheck.conformance.core.criterion import Criterion
from pantocheck.conformance.core.input_error import InputError
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

# Differences between measured static values and those of a model: outliers, gaps, refusal of units, and criteria.


CRITERIA: dict[StaticQuantity, StaticValue] = {
    "elasticity_difference_mm_N": "elasticity",
    "elasticity_difference_pct": "elasticity",
    "contact_wire_height_difference_mm": "contact_wire_height",
}
"""Compared values by the criterion: largest absolute difference between model and measurement."""

MOST_NAMED_GAPS = 5
"""Largest number of gaps that a reason names."""

OUTLIER_SCALES = 5.0
"""Distance of an outlier from the median difference in standard deviations."""
SMALLEST_SCATTER = 0.01
"""Smallest standard deviation of a search for outliers, relative to the median elasticity."""
SMALLEST_HEIGHT_SCATTER_M = 0.001
"""Smallest standard deviation of a search for outliers of contact wire heights [m]."""
LARGEST_RATIO = 5.0
"""Largest ratio between median elasticities of measurement and model; the smallest ratio of two units is 10."""
LARGEST_HEIGHT_DIFFERENCE_M = 0.5
"""Largest median difference of contact wire heights [m]."""
SAME_POSITION_M = 1e-6
"""Distance between equal positions [m]."""

NORMAL_SCALE = 1.4826
"""Standard deviation over median absolute deviation of a normal distribution."""


@dataclass(frozen=True)
class ValuePair:
    """Measured values of one kind beside those of the model, by increasing position; n values each [m/N or m]."""

    position: RealArray
    """Positions along the line [m]."""
    measured: RealArray
    model: RealArray
    fine_model: RealArray
    """Values of the model with elements of half the length."""
    row: IntegerArray
    """Rows of the table, from 1."""
    missing_row: IntegerArray
    """Rows without a value, (k,)."""


def find_static_outliers(name: StaticValue, difference: RealArray, model: RealArray) -> IntegerArray:
    """Find differences that lie far from the median difference.

    The standard deviation follows from the median absolute deviation, which outliers do not change. It is at least the
    rounding of a good measurement, so that exact data have no outliers.

    Args:
        name: Kind of the values.
        difference: Differences, (n,) [m/N or m].
        model: Values of the model, (n,) [m/N or m].

    Returns:
        Indices of the outliers.
    """
    floor = SMALLEST_SCATTER * np.median(model) if name == "elasticity" else SMALLEST_HEIGHT_SCATTER_M
    distance = np.abs(difference - np.median(difference))
    scale = max(NORMAL_SCALE * float(np.median(distance)), float(floor))
    return np.flatnonzero(distance > OUTLIER_SCALES * scale)


def find_static_gaps(position: RealArray, section: tuple[float, float], largest: float) -> list[tuple[float, float]]:
    """Find the parts of a section in which neighbouring measured positions are too far apart.

    Args:
        position: Positions with a measured value, increasing, (n,) [m].
        section: Start and end of the evaluated section [m].
        largest: Largest permitted distance, also from the ends of the section [m].

    Returns:
        Start and end of each gap [m].
    """
    inside = position[select_section(position, section)]
    limits = np.concatenate([section[:1], inside, section[1:]])
    wide = np.flatnonzero(np.diff(limits) > largest + SAME_POSITION_M)
    return [(float(limits[i]), float(limits[i + 1])) for i in wide]


def select_section(position: RealArray, section: tuple[float, float]) -> NDArray[np.bool_]:
    """Whether each position lies in a section, ends included."""
    start, end = section
    return np.asarray((position >= start - SAME_POSITION_M) & (position <= end + SAME_POSITION_M))


def refuse_other_unit(record: StaticRecord, name: StaticValue, measured: RealArray, model: RealArray) -> None:
    """Refuse values whose unit or datum is evidently not that of the column or of the sidecar.

    Args:
        record: Record of the values.
        name: Kind of the values.
        measured: Measured values, (n,) [m/N or m].
        model: Values of the model, (n,) [m/N or m].

    Raises:
        InputError: The median elasticity is several times that of the model, or the median height differs by
            decimetres.
    """
    where = f"record '{record.source}', {name.replace('_', ' ')}"
    if name == "elasticity":
        ratio = float(np.median(measured) / np.median(model))
        if not 1 / LARGEST_RATIO <= ratio <= LARGEST_RATIO:
            raise InputError(
                where,
                f"the median is {ratio:.3g} times that of the model",
                "Check the unit at the end of the column name: elasticity_mm_N, elasticity_mm_kN, elasticity_mm_daN.",
            )
        return
    difference = float(np.median(measured - model))
    datum = record.sidecar.datum_m + difference
    if abs(difference) > LARGEST_HEIGHT_DIFFERENCE_M:
        raise InputError(
            where,
            f"the median is {difference:.4g} m above that of the model",
            f"Check the unit of the column, or give datum_m = {datum:.4g} in the sidecar if the table counts "
            "heights from the rail.",
        )


def grade_static_difference(
    limit: ComparisonLimit, pairs: Mapping[StaticValue, ValuePair], sidecar: StaticSidecar, section: tuple[float, float]
) -> Criterion:
    """Grade the largest difference in the evaluated section.

    The criterion is skipped unless the whole section was measured at the distances that the sidecar states, so that
    no row can be left out unnoticed.

    Args:
        limit: Largest accepted absolute difference.
        pairs: Compared values.
        sidecar: Sidecar of the record.
        section: Start and end of the evaluated section [m].

    Returns:
        The criterion.
    """
    name = next(value for quantity, value in CRITERIA.items() if quantity == limit.quantity)
    pair = pairs.get(name)
    missing = _find_missing(name, pair, sidecar, section)
    inside = np.zeros(0, dtype=np.int64) if pair is None else np.flatnonzero(select_section(pair.position, section))
    if pair is None or not inside.size:
        return grade_difference(limit, None, missing=missing)
    measured = pair.measured[inside]
    scale = 100 / measured if unit_of_difference(limit.quantity) == "%" else np.full(measured.size, 1e3)
    size, fine_size = (np.abs(values[inside] - measured) * scale for values in (pair.model, pair.fine_model))
    largest = int(np.argmax(size))
    width = sidecar.elasticity_uncertainty_mm_N if name == "elasticity" else sidecar.height_uncertainty_mm
    return grade_difference(
        limit,
        float(size[largest]),
        missing=missing,
        discretisation=abs(float(size[largest]) - float(fine_size.max())),
        measurement=None if width is None else width / 1e3 * float(scale[largest]),
        place=f", at {pair.position[inside][largest]:g} m",
    )


def _find_missing(
    name: StaticValue, pair: ValuePair | None, sidecar: StaticSidecar, section: tuple[float, float]
) -> str | None:
    """Data that a criterion needs and the record does not have; None if it is complete."""
    if pair is None:
        return f"the record has no {name.replace('_', ' ')}"
    if sidecar.largest_distance_m is None:
        return "the sidecar does not state largest_distance_m, so that missing values would not be noticed"
    gaps = find_static_gaps(pair.position, section, sidecar.largest_distance_m)
    if not gaps:
        return None
    names = ", ".join(f"{start:g} and {end:g} m" for start, end in gaps[:MOST_NAMED_GAPS])
    further = f" and {len(gaps) - MOST_NAMED_GAPS} more" if len(gaps) > MOST_NAMED_GAPS else ""
    return f"no measured value between {names}{further}; the stated distance is {sidecar.largest_distance_m:g} m"


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
        mean_difference=float(evaluated.mean()) if evaluated.size else None,
        rms_difference=float(np.sqrt(np.mean(evaluated**2))) if evaluated.size else None,
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
