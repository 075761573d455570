"""Damping model of a line from its identified modes: the content of damping.json."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.identification.damping.damping_format import (
    Coefficient,
    DampingResults,
    MeasuredBand,
    MeasuredRatios,
    ModelComparison,
    PairedMode,
    StatedDamping,
)
from pantocheck.conformance.identification.damping.damping_model import (
    MODAL_GROUPS,
    DampingFit,
    fit_damping_model,
    fit_modal_bands,
)
from pantocheck.conformance.identification.damping.damping_terms import (
    DampingBasis,
    build_damping_basis,
    list_other_damping,
)
from pantocheck.conformance.identification.damping.line_comparison import compare_line, warn_about_line
from pantocheck.conformance.identification.damping.mode_matching import MatchedModes, match_modes, select_usable
from pantocheck.conformance.identification.damping.observability import (
    THRESHOLDS,
    compute_observability,
    judge_coefficients,
)
from pantocheck.conformance.identification.damping.paired_shapes import list_paired_shapes
from pantocheck.conformance.identification.mode import Mode
from pantocheck.model import Catenary, Rayleigh
from pantocheck.model.catenary import ModalBand
from pantocheck.model.discretised_line import with_damping
from pantocheck.model.modal.modal_damping import apply_modal_bands
from pantocheck.model.modal.modes import component_energies, damping_ratios

WireCoefficients = Literal["separate", "common"]

COEFFICIENTS_OF_WIRES: dict[WireCoefficients, Callable[[DampingBasis], DampingBasis]] = {
    "separate": lambda basis: basis,
    "common": DampingBasis.join_wires,
}
"""Basis of the fit: each wire with its own coefficients, or both with the same."""


NOTICEABLE_SHARE = 0.01
"""Share of the measured damping by other components from which the fit warns: the error of the line model."""


@dataclass(frozen=True)
class FitOptions:
    """Choices for the fit of a damping model.

    Parameters
    ----------
    wires : {"separate", "common"}
        Whether contact and messenger wire have their own coefficients, or the same.
    modal_groups : int
        Number of groups of span modes with a band of modal damping, from the first.
    """

    wires: WireCoefficients = "separate"
    modal_groups: int = MODAL_GROUPS


def build_damping_results(
    modes: Sequence[Mode], line: Catenary, element: float, source: str, options: FitOptions = FitOptions()
) -> DampingResults:
    """Fit a damping model to identified modes.

    Parameters
    ----------
    modes : sequence of Mode
        Identified modes; lateral, uncertain and ungrouped ones are left out.
    line : Catenary
        Line of the record; its present damping is the reference of the comparison.
    element : float
        Element length [m].
    source : str
        Name of the file of the modes, for messages.
    options : FitOptions
        Coefficients of the wires, and bands of modal damping.

    Returns
    -------
    DampingResults
        Content of damping.json.

    Raises
    ------
    InputError
        There are too few modes, or too few of them have a computed counterpart.
    """
    usable = select_usable(modes, source)
    comparison = compare_line(usable, line)
    matched = match_modes(usable, line, element, source)
    measured, shapes = matched.measured, matched.shapes
    energies = component_energies(matched.mesh, shapes)
    stated = _compute_stated_ratios(matched, line)
    basis = COEFFICIENTS_OF_WIRES[options.wires](build_damping_basis(shapes.frequency, energies, stated))
    paired_basis = basis.select_modes(np.array([pair.computed for pair in matched.pairs], dtype=np.int64))
    fit = fit_damping_model(paired_basis, measured)
    observability = tuple(row for row in compute_observability(paired_basis, measured, fit) if row.largest_share > 0)
    coefficients = judge_coefficients(fit.coefficients, observability, matched.matching)
    bands = fit_modal_bands(measured, options.modal_groups)
    rayleigh = basis.stated + basis.ratios @ np.array([fit.values.get(term, 0.0) for term in basis.terms])
    return DampingResults(
        modes_file=source,
        warnings=(
            *warn_about_line(comparison),
            *_warn_about_stated(paired_basis.stated / measured.damping_ratio),
            *_warn_about_coefficients(coefficients),
        ),
        stated=_list_stated(line) if np.any(paired_basis.stated > 0) else (),
        line=comparison,
        matching=matched.matching,
        residual=fit.residual,
        coefficients=coefficients,
        modal=tuple(
            MeasuredBand(from_Hz=b.from_frequency, to_Hz=b.to_frequency, damping_ratio=b.damping_ratio) for b in bands
        ),
        observability=observability,
        thresholds=THRESHOLDS,
        pairs=_list_pairs(matched, fit),
        shapes=list_paired_shapes(matched, line),
        comparison=_compare_models(matched, rayleigh, bands),
        unpaired=tuple(mode.frequency_Hz for mode in matched.unpaired),
    ).rounded()


def _list_pairs(matched: MatchedModes, fit: DampingFit) -> tuple[PairedMode, ...]:
    """Pairs with their measured and fitted damping ratios."""
    return tuple(
        PairedMode(
            measured_Hz=mode.frequency_Hz,
            computed_Hz=matched.shapes.frequency[pair.computed],
            mac=pair.mac,
            group=mode.group,
            measured=mode.damping_ratio,
            fitted=predicted,
            used=bool(used),
        )
        for pair, mode, predicted, used in zip(matched.pairs, matched.paired, fit.predicted, fit.used, strict=True)
    )


def _compare_models(matched: MatchedModes, rayleigh: RealArray, bands: tuple[ModalBand, ...]) -> ModelComparison:
    """Measured damping ratios beside those of the line as it is, of the fit, and of the fit with modal bands."""
    measured, shapes = matched.measured, matched.shapes
    return ModelComparison(
        measured=MeasuredRatios(
            frequency_Hz=tuple(measured.frequency),
            damping_ratio=tuple(measured.damping_ratio),
            std=tuple(measured.std),
        ),
        frequency_Hz=tuple(shapes.frequency),
        models={
            "line as it is": tuple(damping_ratios(matched.mesh, shapes)),
            "Rayleigh": tuple(rayleigh),
            "Rayleigh + modal": tuple(apply_modal_bands(rayleigh, shapes.frequency, bands)),
        },
    )


def _compute_stated_ratios(matched: MatchedModes, line: Catenary) -> RealArray:
    """Damping ratios by the components that are not fitted, as the line states them, (m,).

    Modal damping of the line replaces the damping of all components in its bands, so that they add nothing there.
    """
    ratios = damping_ratios(with_damping(matched.mesh, list_other_damping(line)), matched.shapes)
    bands = tuple(replace(band, damping_ratio=0.0) for band in line.modal_damping)
    return apply_modal_bands(ratios, matched.shapes.frequency, bands)


def _list_stated(line: Catenary) -> tuple[StatedDamping, ...]:
    """Damping of the components that are not fitted, as the line states it."""
    return tuple(
        StatedDamping(
            kind=kind.value,
            stiffness_coefficient_s=rayleigh.stiffness_coefficient,
            mass_coefficient_1_s=rayleigh.mass_coefficient,
        )
        for kind, rayleigh in list_other_damping(line).items()
        if rayleigh != Rayleigh()
    )


def _warn_about_stated(share: RealArray) -> list[str]:
    """Warning where the stated damping of other components is a noticeable part of the measured damping ratios."""
    if share.max(initial=0.0) < NOTICEABLE_SHARE:
        return []
    return [
        "Droppers, steady arms and supports have the damping that the line states, which gives "
        f"{100 * np.median(share):.2g} % of the measured damping ratios (median; largest {100 * share.max():.2g} %). "
        "The errors of the coefficients can exceed their intervals if that damping is wrong."
    ]


def _warn_about_coefficients(coefficients: Sequence[Coefficient]) -> list[str]:
    """Warnings about coefficients that are not determined, one per reason."""
    names: dict[str, list[str]] = {}
    for c in coefficients:
        if not c.determined:
            names.setdefault(c.reason, []).append(f"{c.kind.replace('_', ' ')} {c.matrix}")
    return [f"Not determined: {', '.join(terms)} ({reason})." for reason, terms in names.items()]
