"""Description of a fitted chain: pantograph file, report, and caveats."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, get_args

import numpy as np
from scipy.linalg import eigh

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.pantograph.chain_fit import (
    ChainFit,
    ChainSelection,
    FitIntervals,
    information_criterion,
    judge_parameters,
)
from pantocheck.conformance.pantograph.chain_problem import chain_response
from pantocheck.conformance.results.comparison_format import ResponseComparison
from pantocheck.conformance.results.pantograph_fit_format import (
    ChainCandidate,
    ChainKey,
    ChainParameter,
    CorrelatedPair,
    PantographFit,
)

CHAIN_KEYS: tuple[ChainKey, ...] = get_args(ChainKey)

HIGH_CORRELATION = 0.95
"""Correlation of two parameters that is reported: each interval is three times wider than with the other fixed."""

EXCESS = 1.5
"""Ratio of variances above which the deviations are not noise: 240 residuals of noise exceed 1.2 once in 100 fits."""

FILE_DIGITS = 6
"""Significant digits of a fitted value in the file: more than any response determines."""


CONTACT_SOURCE = "chosen, not measured: the response of a head contains no contact"


@dataclass(frozen=True)
class FileTexts:
    """Texts of the pantograph file."""

    title: str
    """Title of the pantograph."""
    source: str
    """Origin of the measured responses."""


def describe_pantograph(
    selection: ChainSelection, masses: int, texts: FileTexts, contact_stiffness: float
) -> dict[str, Any]:
    """Content of the pantograph file.

    Args:
        selection: Fitted chains.
        masses: Number of masses of the chosen one.
        texts: Title and source.
        contact_stiffness: Stiffness of the contact, which the response does not contain [N/m].

    Returns:
        Tables of the file. It states no trust: these are data of the user.
    """
    fit, intervals, modes = selection.fits[masses], selection.intervals(masses), selection.modes[masses]
    values = {key: [_round(v) for v in row] for key, row in zip(CHAIN_KEYS, fit.values, strict=True)}
    bending = [
        {
            "frequency_Hz": _round(mode.frequency_Hz),
            "damping_ratio": _round(mode.damping_ratio),
            "shapes": [[_round(mode.shape)]],
        }
        for mode in modes
    ]
    return {
        "title": texts.title,
        "chain": {**values, "source": texts.source, "note": _describe_intervals(intervals)},
        "contact": {
            "stiffness_N_m": contact_stiffness,
            "source": CONTACT_SOURCE,
        },
        **({"head": {"bending_mode": bending, "source": texts.source}} if bending else {}),
    }


def _describe_intervals(intervals: FitIntervals) -> str:
    lists = (
        f"{key} {', '.join(f'{width:.2g}' if width else 'fixed' for width in row)}"
        for key, row in zip(CHAIN_KEYS, intervals.half_width, strict=True)
    )
    return f"Half-widths of the 95 % intervals, base to head: {'; '.join(lists)}."


def build_pantograph_fit(
    selection: ChainSelection, masses: int, title: str, comparison: ResponseComparison
) -> PantographFit:
    """Report on a fit.

    Args:
        selection: Fitted chains.
        masses: Number of masses of the chosen one.
        title: Title of the pantograph.
        comparison: Comparison of the chosen pantograph with the responses.

    Returns:
        Content of the JSON report.
    """
    fit, intervals = selection.fits[masses], selection.intervals(masses)
    parameters = tuple(_list_parameters(fit, intervals))
    frequency = fit.problem.data.frequency
    return PantographFit(
        suite=comparison.suite,
        title=title,
        masses=masses,
        band_Hz=(float(frequency.min()), float(frequency.max())),
        rows=frequency.size,
        is_noise_stated=selection.is_noise_stated,
        parameters=parameters,
        natural_frequencies_Hz=tuple(_natural_frequencies(fit.values)),
        correlations=tuple(_list_correlations(parameters, intervals)),
        candidates=tuple(
            _describe_candidate(number, each, selection.is_noise_stated) for number, each in selection.fits.items()
        ),
        comparison=comparison,
        warnings=tuple(_list_warnings(selection, masses, parameters)),
    ).rounded()


def _round(value: float) -> float:
    return float(f"{value:.{FILE_DIGITS}g}")


def _list_parameters(fit: ChainFit, intervals: FitIntervals) -> Iterator[ChainParameter]:
    judged = judge_parameters(fit, intervals)
    for row, key in enumerate(CHAIN_KEYS):
        for column in range(fit.values.shape[1]):
            yield ChainParameter(
                key=key,
                number=column + 1,
                value=_round(fit.values[row, column]),
                half_width=float(intervals.half_width[row, column]),
                determination=judged[row][column],
            )


def _list_correlations(parameters: tuple[ChainParameter, ...], intervals: FitIntervals) -> Iterator[CorrelatedPair]:
    """Pairs of free parameters with a high correlation."""
    names = [name_parameter(item.key, item.number) for item in parameters if item.determination != "fixed"]
    for first, second in zip(*np.triu_indices(len(names), 1), strict=True):
        if abs(value := float(intervals.correlation[first, second])) > HIGH_CORRELATION:
            yield CorrelatedPair(first=names[first], second=names[second], correlation=value)


def name_parameter(key: ChainKey, number: int) -> str:
    """Parameter as it is fixed on the command line, `masses_kg.3`."""
    return f"{key}.{number}"


def _describe_candidate(masses: int, fit: ChainFit, is_noise_stated: bool) -> ChainCandidate:
    data = fit.problem.data
    deviation = np.log(chain_response(fit.values, data.s).stiffness / data.stiffness)
    return ChainCandidate(
        masses=masses,
        free_parameters=fit.free_count,
        complex_deviation_pct=100 * float(np.sqrt(np.mean(np.abs(deviation) ** 2))),
        variance_ratio=fit.variance_ratio if is_noise_stated else None,
        information_criterion=information_criterion(fit),
        starts=fit.starts,
        best_starts=fit.best_starts,
    )


def _natural_frequencies(values: RealArray) -> RealArray:
    """Undamped natural frequencies of a chain with a fixed base and a free head [Hz]."""
    masses, stiffness, _ = values
    above = np.append(stiffness[1:], 0.0)
    matrix = np.diag(stiffness + above) - np.diag(stiffness[1:], 1) - np.diag(stiffness[1:], -1)
    squared = eigh(matrix, np.diag(masses), eigvals_only=True)
    return np.asarray(np.sqrt(np.maximum(squared, 0.0)) / (2 * np.pi))


def _list_warnings(selection: ChainSelection, masses: int, parameters: tuple[ChainParameter, ...]) -> Iterator[str]:
    """Caveats: parameters that the band does not determine, doubtful minimum, deviations beyond the noise."""
    for item in parameters:
        name = name_parameter(item.key, item.number)
        if item.determination == "not_distinguished_from_zero":
            yield f"{name}: the measured band does not distinguish it from 0; --fix {name}=VALUE gives it a value"
        if item.determination == "weakly_determined":
            yield f"{name}: weakly determined, to {100 * item.half_width / item.value:.0f} %"
    for mode in selection.modes[masses]:
        yield (
            f"bending mode at {mode.frequency_Hz:.3g} Hz, damping ratio {mode.damping_ratio:.2g}, shape "
            f"{mode.shape:.3g} kg^-1/2: the intervals of the chain hold for this mode"
        )
    if masses != selection.best:
        yield f"the information criterion prefers {selection.best} masses"
    fit = selection.fits[masses]
    if fit.best_starts == 1:
        yield f"the best minimum was reached from one of {fit.starts} starts: a better one may exist"
    if selection.is_noise_stated and fit.variance_ratio > EXCESS:
        yield (
            f"the deviations are {np.sqrt(fit.variance_ratio):.2g} times the stated noise: the pantograph is no linear "
            f"chain of {masses} masses; the intervals are widened by this factor"
        )
    if not selection.is_noise_stated:
        yield "no uncertainty is stated: the intervals follow from the size of the residuals"
