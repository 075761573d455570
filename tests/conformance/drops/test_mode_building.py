"""Modes and frequency responses of exact fits, compared with their closed forms."""

from dataclasses import replace

import numpy as np
import pytest

from helpers.exact_decays import BAND, RATE, RELEASE, build_exact_decay, build_exact_fit, with_quantity
from pantocheck.conformance.core.array_types import ComplexArray
from pantocheck.conformance.core.units import STANDARD_GRAVITY
from pantocheck.conformance.drops.identification_analysis import analyse_identification, compute_frequency_response
from pantocheck.conformance.drops.identify import Identification
from pantocheck.conformance.drops.line_fit import LineFit, build_modes

FREQUENCY, RATIO = np.array([0.9, 1.7, 2.6]), np.array([0.012, 0.010, 0.008])
POLES = 2 * np.pi * FREQUENCY * (-RATIO + 1j * np.sqrt(1 - RATIO**2))
RESIDUES = np.array([[1.0 + 0.1j, -0.4], [0.3j, 0.6j + 0.02], [0.2, 0.5]])
NOISE = np.array([0.02, 0.005])


def with_residual(fit: LineFit, residual: ComplexArray) -> LineFit:
    """The fit of one block with another residual, (k, c)."""
    (block,) = fit.blocks
    changed = replace(block, fit=replace(block.fit, residual=residual))
    return replace(fit, blocks=(changed,), records=tuple(replace(r, block=changed) for r in fit.records))


@pytest.fixture(scope="module")
def fit() -> LineFit:
    return build_exact_fit([build_exact_decay(POLES, RESIDUES)], POLES, NOISE)


def test_modes_of_an_exact_fit_are_exact(fit: LineFit) -> None:
    """Only the rounding of the transform, 1e-10 of the signal, and that of the filter are left."""
    modes = build_modes(fit, 6)
    assert [mode.frequency_Hz for mode in modes] == pytest.approx(FREQUENCY, rel=1e-9)
    assert [mode.damping_ratio for mode in modes] == pytest.approx(RATIO, rel=1e-7)
    assert [mode.error for mode in modes] == pytest.approx([0.0] * 3, abs=1e-8)
    for mode, residues in zip(modes, RESIDUES, strict=True):
        largest = residues[np.argmax(np.abs(residues))]
        assert mode.amplitude_at_release == pytest.approx(2 * abs(largest), rel=1e-7)
        shape = [complex(part.re, part.im) for part in mode.sensor_shape]
        assert shape == pytest.approx(list(residues / largest), abs=1e-8)
        assert [part.position_m for part in mode.sensor_shape] == [20.0, 40.0]
        duration = fit.records[0].decay.linear.duration
        assert mode.half_power_points == pytest.approx(2 * mode.damping_ratio * mode.frequency_Hz * duration)
    assert [mode.phase_collinearity for mode in modes][1:] == pytest.approx([0.9997, 1.0], abs=5e-4)


def test_residual_and_edges_of_the_band(fit: LineFit) -> None:
    """The half-power band reaches to the decay rate on either side of the mode, and at least to the next line."""
    omega, spectrum = fit.blocks[0].data.omega, fit.blocks[0].data.spectrum
    reach = np.maximum(-POLES.real, 2 * np.pi / fit.blocks[0].data.duration)
    inside = np.any(np.abs(omega[:, None] - POLES.imag) <= reach, axis=1)
    modes = build_modes(with_residual(fit, np.where(inside[:, None], 0.0, spectrum)), 6)
    assert [mode.error for mode in modes] == [0.0] * 3
    modes = build_modes(with_residual(fit, np.where(inside[:, None], spectrum, 0.0)), 6)
    assert [mode.error for mode in modes] == pytest.approx([1.0] * 3)
    # A residual of a tenth of the spectrum; its share is the same whatever noise scales the channels.
    modes = build_modes(with_residual(fit, 0.1 * fit.blocks[0].data.spectrum), 6)
    assert [mode.error for mode in modes] == pytest.approx([0.1] * 3, rel=1e-9)
    edges = np.abs(fit.poles) / (2 * np.pi)
    band = replace(BAND, low=edges[0], high=edges[2])
    assert len(build_modes(replace(fit, band=band), 6)) == 3


