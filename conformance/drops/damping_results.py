"""Damping model of a line from its identified modes: content of damping.json, and table of a line file."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal, NamedTuple

import numpy as np
import tomli_w
from numpy.typing import NDArray

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.texts import count_noun
from pantocheck.conformance.drops.damping_model import (
    JOINED_WIRES,
    MATRICES,
    MODAL_GROUPS,
    TABLE_OF_KIND,
    THRESHOLDS,
    WIRES,
    DampingBasis,
    DampingFit,
    MeasuredModes,
    Term,
    build_damping_basis,
    compute_observability,
    fit_damping_model,
    fit_modal_bands,
    judge_coefficients,
    list_other_damping,
)
from pantocheck.conformance.drops.joint_fit import JointFit, Prior, build_prior, fit_jointly, solve_about
from pantocheck.conformance.drops.line_comparison import compare_line, warn_about_line
from pantocheck.conformance.drops.line_evidence import (
    assess_groups,
    build_intervals,
    list_properties,
    name_covariance,
    refute_line,
)
from pantocheck.conformance.drops.mode_matching import MatchedModes, match_modes, select_usable
from pantocheck.conformance.drops.paired_shapes import list_paired_shapes
from pantocheck.conformance.line.line_parameters import MECHANICAL, ParameterGroup
from pantocheck.conformance.results.damping_format import (
    Coefficient,
    DampingResults,
    FittedModels,
    FittedProperty,
    GroupResidual,
    MeasuredBand,
    MeasuredRatios,
    PairedMode,
    StatedDamping,
)
from pantocheck.conformance.results.identified_modes import Mode
from pantocheck.model import Catenary, Kind, Rayleigh
from pantocheck.model.description.catenary import ModalBand
from pantocheck.model.discretisation.discretised_line import with_damping
from pantocheck.model.modal.modal_damping import apply_modal_bands
from pantocheck.model.modal.modes import component_energies, damping_ratios

WireCoefficients = Literal["separate", "common"]


class WireForm(NamedTuple):
    """Form of the damping of the wires."""

    join: Callable[[DampingBasis], DampingBasis]
    """Basis of the coefficients."""
    kinds: tuple[str, ...]
    """Kinds of component of the coefficients, each with its stiffness and mass."""
    shares: RealArray
    """Shares of the coefficients in those of both wires, (4, t) [-]."""

    @property
    def terms(self) -> tuple[Term, ...]:
        """Coefficients in the order of the shares."""
        return tuple((kind, matrix) for kind in self.kinds for matrix in MATRICES)


FORMS: dict[WireCoefficients, WireForm] = {
    "separate": WireForm(lambda basis: basis, WIRES, np.eye(4)),
    "common": WireForm(DampingBasis.join_wires, (JOINED_WIRES,), np.vstack([np.eye(2), np.eye(2)])),
}
"""Form of the fit: each wire with its own coefficients, or both with the same."""


NOTICEABLE_SHARE = 0.01
"""Largest share of the measured damping of a mode by other components up to which the fit does not warn.

