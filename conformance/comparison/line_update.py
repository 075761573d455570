"""Update of a line by measurements: normal estimates of its properties, and the verdict of a held-out passage.

The unknowns are factors of the properties and damping coefficients of the line, with the tolerances of its file as
prior. Each kind of data updates mean and covariance in turn: modes by the joint fit, elasticities and passages by
linear rows with central differences, computed anew at each step. Heights replace those of the droppers.
"""

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import scipy
import tomli_w

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.comparison.static_record import StaticRecord
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.near_limit import QUANTILE_95
from pantocheck.conformance.core.verdicts import Verdict
from pantocheck.conformance.drops.joint_fit import build_prior, fit_jointly
from pantocheck.conformance.drops.line_evidence import DETERMINED
from pantocheck.conformance.drops.mode_matching import select_usable
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.line.line_export import export_supports
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.line.line_import import import_line
from pantocheck.conformance.line.line_parameters import (
    DAMPING,
    MECHANICAL,
    PARAMETER_GROUPS,
    LineParameter,
    build_factor_covariance,
    scale_line,
)
from pantocheck.conformance.quantities.unavailable import QuantityUnavailable
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.record_signals import RecordSignals
from pantocheck.conformance.results.damping_format import FittedProperty, JointCovariance
from pantocheck.conformance.results.identified_modes import Mode
from pantocheck.conformance.results.line_update_format import HeldOutValue, LineUpdate, UsedData
from pantocheck.conformance.runs.case_run import run_passage
from pantocheck.model import Catenary, Kind, discretise
from pantocheck.model.statics.elasticity import rest_height, static_uplift

ELASTICITY_ERROR, BAND_ERROR = 0.02, 0.05
"""Relative standard deviation of a measured elasticity that states none, and of simulated and measured bands [-]: six
bands with independent errors of 5 % are known together to 2 %."""

HEIGHT_ERROR_M, HEIGHT_TOLERANCE_M = 0.003, 0.02
"""Standard deviations of a measured height that states none, and of the stated height at a dropper [m]."""

STEP_SHARE = 0.5
"""Step of the central differences, over the standard deviation of the factor [-]."""

MOST_UPDATES, LAST_UPDATE = 3, 0.3
"""Largest number of Gauss-Newton steps, and change of a factor that ends them, over its standard deviation [-]."""

STATED_FREEDOM = 5.0
"""Degrees of freedom of the stated errors: their scale is known to a third [-]. Chosen with planted lines in sight."""

BAND_EDGES_HZ = tuple(range(0, 51, 5))
"""Bands of a passage [Hz]. Other clamps move the peaks of the dropper passing, and hardly change the wide bands."""

HOLD_OUT_LEVEL = 0.01
"""Probability that the held-out passage refutes a correct line [-]."""

Predict = Callable[[RealArray], RealArray]
"""Values of the model for the factors of all properties."""


@dataclass(frozen=True)
class LineEstimate:
    """Normal estimate of the factors of the properties."""

    parameters: tuple[LineParameter, ...]
    factors: RealArray
    """Means, (p,) [-]."""
    covariance: RealArray
    """Covariance, (p, p) [-]."""
    data: tuple[UsedData, ...] = ()
    """Measurements of the estimate."""


@dataclass(frozen=True)
class MeasuredPassage:
    """Recorded passage and its case."""

    name: str
    case: Case
    record: Record

    @property
    def values(self) -> tuple[tuple[int, str, float], ...]:
        """Pantograph, name and value of every band that the record supports."""
        return _list_bands(self.case, self.record)


def begin_estimate(line: LineFile) -> LineEstimate:
    """Estimate by the tolerances alone; a property whose value is zero is left out."""
    catenary = build_catenary(line)
    parameters = tuple(each for each in (*MECHANICAL, *DAMPING) if each.scale(catenary, 2.0) != catenary)
    return LineEstimate(parameters, np.ones(len(parameters)), build_factor_covariance(line, parameters))


def update_by_modes(
    estimate: LineEstimate, line: LineFile, modes: Sequence[Mode], element: float, source: str
) -> LineEstimate:
    """Estimate with identified modes, which determine the damping as well.

    Raises:
        InputError: The modes do not belong to the line, or are too few.
    """
    mechanical = tuple(each for each in estimate.parameters if each.group is not None)
    damping = tuple(each for each in estimate.parameters if each.group is None)
    count = len(mechanical)
    prior = build_prior(mechanical, estimate.covariance[:count, :count], PARAMETER_GROUPS)
    catenary = build_catenary(line)
    fit = fit_jointly(select_usable(modes, source), catenary, prior, np.eye(4), element, source)
    kept = [number for number, each in enumerate(DAMPING) if each in damping]
    stated = np.array([_read_coefficient(catenary, each) for each in damping])
    rows = [*range(count), *(count + number for number in kept)]
    scale = np.append(np.ones(count), 1 / stated)
    used = UsedData(name="modes", values=3 * fit.used.size, misfit=fit.misfit)
    return replace(
        estimate,
        factors=np.append(fit.factors[:count], fit.values[kept] / stated),
        covariance=fit.covariance[np.ix_(rows, rows)] * np.outer(scale, scale),
        data=(*estimate.data, used),
    )