def test_residual_above_the_noise_widens_the_uncertainty(fit: LineFit) -> None:
    """A residual of three times the noise, whose parts have one standard deviation each: 3 times as uncertain."""
    # One mode has a half-power band wider than three lines: there the residual counts over two decay rates.
    shape = fit.blocks[0].data.spectrum.shape
    exact = build_modes(with_residual(fit, np.zeros(shape, complex)), 6)
    white = build_modes(with_residual(fit, np.full(shape, 3 * np.sqrt(2)) * NOISE + 0j), 6)
    for a, b in zip(exact, white, strict=True):
        assert b.damping_ratio_std == pytest.approx(3 * a.damping_ratio_std, rel=1e-6)
        assert b.frequency_std_Hz == pytest.approx(3 * a.frequency_std_Hz, rel=1e-6)
        assert a.damping_ratio_std == pytest.approx(
            2 * np.pi * a.frequency_std_Hz / abs(POLES[exact.index(a)]), rel=0.1
        )
    pole = np.array([2 * np.pi * 1.7 * (-0.04 + 1j)])
    wide = build_exact_fit([build_exact_decay(pole, np.array([[1.0, 0.5]]))], pole, NOISE)
    distance = np.abs(wide.blocks[0].data.omega - pole.imag)
    lines = 3 * 2 * np.pi / wide.blocks[0].data.duration
    ring = (distance > lines) & (distance < -2 * pole.real)
    residual = np.where(ring[:, None], 20.0, 0.0) * NOISE + 0j
    (plain,), (widened,) = (build_modes(with_residual(wide, r), 6) for r in (0 * residual, residual))
    inside = distance < -2 * pole.real
    expected = np.sqrt(400.0 * ring.sum() / (2 * inside.sum()))
    assert widened.damping_ratio_std == pytest.approx(expected * plain.damping_ratio_std, rel=1e-6)


def test_repeats_share_the_shape_of_the_best_record() -> None:
    """Of two repeats the one with the longer linear decay has the larger residues; amplitude and shape are exact."""
    decays = [
        build_exact_decay(POLES, RESIDUES, "late", after=6.0, duration=45.0),
        build_exact_decay(POLES, RESIDUES, "early"),
    ]
    for order in (decays, decays[::-1]):
        modes = build_modes(build_exact_fit(order, POLES, NOISE), 6)
        for mode, residues in zip(modes, RESIDUES, strict=True):
            assert mode.record == "early"
            largest = residues[np.argmax(np.abs(residues))]
            assert mode.amplitude_at_release == pytest.approx(2 * abs(largest), rel=1e-7)
            assert [complex(part.re, part.im) for part in mode.sensor_shape] == pytest.approx(
                list(residues / largest), abs=1e-8
            )
            assert all(part.std is not None and part.std > 0 for part in mode.sensor_shape)


@pytest.mark.parametrize(("ratio", "lateral"), [(19.0, False), (21.0, True)])
def test_lateral_mode_moves_twenty_times_as_far_sideways(ratio: float, lateral: bool) -> None:
    sideways = np.array([0.0, ratio * 0.6, 0.0])
    fit = build_exact_fit([build_exact_decay(POLES, RESIDUES, lateral=sideways)], POLES, NOISE)
    modes = build_modes(fit, 6)
    largest = np.abs(RESIDUES[1]).max()
    assert modes[1].lateral_over_vertical == pytest.approx(ratio * 0.6 / largest, rel=1e-6)
    assert [mode.lateral for mode in modes] == [False, lateral, False]


def test_close_modes_are_near_coincident() -> None:
    """Half-power bandwidth 2 z f = 0.034 Hz: warned below two bandwidths, 0.068 Hz."""
    for distance, warned in ((0.066, True), (0.070, False)):
        frequency = np.array([1.7, 1.7 + distance])
        poles = 2 * np.pi * frequency * (-0.01 + 1j * np.sqrt(1 - 1e-4))
        fit = build_exact_fit([build_exact_decay(poles, RESIDUES[:2], duration=100.0)], poles, 1e-3 * NOISE)
        mode = build_modes(fit, 6)[0]
        assert (
            any(f"the distance to another mode is only {1000 * distance:.1f} mHz" in text for text in mode.warnings)
            == warned
        )


