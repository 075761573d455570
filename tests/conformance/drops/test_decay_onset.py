"""Onset of the linear decay by the poles, and the rates of the clocks in their covariance."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from helpers.surrogate_drops import build_line_modes, make_record
from pantocheck.conformance.drops.decay_onset import find_onset, find_transients, move_onset, refuse_onset
from pantocheck.conformance.drops.identify import Identification, identify_modes
from pantocheck.conformance.drops.line_fit import LineFit, fit_line
from pantocheck.conformance.drops.pole_refinement import add_clock_rates
from pantocheck.conformance.drops.process_noise import ProcessNoise
from pantocheck.conformance.drops.projection import build_block
from pantocheck.conformance.drops.sensor_clocks import _merge_near_poles, build_equations, compare_clocks
from verification.tables.field_records import LINES, Disturbance


@pytest.fixture(scope="module")
def found() -> Identification:
    """Three sensors, ambient motion as strong as the noise."""
    modes = build_line_modes(next(iter(LINES)))
    made = make_record(modes, np.random.default_rng(3), Disturbance(wind=1.0), sensors=3, minutes=1.5)
    return identify_modes((made.record,), 2.3)[0]


def change_samples(found: Identification, factor: np.ndarray) -> LineFit:
    """Fit of the decays times a factor of each sample, with the poles and the noise found without it."""
    fit, record = found.fit, found.fit.records[0]
    linear, process = record.decay.linear, record.block.process
    samples = linear.samples * factor[:, None]
    decay = replace(record.decay, linear=replace(linear, samples=samples))
    data = build_block(samples, linear.dt, fit.band.low, fit.band.fitted)
    assert process is not None
    return fit_line([decay], [(0, record.columns)], [data], fit.poles, [process], fit.band, 0)


def test_rounding_changes_no_pole(found: Identification) -> None:
    """The last bit of each sample, which another processor may round differently, moves a pole by percents at most.

    Those beyond the band, which the record hardly determines, move by 1 % of their decay rates, all others by 1e-6.
    """
    record = found.fit.records[0].decay.record
    bits = 1 + 1e-15 * np.random.default_rng(1).standard_normal(record.signals.shape)
    (other,) = identify_modes((replace(record, signals=record.signals * bits),), 2.3)
    assert other.fit.poles.size == found.fit.poles.size
    change = np.abs(other.fit.poles - found.fit.poles) / -found.fit.poles.real
    assert change.max() < 0.05
    assert change[found.fit.poles.imag < 2 * np.pi * 2.3].max() < 1e-5


def test_linear_decay_keeps_its_onset(found: Identification) -> None:
    """Beside ambient motion, the decay begins 2 s after the release; a sample is 0.03 s."""
    decay = found.fit.records[0].decay
    assert decay.linear.start - decay.release.time == pytest.approx(2.0, abs=0.04)
    assert find_onset(found.fit).excess < 1


def test_decay_begins_after_a_part_that_biases_the_modes(found: Identification) -> None:
    """Amplitudes that are 2 % larger in the first 1.5 s: from 1 s on, a third of them may stay unseen."""
    linear = found.fit.records[0].decay.linear
    early = np.arange(linear.samples.shape[0]) * linear.dt < 1.5
    onset = find_onset(change_samples(found, np.where(early, 1.02, 1.0)))
    assert onset.delay in (1.0, 2.0)
    assert onset.excess > 1
    decay = found.fit.records[0].decay
    cut = move_onset(decay, decay, 2.0)
    assert cut.linear.start == pytest.approx(linear.start + 2.0, abs=linear.dt / 2)
    assert any("with an earlier start, the modes differ" in text for text in cut.warnings)


def test_decay_whose_modes_never_agree_is_refused(found: Identification) -> None:
    """Amplitudes that change by a fifth every 7 s, to the end of the record."""
    linear = found.fit.records[0].decay.linear
    time = np.arange(linear.samples.shape[0]) * linear.dt
    onset = find_onset(change_samples(found, 1 + 0.1 * np.sign(np.sin(2 * np.pi * time / 7.0))))
    assert onset.delay is None
    assert "is not a linear decay: the part from 2 s after the release has other modes" in str(
        refuse_onset(found.fit.records[0].decay, onset)
    )


def test_decay_begins_when_transients_have_died_out(found: Identification) -> None:
    """A transient at 2.1 Hz with e^(-2 t): from its amplitude over the noise of its residue, within 10 %."""
    fit, record = found.fit, found.fit.records[0]
    assert not find_transients(fit).any()
    linear, process = record.decay.linear, record.block.process
    time = np.arange(linear.samples.shape[0]) * linear.dt
    pole, height = -2.0 + 2j * np.pi * 2.1, 30 * np.abs(linear.samples).mean()
    samples = linear.samples + height * np.exp(pole * time).real[:, None]
    data = build_block(samples, linear.dt, fit.band.low, fit.band.fitted)
    assert process is not None
    decay = replace(record.decay, linear=replace(linear, samples=samples))
    poles = np.append(fit.poles, pole)
    poles = poles[np.argsort(poles.imag)]
    changed = fit_line([decay], [(0, record.columns)], [data], poles, [process], fit.band, 4)
    transients = find_transients(changed)
    assert changed.poles[transients] == pytest.approx([pole], rel=0.02)
    onset, block = find_onset(changed), changed.blocks[0]
    ratio = np.abs(block.fit.residues[transients] / block.residue_std[transients]).max()
    assert onset.delay == pytest.approx(min(np.log(ratio) / 2.0, 8.0), rel=0.1)
    assert (onset.transients, onset.excess) == (1, 0.0)
    assert "needs 1 pole with more than 5 times the decay of its modes" in str(refuse_onset(decay, onset))


def test_poles_beyond_the_band_that_cancel_move_neither_onset_nor_clocks() -> None:
    """Two undamped poles, a fifth of a spectral line apart, in calm air: their residues are as large as can be."""
    modes = build_line_modes(next(iter(LINES)))
    made = make_record(modes, np.random.default_rng(3), Disturbance(), sensors=3, minutes=1.5)
    fit = identify_modes((made.record,), 2.3)[0].fit
    block = fit.blocks[0]
    apart = 2 * np.pi / block.data.duration * np.array([0.0, 0.2])
    poles = np.append(fit.poles, 2j * np.pi * (fit.band.fitted + 0.4) - 1e-5 + 1j * apart)
    record = fit.records[0]
    more = fit_line([record.decay], [(0, record.columns)], [block.data], poles, [block.noise], fit.band, 0)
    assert find_onset(more).excess == pytest.approx(find_onset(fit).excess, abs=0.1)
    for clock, alone in zip(compare_clocks(more).clocks, compare_clocks(fit).clocks, strict=True):
        assert clock.rate == pytest.approx(alone.rate, abs=alone.rate_std)


def test_second_of_two_near_poles_changes_no_clock(found: Identification) -> None:
    """A pole beside that of a mode, by a third of a spectral line, is left out where the clocks are compared."""
    fit, record = found.fit, found.fit.records[0]
    line = 2 * np.pi / record.block.data.duration
    poles = np.insert(fit.poles, 4, fit.poles[3] + 1j * line / 3)
    process = record.block.process
    assert process is not None
    data = [block.data for block in fit.blocks]
    doubled = fit_line([record.decay], [(0, record.columns)], data, poles, [process], fit.band, 0)
    merged = _merge_near_poles(doubled)
    assert merged.poles.size == fit.poles.size
    found_poles, kept = (part.poles.imag[part.poles.imag < 2 * np.pi * fit.band.high] for part in (merged, fit))
    assert_allclose(np.sort(found_poles), np.sort(kept), atol=line / 3)
    assert _merge_near_poles(fit) is fit
    assert not any(clock.deviates for clock in compare_clocks(doubled).clocks)


def test_unknown_rates_widen_the_poles_and_do_not_depend_on_the_form_of_the_noise(found: Identification) -> None:
    """White noise as a covariance at each line gives the equations of separate sensors, up to rounding."""
    fit = found.fit
    block, channels = fit.blocks[0], fit.blocks[0].noise.size
    free = np.asarray(compare_clocks(fit).covariance)
    # The errors of poles beyond the band are bounded by ten reaches, which narrows their neighbours by a little.
    inside = np.tile(fit.poles.imag < 2 * np.pi * fit.band.high, 2)
    assert np.all((np.diag(free) > np.diag(fit.covariance) * (1 - 0.01))[inside])
    assert (np.diag(free) / np.diag(fit.covariance)).max() > 1.05
    empty = np.zeros(0, dtype=np.complex128)
    floor = np.tile(block.noise, (2, 1))
    nodes = block.data.omega[[0, -1]]
    flat = ProcessNoise(empty, np.zeros((0, channels), complex), np.zeros(0), np.zeros(0), nodes, floor)
    plain = replace(block, process=None, data=replace(block.data, whitening=None))
    white = replace(fit, blocks=(plain,), records=(replace(fit.records[0], block=plain),))
    separate = build_equations(white, plain, (1, 2, 3))
    together = add_clock_rates(fit.poles, flat.whiten(plain.data), np.eye(3, dtype=bool))
    largest = np.abs(separate.matrix).max()
    assert_allclose(together.matrix, separate.matrix, rtol=1e-6, atol=1e-9 * largest)