def update_by_elasticity(estimate: LineEstimate, line: LineFile, record: StaticRecord, element: float) -> LineEstimate:
    """Estimate with elasticities that were measured along the line."""
    measured = record.values["elasticity"]
    known = np.isfinite(measured)
    position, measured = record.position[known], measured[known]
    half_width = record.sidecar.elasticity_uncertainty_mm_N
    std = ELASTICITY_ERROR * measured if half_width is None else np.full(measured.size, half_width / 1960)
    catenary, forces = build_catenary(line), (0.0, *(record.sidecar.force_N or ()))[-2:]

    def predict(factors: RealArray) -> RealArray:
        mesh = discretise(scale_line(catenary, estimate.parameters, factors.tolist()), element)
        low, high = (static_uplift(mesh, position, force) if force else 0.0 for force in forces)
        return np.asarray((high - low) / (forces[1] - forces[0]))

    mechanical = [number for number, each in enumerate(estimate.parameters) if each.group is not None]
    return update_linear(estimate, "elasticity", predict, mechanical, measured, np.diag(std**2))


def update_by_passage(estimate: LineEstimate, line: LineFile, passage: MeasuredPassage) -> LineEstimate:
    """Estimate with the bands of a recorded passage."""
    measured = np.array([value for _, _, value in passage.values])
    places = list(range(len(estimate.parameters)))
    predict = simulate_bands(passage, line, estimate)
    errors = _build_band_covariance(passage, line, estimate, predict(estimate.factors))
    return update_linear(estimate, passage.name, predict, places, measured, errors)


def update_linear(
    estimate: LineEstimate,
    name: str,
    predict: Predict,
    places: Sequence[int],
    measured: RealArray,
    errors: RealArray,
) -> LineEstimate:
    """Estimate with measured values, by Gauss-Newton steps.

    Args:
        estimate: Estimate before.
        name: Kind of the data.
        predict: Model of the values.
        places: Properties on which they depend.
        measured: Measured values, (n,).
        errors: Covariance of their errors and of those of the model, (n, n).
    """
    factors, covariance = estimate.factors, estimate.covariance
    information, whiten = np.linalg.inv(covariance), np.linalg.inv(np.linalg.cholesky(errors))
    for _ in range(MOST_UPDATES):
        value, slope = differentiate(predict, places, factors, np.sqrt(np.diag(covariance)))
        weighted = whiten @ slope
        left = whiten @ (measured - value + slope @ (factors - estimate.factors))
        covariance = np.asarray(np.linalg.inv(information + weighted.T @ weighted))
        before, factors = factors, estimate.factors + covariance @ weighted.T @ left
        if np.max(np.abs(factors - before) / np.sqrt(np.diag(covariance))) < LAST_UPDATE:
            break
    freedom = max(measured.size - float(np.trace(covariance @ weighted.T @ weighted)), 1.0)
    misfit = float(np.sum((left - weighted @ (factors - estimate.factors)) ** 2)) / freedom
    scale = max(misfit, 1.0) * (scipy.special.stdtrit(STATED_FREEDOM + freedom, 0.975) / QUANTILE_95) ** 2
    covariance = np.asarray(np.linalg.inv(information + weighted.T @ weighted / scale))
    factors = estimate.factors + covariance @ weighted.T @ left / scale
    used = UsedData(name=name, values=measured.size, misfit=misfit)
    return LineEstimate(estimate.parameters, np.asarray(factors), np.asarray(covariance), (*estimate.data, used))


def differentiate(
    predict: Predict, places: Sequence[int], factors: RealArray, std: RealArray
) -> tuple[RealArray, RealArray]:
    """Values of a model, (n,), and their derivatives by all factors, (n, p): zero but for some properties."""
    value = predict(factors)
    slope = np.zeros((value.size, factors.size))
    for place in places:
        step = STEP_SHARE * std[place] * np.eye(factors.size)[place]
        slope[:, place] = (predict(factors + step) - predict(factors - step)) / (2 * step[place])
    return value, slope