@pytest.mark.parametrize(("quantity", "power"), [("acceleration", 1), ("velocity", 2), ("displacement", 3)])
def test_frequency_response_is_the_transform_of_the_decay(quantity: str, power: int) -> None:
    """A release of 20 kg: H = (i w)^p X / (m g), where X is the transform of the sensor from the release to the end."""
    # The lines lie at multiples of 1 / 40 s from 0.3 to 4.0 Hz. The measured transform is a sum over samples: it has
    # half a sample more at the start, and aliases, together below 1 % of the largest line.
    decay = with_quantity(build_exact_decay(POLES, RESIDUES), quantity)
    fit = build_exact_fit([decay], POLES, NOISE)
    response = compute_frequency_response(fit, fit.records[0])
    assert response.frequency == pytest.approx(np.arange(12, 161) / 40.0)
    omega = 2 * np.pi * response.frequency
    transform = np.zeros((omega.size, 2), dtype=complex)
    for pole, residue in zip(POLES, RESIDUES, strict=True):
        for p, r in ((pole, residue), (pole.conj(), residue.conj())):
            transform += np.outer((np.exp(p * 40.0) - 1) / (p - 1j * omega), r)
    expected = (1j * omega[:, None]) ** power * transform / (20.0 * STANDARD_GRAVITY)
    assert response.identified == pytest.approx(expected, abs=1e-7 * np.abs(expected).max())
    samples = decay.record.signals[round(RELEASE * RATE) :]
    summed = np.exp(-1j * np.outer(omega, np.arange(samples.shape[0]) / RATE)) @ samples / RATE
    expected = (1j * omega[:, None]) ** power * summed / (20.0 * STANDARD_GRAVITY)
    assert response.measured == pytest.approx(expected, abs=1e-9 * np.abs(expected).max())
    assert np.abs(summed - transform).max() < 0.01 * np.abs(transform).max()


def test_frequency_response_includes_its_edges_and_needs_a_mass(fit: LineFit) -> None:
    """Lines at multiples of 1 / 40 s, of which 0.5 and 3 Hz are exact numbers."""
    banded = replace(fit, band=replace(BAND, low=0.5, high=3.0))
    response = compute_frequency_response(banded, fit.records[0])
    assert (response.frequency[0], response.frequency[-1], response.frequency.size) == (0.5, 3.0, 101)
    decay = fit.records[0].decay
    unknown = replace(decay, record=replace(decay.record, drop=replace(decay.record.drop, mass=None)))
    assert compute_frequency_response(fit, replace(fit.records[0], decay=unknown)) is None


def test_analysis_lists_groups_and_spectra(fit: LineFit) -> None:
    """The fitted spectrum is the measured one without the residual; a group lists its certain modes alone."""
    ratios, certain = (0.01, 0.012, 0.03, 0.02, 0.05), (True, True, False, True, False)
    template = build_modes(fit, 6)[0]
    modes = tuple(
        template.model_copy(update={"frequency_Hz": 1.0 + i, "damping_ratio": z, "certain": c, "group": g})
        for i, (z, c, g) in enumerate(zip(ratios, certain, (1, 1, 1, 2, 3), strict=True))
    )
    residual = 0.25 * fit.blocks[0].data.spectrum
    analysis = analyse_identification(Identification(with_residual(fit, residual), modes, ()))
    rows = [(g.group, g.modes, g.certain, g.from_Hz, g.to_Hz, g.lowest, g.highest) for g in analysis.groups]
    assert rows == [(1, 3, 2, 1.0, 3.0, 0.01, 0.012), (2, 1, 1, 4.0, 4.0, 0.02, 0.02), (3, 1, 0, 5.0, 5.0, None, None)]
    assert [g.median_damping_ratio for g in analysis.groups] == [pytest.approx(0.011), 0.02, None]
    (spectra,) = analysis.spectra
    assert (
        spectra.frequency_Hz[-1]
        <= BAND.high
        < spectra.frequency_Hz[-1] + spectra.frequency_Hz[1] - spectra.frequency_Hz[0]
    )
    for c in range(2):
        measured = np.abs(fit.blocks[0].data.spectrum[: len(spectra.frequency_Hz), c]) / RATE
        assert spectra.measured[c] == pytest.approx(measured, rel=1e-5)
        assert spectra.fitted[c] == pytest.approx(0.75 * measured, rel=1e-5)
        assert spectra.residual[c] == pytest.approx(0.25 * measured, rel=1e-5)
