"""Smallest half-widths of correct 95 % intervals for a field record: the Cramer-Rao bound with the true noise.

The data are the motion from the last slack dropper to the end of the record, on one clock. The noise is that of the
sensors and the ambient motion of each mode, both with their true powers. Poles and residues are unknown. For the
coefficients of damping, shapes and energies of the modes are known, and all modes in the reported band are used.
"""

from dataclasses import dataclass

import numpy as np

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.drops.damping_model import Term, build_damping_basis
from pantocheck.conformance.drops.decay_kernel import FrequencyBand
from pantocheck.conformance.drops.pole_refinement import refine_poles
from pantocheck.conformance.drops.process_noise import ProcessNoise
from pantocheck.conformance.drops.projection import build_block, whiten
from pantocheck.model import Kind
from pantocheck.model.modal.modes import component_energies
from verification.tables.field_records import RATE, FieldRecord, coloured_density

COVERED = 1.96
"""Half-width of an interval of 95 % over the standard deviation [-]."""
TERMS: tuple[Term, ...] = tuple(
    (str(kind), matrix) for kind in (Kind.CONTACT_WIRE, Kind.MESSENGER_WIRE) for matrix in ("stiffness", "mass")
)
"""Coefficients of the damping of the wires."""


@dataclass(frozen=True)
class SmallestWidths:
    """Half-widths for the poles of a record in the fitted band, by frequency."""

    frequency: RealArray
    """Of the frequencies, (m,) [Hz]."""
    ratio: RealArray
    """Of the damping ratios, (m,) [-]."""
    coefficients: dict[Term, float]
    """Of the coefficients [s, 1/s]."""
    covariance: RealArray
    """Covariance of decay rates [1/s] and angular frequencies [rad/s], (2 m, 2 m)."""


def compute_smallest_widths(field: FieldRecord, highest: float) -> SmallestWidths:
    """Smallest half-widths for modes up to a highest reported frequency [Hz]."""
    band = FrequencyBand.up_to(highest, RATE)
    start = int(np.ceil(field.taut * RATE))
    data = build_block(field.decay[start:], 1 / RATE, band.low, band.fitted)
    inside = np.abs(field.line.poles) < 2 * np.pi * band.fitted
    poles, n = field.line.poles[inside], data.n
    density = field.noise**2 + field.coloured**2 * coloured_density(n)[data.lines]
    floor = np.sqrt(n / 2 * density)[:, None] * np.ones(field.decay.shape[1])
    ratio = -poles.real / np.abs(poles)
    # Near its resonance, the acceleration of a mode is its force over twice the damping ratio.
    power = n / 2 * (field.ambient[inside] / (2 * ratio)) ** 2
    shapes = field.shape[:, inside].T.astype(np.complex128)
    driven = power > 0
    process = ProcessNoise(poles[driven], shapes[driven], power[driven], power[driven], data.omega, floor)
    white = whiten([data], [process if driven.any() or field.coloured else floor[0]])
    deviation = np.sqrt(np.diag(covariance := refine_poles(poles, white, iterations=0).covariance))
    m = poles.size
    return SmallestWidths(
        COVERED * deviation[m:] / (2 * np.pi),
        COVERED * deviation[:m] / np.abs(poles),
        _bound_coefficients(field, covariance[:m, :m], highest),
        covariance,
    )


def _bound_coefficients(field: FieldRecord, decay_rates: RealArray, highest: float) -> dict[Term, float]:
    """Half-widths of the coefficients, by the covariance of the decay rates of the lowest poles."""
    mesh, modes, poles = field.line.mesh, field.line.modes, field.line.poles
    reported = np.arange(int(np.sum(np.abs(poles) < 2 * np.pi * highest)))
    basis = build_damping_basis(modes.frequency, component_energies(mesh, modes), np.zeros(modes.frequency.size))
    columns = basis.ratios[reported][:, [basis.terms.index(term) for term in TERMS]]
    omega = np.abs(poles[reported])
    covariance = decay_rates[np.ix_(reported, reported)] / np.outer(omega, omega)
    information = columns.T @ np.linalg.solve(covariance, columns)
    deviation = np.sqrt(np.diag(np.linalg.inv(information)))
    return dict(zip(TERMS, (COVERED * deviation).tolist(), strict=True))