It is the error of the line model.
"""


@dataclass(frozen=True)
class FitOptions:
    """Choices for the fit of a damping model."""

    wires: WireCoefficients = "separate"
    """Whether contact and messenger wire have their own coefficients, or the same."""
    modal_groups: int = MODAL_GROUPS
    """Number of groups of span modes with a band of modal damping, from the first."""
    free: tuple[ParameterGroup, ...] = ("tensions",)
    """Properties of the line that are fitted together with the damping.

    None: the line is exact, and all groups of modes have the same weight.
    """
    tolerances: RealArray | None = None
    """Covariance of the factors of `MECHANICAL` [-]; None: the default of each."""

    def build_prior(self, free: tuple[ParameterGroup, ...]) -> Prior:
        """Prior of the properties of the line."""
        covariance = self.tolerances
        if covariance is None:
            covariance = np.diag([parameter.tolerance**2 for parameter in MECHANICAL])
        return build_prior(MECHANICAL, covariance, free)


def build_damping_results(
    modes: Sequence[Mode], line: Catenary, element: float, source: str, options: FitOptions = FitOptions()
) -> DampingResults:
    """Fit the damping of a line, and the properties of it that are free, to identified modes.

    Args:
        modes: Identified modes; lateral, uncertain and ungrouped ones are left out.
        line: Line of the record; its present damping is the reference of the comparison.
        element: Element length [m].
        source: Name of the file of the modes, for messages.
        options: Coefficients of the wires, free properties of the line, and bands of modal damping.

    Raises:
        InputError: There are too few modes, or too few of them have a computed counterpart.
    """
    usable, form = select_usable(modes, source), FORMS[options.wires]
    prior = options.build_prior(options.free or ("tensions",))
    joint = fit_jointly(usable, line, prior, form.shares, element, source)
    with_tensions = options.build_prior(("tensions", *options.free))
    evident = joint if "tensions" in prior.free else solve_about(joint, with_tensions, form.shares)
    comparison = refute_line(compare_line(usable, line), evident, with_tensions, line)
    matched = joint.linear.matched if options.free else match_modes(usable, line, element, source)
    measured, shapes = matched.measured, matched.shapes
    energies = component_energies(matched.mesh, shapes)
    stated = _compute_stated_ratios(matched, line)
    basis = form.join(build_damping_basis(shapes.frequency, energies, stated))
    paired_basis = basis.select_modes(np.array([pair.computed for pair in matched.pairs], dtype=np.int64))
    overlapping = matched.overlapping
    separate = np.flatnonzero(~overlapping)
    fitted_basis, fitted_modes = paired_basis.select_modes(separate), measured.select(separate)
    if options.free:
        fit = _describe_fit(joint, form, fitted_basis, fitted_modes, np.isin(separate, joint.used))
    else:
        fit = fit_damping_model(fitted_basis, fitted_modes)
    observability = tuple(
        row for row in compute_observability(fitted_basis, fitted_modes, fit) if row.largest_share > 0
    )
    coefficients = judge_coefficients(fit.coefficients, observability, matched.matching)
    bands = fit_modal_bands(measured, options.modal_groups)
    rayleigh = basis.predict(fit.values)
    properties, groups = list_properties(joint, prior) if options.free else (), assess_groups(joint)
    names = [f"{kind}_{matrix}_coefficient" for kind, matrix in form.terms]
    return DampingResults(
        modes_file=source,
        warnings=(
            *warn_about_line(comparison),
            *_warn_about_properties(properties),
            *_warn_about_groups(groups),
            *_warn_about_overlap(measured.frequency[overlapping]),
            *_warn_about_stated(fitted_basis.stated / fitted_modes.damping_ratio),
            *_warn_about_coefficients(coefficients),
        ),
        stated=_list_stated(line) if np.any(paired_basis.stated > 0) else (),
        line=comparison,
        matching=matched.matching,
        residual=fit.residual,
        coefficients=coefficients,
        properties=properties,
        covariance=name_covariance(joint, prior, names) if options.free else None,
        groups=groups,
        modal=tuple(
            MeasuredBand(from_Hz=b.from_frequency, to_Hz=b.to_frequency, damping_ratio=b.damping_ratio) for b in bands
        ),
        observability=observability,
        thresholds=THRESHOLDS,
        pairs=_list_pairs(matched, paired_basis.predict(fit.values), set(separate[fit.used])),
        shapes=list_paired_shapes(matched, line),
        comparison=_compare_models(matched, rayleigh, bands),
        unpaired=tuple(mode.frequency_Hz for mode in matched.unpaired),
    ).rounded()


def _describe_fit(
    joint: JointFit, form: WireForm, basis: DampingBasis, measured: MeasuredModes, used: NDArray[np.bool_]
) -> DampingFit:
    """Coefficients of a joint fit with their intervals, and its residual at the modes that overlap no other."""
    coefficients = tuple(
        Coefficient(kind=kind, matrix=matrix, value=float(value), low_95=float(low), high_95=float(high))
        for (kind, matrix), value, low, high in zip(form.terms, joint.values, *build_intervals(joint), strict=True)
    )
    predicted = basis.predict(dict(zip(form.terms, joint.values.tolist(), strict=True)))
    relative = (measured.damping_ratio - predicted) / measured.damping_ratio
    return DampingFit(coefficients, predicted, used, float(np.sqrt(np.mean(relative[used] ** 2))))


def _list_pairs(matched: MatchedModes, predicted: RealArray, used: set[int]) -> tuple[PairedMode, ...]:
    """Pairs with their measured and predicted damping ratios; `used` holds the indices of those in the fit."""
    return tuple(
        PairedMode(
            measured_Hz=mode.frequency_Hz,
            computed_Hz=matched.shapes.frequency[pair.computed],
            mac=pair.mac,
            group=mode.group,
            measured=mode.damping_ratio,
            fitted=ratio,
            used=i in used,
            overlapping=bool(overlapping),
        )
        for i, (pair, mode, ratio, overlapping) in enumerate(
            zip(matched.pairs, matched.paired, predicted, matched.overlapping, strict=True)
        )
    )


def _compare_models(matched: MatchedModes, rayleigh: RealArray, bands: tuple[ModalBand, ...]) -> FittedModels:
    """Measured damping ratios beside those of the line as it is, of the fit, and of the fit with modal bands."""
    measured, shapes = matched.measured, matched.shapes
    return FittedModels(
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


def _warn_about_properties(properties: Sequence[FittedProperty]) -> list[str]:
    """Warning about free properties that the modes do not determine."""
    names = [row.name.replace("_", " ") for row in properties if not row.determined]
    if not names:
        return []
    return [f"The modes do not determine: {', '.join(names)}. It stays at its stated value within its tolerance."]


def _warn_about_groups(groups: Sequence[GroupResidual]) -> list[str]:
    """Warning about groups of modes that the damping of the wires does not explain."""
    return [
        f"The damping of the wires does not explain group {row.group}: its {count_noun(row.modes, 'mode')} differ by "
        f"{100 * row.mean:+.1f} % on average; scatter as among the modes of a group gives this with a probability of "
        f"{row.probability:.1g}."
        for row in groups
        if not row.explained
    ]


def _warn_about_overlap(frequency: RealArray) -> list[str]:
    """Warning about measured modes [Hz] that are left out of the fit because they overlap other modes."""
    if not frequency.size:
        return []
    listed = ", ".join(f"{each:.3f}" for each in frequency)
    return [
        f"{count_noun(frequency.size, 'mode')} left out of the fit: {listed} Hz. Another measured or computed mode "
        "lies within the half-power bandwidth, so that the measured damping ratio can be a mixture of both."
    ]


def _warn_about_stated(share: RealArray) -> list[str]:
    """Warning if the stated damping of other components is a noticeable part of the damping ratio of any mode."""
    if share.max(initial=0.0) <= NOTICEABLE_SHARE:
        return []
    modes = count_noun(int(np.sum(share > NOTICEABLE_SHARE)), "mode")
    return [
        "The damping of droppers, steady arms and supports that the line states is subtracted from the measured "
        f"damping ratios. It is more than {100 * NOTICEABLE_SHARE:g} % of the damping ratio of {modes} "
        f"(largest {100 * share.max():.2g} %, median of all modes {100 * np.median(share):.2g} %). "
        "If it is wrong, the errors of the coefficients can exceed their intervals."
    ]


def _warn_about_coefficients(coefficients: Sequence[Coefficient]) -> list[str]:
    """Warnings about coefficients that are not determined, one per reason."""
    names: dict[str, list[str]] = {}
    for c in coefficients:
        if not c.determined:
            names.setdefault(c.reason, []).append(f"{c.kind.replace('_', ' ')} {c.matrix}")
    return [f"Not determined: {', '.join(terms)} ({reason})." for reason, terms in names.items()]


# Table `damping` of a line file from a fitted damping model.
MAX_NOTE = 4000
"""Largest length of a note in a line file [characters]."""


def write_damping_toml(results: DampingResults, modal: Sequence[MeasuredBand] = ()) -> str:
    """Text of the table `damping` of a line file, with the warnings as comments.

    A coefficient that is not determined is also a comment, so that no simulation uses it. Modal damping is
    written in the bands of `modal`: `results.modal`, or none for Rayleigh damping alone.
    """
    tables: dict[str, Any] = {
        "trust": "provisional",
        "source": f"fitted to {results.modes_file} by pantocheck drop fit"[:500],
        "note": f"residual {100 * results.residual:.2g} % of the measured damping ratios",
    }
    comments = [f"warning: {text}" for text in results.warnings]
    for c in results.coefficients:
        key = MATRICES[c.matrix].key
        for kind in WIRES if c.kind == JOINED_WIRES else (c.kind,):
            table = TABLE_OF_KIND[Kind(kind)]
            if c.determined:
                tables.setdefault(table, {})[key] = c.value
                comments.append(f"{table}.{key}: nominal 95 % interval {c.low_95:.3g} to {c.high_95:.3g}")
            else:
                comments.append(f"not determined, left out: {table}.{key} = {c.value:g}")
    for other in results.stated:
        tables[TABLE_OF_KIND[Kind(other.kind)]] = {
            MATRICES[matrix].key: value
            for matrix, value in (("stiffness", other.stiffness_coefficient_s), ("mass", other.mass_coefficient_1_s))
        }
        comments.append(f"{TABLE_OF_KIND[Kind(other.kind)]}: as the line states it, not fitted")
    if any(not c.determined for c in results.coefficients):
        comments.append("In a simulation, a coefficient that is left out counts as 0.")
    if results.warnings:
        tables["note"] = " ".join((tables["note"] + ".", *results.warnings))[:MAX_NOTE]
    if modal:
        tables["modal"] = [band.model_dump() for band in modal]
    lines = "".join(f"# {_join_lines(text)}\n" for text in comments)
    return lines + tomli_w.dumps({"damping": tables}, multiline_strings=False)


def _join_lines(text: str) -> str:
    """Text in one line, without characters that are not possible in a TOML comment."""
    return " ".join("".join(c if c.isprintable() else " " for c in text).split())
