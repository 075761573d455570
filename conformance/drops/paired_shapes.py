"""Shapes of matched modes along the line: computed shapes of the wires, and measured values at the sensors."""

from collections.abc import Sequence

import numpy as np

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.drops.damping_model import (
    MATRICES,
    DampingBasis,
    DampingFit,
    MeasuredModes,
    Term,
    fit_deviation,
    fit_weights,
    solve_weighted,
)
from pantocheck.conformance.drops.mode_matching import KIND_OF_WIRE, MatchedModes, Positions, find_sensor_positions
from pantocheck.conformance.results.damping_format import (
    Coefficient,
    Matching,
    MeasuredDeflection,
    Observability,
    PairedShape,
    PairedShapes,
    Thresholds,
    WireShape,
)
from pantocheck.conformance.results.identified_modes import Mode
from pantocheck.model import Catenary, Kind
from pantocheck.model.description.catenary import Wire

LISTED_GROUPS = (1, 2)
"""Groups of span modes whose shapes are listed."""

LISTED_MODES = 12
"""Largest number of listed modes of a group."""

SHAPE_POINTS = 181
"""Points of a computed shape along its wire: thirty per span of a line of six spans."""

SHAPE_WIRES = ("CW", "MW")
"""Wires whose shapes are listed, by their names in mass-drop records."""


def list_paired_shapes(matched: MatchedModes, line: Catenary) -> PairedShapes:
    """Shapes of the matched modes of the first groups that have at least two sensors.

    A computed shape is scaled to its largest deflection. The measured values are multiplied by the complex factor that
    fits them best to it; their real part is listed.

    Args:
        matched: Identified and computed modes of the line.
        line: The line.

    Returns:
        Shapes in the order of frequency.
    """
    positions = find_sensor_positions(matched.paired, line, "the modes")
    wires = _select_wires(line)
    shapes: list[PairedShape] = []
    for pair, mode in zip(matched.pairs, matched.paired, strict=True):
        listed = sum(shape.group == mode.group for shape in shapes)
        if mode.group in LISTED_GROUPS and listed < LISTED_MODES and len(_list_sensors(mode, positions)) > 1:
            deflection = matched.shapes.shape[pair.computed, :, :, 0]
            curves = [_compute_curve(matched, deflection, name, wire) for name, wire in wires]
            scale = max(max(map(abs, curve.value)) for curve in curves)
            shapes.append(
                PairedShape(
                    measured_Hz=mode.frequency_Hz,
                    group=mode.group,
                    mac=pair.mac,
                    sensors=_scale_measured(matched, mode, positions, deflection / scale),
                    curves=tuple(_scale_curve(curve, scale) for curve in curves),
                )
            )
    ends = {x for wire in line.wires if wire.kind is Kind.CONTACT_WIRE for x in (wire.start, wire.end)}
    supports = ends | {support.position for support in line.messenger_supports}
    return PairedShapes(supports_m=tuple(sorted(supports)), modes=tuple(shapes))


def _list_sensors(mode: Mode, positions: Positions) -> list[tuple[str, float, complex]]:
    """Wire, position [m] and component of each sensor of a mode on the line."""
    return [
        (sensor.wire, sensor.position_m, complex(sensor.re, sensor.im))
        for sensor in mode.sensor_shape
        if sensor.position_m is not None and (sensor.wire, sensor.position_m) in positions
    ]


def _select_wires(line: Catenary) -> list[tuple[str, Wire]]:
    """Contact and messenger wires with their names in records; one of parallel wires."""
    wires: dict[tuple[str, float, float], Wire] = {}
    for name in SHAPE_WIRES:
        for wire in (wire for wire in line.wires if wire.kind is KIND_OF_WIRE[name]):
            wires.setdefault((name, wire.start, wire.end), wire)
    return [(name, wire) for (name, _, _), wire in wires.items()]


def _compute_curve(matched: MatchedModes, deflection: RealArray, name: str, wire: Wire) -> WireShape:
    mesh = matched.mesh.mesh
    grid = np.linspace(wire.start, wire.end, SHAPE_POINTS)
    values = np.interp(grid, mesh.position, deflection[mesh.row_of[wire.name, "z"]])
    return WireShape(wire=name, position_m=_round(grid), value=tuple(values))


def _scale_curve(curve: WireShape, scale: float) -> WireShape:
    return curve.model_copy(update={"value": _round(np.array(curve.value) / scale)})


def _scale_measured(
    matched: MatchedModes, mode: Mode, positions: Positions, deflection: RealArray
) -> tuple[MeasuredDeflection, ...]:
    """Real part of the measured shape times the complex factor that fits it to the computed deflection."""
    mesh, sensors = matched.mesh.mesh, _list_sensors(mode, positions)
    measured = np.array([component for _, _, component in sensors])
    computed = np.array([deflection[mesh.row_of[positions[name, x], "z"], mesh.station(x)] for name, x, _ in sensors])
    values = (np.vdot(measured, computed) / np.vdot(measured, measured) * measured).real
    return tuple(
        MeasuredDeflection(wire=name, position_m=x, value=float(value))
        for (name, x, _), value in zip(sensors, values, strict=True)
    )