def simulate_bands(passage: MeasuredPassage, line: LineFile, estimate: LineEstimate) -> Predict:
    """Bands of a passage on the line with changed properties, at the uplift forces of the line as it is."""
    case, places = passage.case, [(owner, name) for owner, name, _ in passage.values]
    discretisation, catenary = case.file.discretisation, build_catenary(line)
    forces = run_passage(case, discretise(catenary, discretisation.element_m), discretisation).uplift_forces

    def predict(factors: RealArray) -> RealArray:
        built = scale_line(catenary, estimate.parameters, factors.tolist())
        run = run_passage(case, discretise(built, discretisation.element_m), discretisation, forces)
        found = {(owner, name): value for owner, name, value in _list_bands(case, run.record)}
        return np.array([found[place] for place in places])

    return predict


def judge_held_out(
    estimate: LineEstimate, line: LineFile, passage: MeasuredPassage
) -> tuple[tuple[HeldOutValue, ...], float]:
    """Bands of a passage that took no part in the estimate, and the probability of their distance from it."""
    measured = np.array([value for _, _, value in passage.values])
    predict = simulate_bands(passage, line, estimate)
    std = np.sqrt(np.diag(estimate.covariance))
    value, slope = differentiate(predict, range(len(estimate.parameters)), estimate.factors, std)
    stated = predict(np.ones(len(estimate.parameters)))
    by_line, errors = slope @ estimate.covariance @ slope.T, _build_band_covariance(passage, line, estimate, value)
    distance = measured - value
    statistic = float(distance @ np.linalg.solve(by_line + errors, distance))
    rows = tuple(
        HeldOutValue(
            pantograph=owner,
            quantity=name,
            measured=each,
            predicted=float(value[n]),
            stated=float(stated[n]),
            line_std=float(np.sqrt(by_line[n, n])),
            model_std=float(np.sqrt(errors[n, n])),
        )
        for n, (owner, name, each) in enumerate(passage.values)
    )
    return rows, float(scipy.special.chdtrc(measured.size, statistic))


def _build_band_covariance(
    passage: MeasuredPassage, line: LineFile, estimate: LineEstimate, value: RealArray
) -> RealArray:
    """Covariance of the errors of measured and computed bands, (n, n).

    Errors of measured bands are independent; the change with halved steps is an error of all bands together.
    """
    own = BAND_ERROR * np.array([measured for _, _, measured in passage.values])
    file = passage.case.file
    halved = replace(passage.case, file=file.model_copy(update={"discretisation": file.discretisation.scale(1 / 2)}))
    finer = simulate_bands(replace(passage, case=halved), line, estimate)(estimate.factors) - value
    return np.asarray(np.diag(own**2) + np.outer(finer, finer))


def _list_bands(case: Case, record: Record) -> tuple[tuple[int, str, float], ...]:
    signals = RecordSignals(record, case.file.filter)
    bands = []
    for owner, channel in sorted(signals.pantographs.items()):
        for low, high in pairwise(BAND_EDGES_HZ):
            with suppress(QuantityUnavailable):
                bands.append((owner, f"rms_{low}_{high}_N", channel.band(low, high)))
    return tuple(bands)


def _read_coefficient(line: Catenary, parameter: LineParameter) -> float:
    """Stated value of a coefficient of damping."""
    kind = next(kind for kind in (Kind.CONTACT_WIRE, Kind.MESSENGER_WIRE) if parameter.name.startswith(kind))
    return float(getattr(line.rayleigh(kind), parameter.name.removeprefix(f"{kind}_")))


def measure_dropper_heights(line: LineFile, record: StaticRecord) -> list[RealArray]:
    """Heights of the contact wire at the droppers of every span from measured heights [m].

    Between droppers and supports, a deviation of the wire is straight: it hardly bends under its tension.
    """
    measured = record.values["contact_wire_height"]
    known = np.isfinite(measured)
    layout, half_width = line.layout, record.sidecar.height_uncertainty_mm
    stated = [span.contact_wire_height for span in layout.spans]
    droppers = np.concatenate([span.dropper_position for span in layout.spans])
    ends = np.array([limit.position for limit in layout.limits])
    mesh = discretise(build_catenary(line), 0.5)
    deviation = measured[known] - rest_height(mesh, record.position[known])
    places = np.sort(np.concatenate([droppers, ends]))
    hats = np.array([np.interp(record.position[known], places, row) for row in np.eye(places.size)]).T
    hats = hats[:, np.searchsorted(places, droppers)]
    std = HEIGHT_ERROR_M if half_width is None else half_width / 1960
    normal = hats.T @ hats / std**2 + np.eye(droppers.size) / HEIGHT_TOLERANCE_M**2
    change = np.linalg.solve(normal, hats.T @ deviation / std**2)
    counts = np.cumsum([heights.size for heights in stated])[:-1]
    return [heights + part for heights, part in zip(stated, np.split(change, counts), strict=True)]


