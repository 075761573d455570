"""Damping of another line of the same materials (Vo Van, Balmes and Lorang 2015, last section).

The Rayleigh coefficients of the wires that were fitted on one line are used on another line. The damping ratio of a
mode follows from its energies in the wires. The rule holds while material damping dominates: the wires must have the
same material, the other components must hardly damp, and the frequency must lie in the measured range.
"""

from dataclasses import dataclass

import numpy as np

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.near_limit import QUANTILE_95
from pantocheck.conformance.drops.damping_model import JOINED_WIRES, WIRES, build_damping_basis, list_other_damping
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.results.damping_format import Coefficient, DampingResults
from pantocheck.model import discretise
from pantocheck.model.discretisation.discretised_line import with_damping
from pantocheck.model.modal.modes import component_energies, compute_modes_below, damping_ratios

SAME_DENSITY = 0.02
"""Largest relative difference of the mass per length and area of wires of the same material [-]."""
LARGEST_OTHER_SHARE = 0.1
"""Largest share of droppers, arms and supports in the damping of a mode for which material damping dominates [-]."""


@dataclass(frozen=True)
class TransferredDamping:
    """Damping ratios of the modes of a line by the coefficients of another line."""

    frequency: RealArray
    """Frequencies of the modes inside the measured range, ascending, (n,) [Hz]."""
    ratio: RealArray
    """Damping ratios, (n,) [-]."""
    half_width: RealArray
    """Half-widths of intervals of at least 95 %, from those of the coefficients and the residual of the fit, (n,) [-].

    The effects of the coefficients are added as if they agreed, which is an upper bound."""
    violations: tuple[str, ...]
    """Conditions of the rule that do not hold, or that the files do not confirm; empty: it holds."""


def transfer_damping(fitted: DampingResults, measured: LineFile, other: LineFile, element: float) -> TransferredDamping:
    """Predict the damping ratios of another line of the same materials.

    Args:
        fitted: Damping model that was fitted on the measured line.
        measured: Line of the fit.
        other: Line of the prediction; the damping that it states for other components than the wires is added.
        element: Element length [m].

    Raises:
        InputError: The other line has no mode in the measured range of frequencies.
    """
    low, high = min(fitted.comparison.measured.frequency_Hz), max(fitted.comparison.measured.frequency_Hz)
    line = build_catenary(other)
    mesh = discretise(line, element)
    modes = compute_modes_below(mesh, high)
    inside = np.flatnonzero(modes.frequency >= low)
    if inside.size == 0:
        raise InputError("transfer", f"the line has no mode from {low:.3g} to {high:.3g} Hz", "Give a longer line.")
    stated = damping_ratios(with_damping(mesh, list_other_damping(line)), modes)
    basis = build_damping_basis(modes.frequency, component_energies(mesh, modes), stated)
    if any(coefficient.kind == JOINED_WIRES for coefficient in fitted.coefficients):
        basis = basis.join_wires()
    basis = basis.select_modes(inside)
    ratio = basis.predict({(c.kind, c.matrix): c.value for c in fitted.coefficients})
    columns = [basis.ratios[:, basis.terms.index((c.kind, c.matrix))] for c in fitted.coefficients]
    reach = [max(c.high_95 - c.value, c.value - c.low_95) for c in fitted.coefficients]
    # Coefficients are correlated: their effects are added, which is never too small.
    by_coefficients = np.sum([np.abs(column) * width for column, width in zip(columns, reach, strict=True)], axis=0)
    by_form = QUANTILE_95 * fitted.residual * ratio
    violations = [*_compare_materials(measured, other), *_doubt_fit(fitted.coefficients, basis.stated / ratio)]
    return TransferredDamping(modes.frequency[inside], ratio, np.hypot(by_coefficients, by_form), tuple(violations))


def _compare_materials(measured: LineFile, other: LineFile) -> list[str]:
    """Wires whose material is another one, or not known: the density decides."""
    violations = []
    for key in map(str, WIRES):
        wires = [getattr(line, key) for line in (measured, other)]
        name = key.replace("_", " ")
        if any(wire.area_mm2 is None for wire in wires):
            violations.append(f"{name}: the same material is not confirmed, because area_mm2 is missing")
            continue
        first, second = (wire.mass_kg_m / wire.area_mm2 for wire in wires)
        if abs(second / first - 1) > SAME_DENSITY:
            violations.append(
                f"{name}: mass over area differs by {100 * (second / first - 1):+.1f} %: another material"
            )
    return violations


def _doubt_fit(coefficients: tuple[Coefficient, ...], share: RealArray) -> list[str]:
    """Undetermined coefficients, and modes that other components damp noticeably."""
    undetermined = [f"{c.kind} {c.matrix}" for c in coefficients if not c.determined and c.value > 0]
    violations = [f"not determined by the measured modes: {', '.join(undetermined)}"] if undetermined else []
    if share.max() > LARGEST_OTHER_SHARE:
        violations.append(f"other components have up to {100 * share.max():.0f} % of the damping of a mode")
    return violations