def _round(values: RealArray) -> tuple[float, ...]:
    """Values with five significant digits, for a figure."""
    return tuple(float(f"{value:.5g}") for value in values)


# Observability of the coefficients of a damping model in the measured modes.
THRESHOLDS = Thresholds(largest_share=0.05, plausible_over_std=3.0, matched_share=0.8, median_mac=0.9)
"""Lower limits for an observable coefficient (the first two) and for a determined coefficient (all).

The record T1 has the matched share 1.0 and the median MAC 0.998 on its line, and 0.58 and 0.82 on a line with other
spans.
"""


def compute_observability(basis: DampingBasis, measured: MeasuredModes, fit: DampingFit) -> tuple[Observability, ...]:
    """Compute the observability of each coefficient; parameters as in `fit_damping_model`, and its result `fit`.

    If the model misfits the damping ratios by more than their standard deviations, the misfit takes their place: it
    could otherwise pass for information on the coefficients.
    """
    weighted = basis.ratios / (_misfit(measured, fit) * fit_deviation(measured))[:, None]
    rows = []
    for i, (kind, matrix) in enumerate(basis.terms):
        plausible = MATRICES[matrix].plausible
        share = float(np.max(plausible * basis.ratios[:, i] / measured.damping_ratio, initial=0.0))
        others = [j for j, term in enumerate(basis.terms) if j != i and term in fit.values]
        length = float(np.sum(weighted[:, i] ** 2))
        remaining = float(np.sum((weighted[:, i] - _project(weighted[:, others], weighted[:, i])) ** 2))
        determined = length > 0.0 and remaining > 1e-12 * length
        std = 1 / float(np.sqrt(remaining)) if determined else None
        growth = 1.0
        if (kind, matrix) in fit.values:
            without = residual_without_term(basis, measured, fit, (kind, matrix))
            growth = without / max(fit.residual, np.finfo(float).tiny)
        rows.append(
            Observability(
                kind=kind,
                matrix=matrix,
                largest_share=share,
                variance_inflation=length / remaining if determined else None,
                std=std,
                plausible=plausible,
                plausible_over_std=0.0 if std is None else plausible / std,
                residual_without=growth,
                observable=share >= THRESHOLDS.largest_share
                and std is not None
                and plausible >= THRESHOLDS.plausible_over_std * std,
            )
        )
    return tuple(rows)


def judge_coefficients(
    coefficients: Sequence[Coefficient], observability: Sequence[Observability], matching: Matching
) -> tuple[Coefficient, ...]:
    """Mark each coefficient as determined, or state the thresholds that are not reached."""
    common = []
    if matching.matched_share < THRESHOLDS.matched_share:
        common.append(
            f"{matching.matched} of {matching.modes} modes are matched, needed are {100 * THRESHOLDS.matched_share:g} %"
        )
    if matching.median_mac is None:
        common.append("the modes have a single sensor, so that no shapes can be compared")
    elif matching.median_mac < THRESHOLDS.median_mac:
        common.append(f"the median MAC is {matching.median_mac:.2g}, needed is {THRESHOLDS.median_mac:g}")
    observable = {(row.kind, row.matrix) for row in observability if row.observable}
    judged = []
    for c in coefficients:
        reasons = common if (c.kind, c.matrix) in observable else [*common, "it is not observable in the modes"]
        judged.append(c.model_copy(update={"determined": not reasons, "reason": "; ".join(reasons)}))
    return tuple(judged)


def residual_without_term(basis: DampingBasis, measured: MeasuredModes, fit: DampingFit, left_out: Term) -> float:
    """Root mean square of the relative residual of a fit without one coefficient, over the modes in the fit [-]."""
    kept = [basis.terms.index(term) for term in fit.values if term != left_out]
    target, weight = (
        measured.damping_ratio - basis.stated,
        fit_weights(fit_deviation(measured), measured.group, fit.used),
    )
    values = solve_weighted(basis.ratios[:, kept], target, weight)
    relative = (target - basis.ratios[:, kept] @ values) / measured.damping_ratio
    return float(np.sqrt(np.mean(relative[fit.used] ** 2)))


def _misfit(measured: MeasuredModes, fit: DampingFit) -> float:
    """Root mean square of (measured - fitted) / standard deviation over the modes in the fit, at least 1 [-]."""
    residual = (measured.damping_ratio - fit.predicted) / fit_deviation(measured)
    return max(1.0, float(np.sqrt(np.mean(residual[fit.used] ** 2))))


def _project(columns: RealArray, vector: RealArray) -> RealArray:
    """Projection of a vector on the span of the columns."""
    if columns.shape[1] == 0:
        return np.zeros_like(vector)
    q = np.linalg.qr(columns)[0]
    return np.asarray(q @ (q.T @ vector))
