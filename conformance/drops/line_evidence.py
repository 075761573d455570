"""Evidence of a joint fit: properties that the modes determine, lines that they refute, groups that they leave open."""

from collections.abc import Iterator, Sequence

import numpy as np
import scipy

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.drops.joint_fit import JointFit, Prior
from pantocheck.conformance.results.damping_format import (
    FittedProperty,
    GroupResidual,
    JointCovariance,
    LineComparison,
    LineDifference,
)
from pantocheck.model import Catenary

LEVEL = 0.01
"""Probability that a test refutes a line, or any group, although it is correct [-]."""

REFUTED_TENSION = 0.006
"""Smallest relative error of a tension that contradicts a line [-]: it changes frequencies by 0.3 %."""

REFUTED_SCATTER = 0.003
"""Scatter of the frequencies about those of the fitted line that contradicts the line [-]."""

DETERMINED = 0.7
"""Largest standard deviation of a determined property over that of its prior [-]: half of the variance."""


def quantile_95(freedom: float) -> float:
    """Half of a 95 % interval in standard deviations, by Student's distribution for a variance that was estimated."""
    return float(scipy.special.stdtrit(freedom, 0.975))


def list_properties(fit: JointFit, prior: Prior) -> tuple[FittedProperty, ...]:
    """Factors of the free properties with their intervals."""
    rows = []
    for number, place in enumerate(np.flatnonzero(prior.is_free)):
        std, tolerance = np.sqrt(fit.covariance[number, number]), np.sqrt(prior.covariance[place, place])
        factor, width = float(fit.factors[place]), quantile_95(fit.freedom) * float(std)
        rows.append(
            FittedProperty(
                name=prior.parameters[place].name,
                factor=factor,
                low_95=factor - width,
                high_95=factor + width,
                tolerance=float(tolerance),
                determined=bool(std < DETERMINED * tolerance),
            )
        )
    return tuple(rows)


def name_covariance(fit: JointFit, prior: Prior, coefficients: Sequence[str]) -> JointCovariance:
    """Covariance of the factors of the free properties and of the coefficients, with their names."""
    names = [parameter.name for parameter, free in zip(prior.parameters, prior.is_free, strict=True) if free]
    return JointCovariance(names=(*names, *coefficients), rows=tuple(map(tuple, fit.covariance.tolist())))


def refute_line(comparison: LineComparison, fit: JointFit, prior: Prior, line: Catenary) -> LineComparison:
    """Comparison with the differences that the frequencies show; the tensions of the fit must be free."""
    found = tuple(_list_refuted(fit, prior, line))
    return comparison.model_copy(update={"state": "contradicted", "refuted": found}) if found else comparison


def _list_refuted(fit: JointFit, prior: Prior, line: Catenary) -> Iterator[LineDifference]:
    """Frequencies far from those of any fitted line; else tensions that they refute at the level."""
    if fit.scatter.frequency > REFUTED_SCATTER:
        yield LineDifference(
            fact="scatter of the frequencies about those of the fitted line",
            record=f"{100 * fit.scatter.frequency:.2f} %",
            line=f"below {100 * REFUTED_SCATTER:g} %",
        )
        return
    places = [n for n, parameter in enumerate(prior.parameters) if parameter.group == "tensions"]
    unknowns = [int(prior.is_free[:place].sum()) for place in places]
    change = fit.factors[places] - 1.0
    covariance = fit.covariance[np.ix_(unknowns, unknowns)]
    std = np.sqrt(np.diag(covariance))
    # Information of the data alone: that of the fit without that of the prior.
    information = np.linalg.inv(covariance)
    of_data = information - np.linalg.inv(prior.covariance[np.ix_(places, places)])
    weighted = information @ change
    statistic = float(weighted @ np.linalg.pinv(of_data, rcond=1e-6, hermitian=True) @ weighted)
    if scipy.special.fdtrc(len(places), fit.freedom, statistic / len(places)) < LEVEL:
        for place, shift, deviation in zip(places, change, std, strict=True):
            if abs(shift) > max(REFUTED_TENSION, quantile_95(fit.freedom) * deviation):
                kind = prior.parameters[place].name.removesuffix("_tension")
                stated = next(wire.tension for wire in line.wires if wire.kind == kind)
                yield LineDifference(
                    fact=f"tension of the {kind.replace('_', ' ')}",
                    record=f"{stated * (1 + shift):.0f} N",
                    line=f"{stated:g} N",
                )


def assess_groups(fit: JointFit) -> tuple[GroupResidual, ...]:
    """Test whether the damping of the wires explains the ratios of each group.

    The squared residual over its covariance has an F distribution if the model carries the group; the scatter within
    the groups stands for noise. The level is shared by all groups.
    """
    measured = fit.linear.matched.measured.select(fit.used)
    numbers = np.unique(measured.group)
    rows = []
    for number in numbers:
        members = np.flatnonzero(measured.group == number)
        residual, own = fit.ratio_residual[members], fit.ratio_covariance[np.ix_(members, members)]
        relative = residual / measured.damping_ratio[members]
        statistic = float(residual @ np.linalg.solve(own, residual))
        probability = float(scipy.special.fdtrc(members.size, fit.freedom, statistic / members.size))
        rows.append(
            GroupResidual(
                group=int(number),
                modes=members.size,
                mean=float(relative.mean()),
                rms=float(np.sqrt(np.mean(relative**2))),
                chi_square=statistic,
                probability=probability,
                explained=probability >= LEVEL / numbers.size,
            )
        )
    return tuple(rows)


def build_intervals(fit: JointFit) -> tuple[RealArray, RealArray]:
    """Ends of the 95 % intervals of the coefficients, (t,); a coefficient is never negative."""
    count = fit.values.size
    quantile = np.array([quantile_95(freedom) for freedom in fit.coefficient_freedom.tolist()])
    width = quantile * np.sqrt(np.diag(fit.covariance)[-count:])
    return np.maximum(fit.values - width, 0.0), fit.values + width