# Line file of an updated line: scaled values, measured heights of the droppers, and their covariance as tolerances.


def build_updated_line(line: LineFile, estimate: LineEstimate, heights: Sequence[RealArray] | None) -> dict[str, Any]:
    """Content of the line file of an estimate.

    Args:
        line: Line as stated.
        estimate: Estimate of its properties.
        heights: Heights of the contact wire at the droppers of every span [m]; None: as stated.
    """
    tree = line.model_dump(mode="json", exclude_none=True) if heights is None else _list_heights(line, heights)
    for parameter, factor in zip(estimate.parameters, estimate.factors, strict=True):
        for table, key in parameter.keys:
            _scale_key(tree, table, key, float(factor))
        for table, key in parameter.inverse:
            _scale_key(tree, table, key, 1 / float(factor))
    names = [parameter.name for parameter in estimate.parameters]
    std = np.sqrt(np.diag(estimate.covariance))
    correlation = estimate.covariance / np.outer(std, std)
    used = ", ".join(data.name for data in estimate.data)
    tree["tolerance"] = {
        **{
            f"{name}_pct": round(float(100 * s / f), 4) for name, s, f in zip(names, std, estimate.factors, strict=True)
        },
        "source": f"pantocheck line update from {used}"[:500],
        "correlation": {"names": names, "rows": [[round(float(value), 6) for value in row] for row in correlation]},
    }
    return tree


def describe_update(
    estimate: LineEstimate,
    line: LineFile,
    heights: Sequence[RealArray] | None,
    held_out: tuple[HeldOutValue, ...],
    probability: float | None,
) -> LineUpdate:
    """Content of the covariance file; arguments as in `build_updated_line`, and the result of `judge_held_out`."""
    tolerances = np.sqrt(np.diag(build_factor_covariance(line, estimate.parameters)))
    std = np.sqrt(np.diag(estimate.covariance))
    properties = tuple(
        FittedProperty(
            name=parameter.name,
            factor=float(factor),
            low_95=float(factor - QUANTILE_95 * deviation),
            high_95=float(factor + QUANTILE_95 * deviation),
            tolerance=float(tolerance),
            determined=bool(deviation < DETERMINED * tolerance),
        )
        for parameter, factor, deviation, tolerance in zip(
            estimate.parameters, estimate.factors, std, tolerances, strict=True
        )
    )
    verdict: Verdict = "info" if probability is None else "pass" if probability >= HOLD_OUT_LEVEL else "fail"
    return LineUpdate(
        line=line.title,
        data=estimate.data,
        moved_droppers=0 if heights is None else sum(values.size for values in heights),
        properties=properties,
        covariance=JointCovariance(
            names=tuple(row.name for row in properties), rows=tuple(map(tuple, estimate.covariance.tolist()))
        ),
        held_out=held_out,
        probability=probability,
        verdict=verdict,
    ).rounded()


def _scale_key(tree: Any, table: str, key: str, factor: float, inside: str = "") -> None:
    """Multiply a key wherever it stands in tables of a name: those of the line, of its sections and of its supports."""
    if isinstance(tree, list):
        for part in tree:
            _scale_key(part, table, key, factor, inside)
    elif isinstance(tree, dict):
        for name, value in tree.items():
            if name == key and inside == table and isinstance(value, float | int):
                tree[name] = float(f"{value * factor:.8g}")
            else:
                _scale_key(value, table, key, factor, inside if inside == table else name)


def _list_heights(line: LineFile, heights: Sequence[RealArray]) -> dict[str, Any]:
    """Content of a line file with listed spans and these heights at its droppers."""
    rows = ["span,x_m,contact_wire_height_m"]
    for number, (schedule, values) in enumerate(zip(line.dropper_schedules, heights, strict=True), 1):
        rows += [f"{number},{x!r},{value:.6f}" for x, value in zip(schedule.x_m, values.tolist(), strict=True)]
    with TemporaryDirectory() as folder:
        base, supports, droppers = (Path(folder) / name for name in ("line.toml", "supports.csv", "droppers.csv"))
        base.write_text(tomli_w.dumps(line.model_dump(mode="json", exclude_none=True)), encoding="utf-8", newline="\n")
        supports.write_text(export_supports(line), encoding="utf-8", newline="\n")
        droppers.write_text("\n".join(rows) + "\n", encoding="utf-8", newline="\n")
        return import_line(base, supports, droppers)
