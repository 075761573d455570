"""Identification of the modes of a line from the records of mass drops."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from pantocheck.conformance.array_types import ComplexArray, RealArray
from pantocheck.conformance.identification.decay_filters import filter_gain
from pantocheck.conformance.identification.decay_preparation import PreparedDecay, prepare_decay
from pantocheck.conformance.identification.linear_decay import FrequencyBand
from pantocheck.conformance.identification.mode import Mode, SensorShape
from pantocheck.conformance.identification.mode_groups import find_group_outliers, number_groups
from pantocheck.conformance.identification.mode_quality import (
    is_certain,
    is_lateral,
    list_mode_warnings,
    phase_collinearity,
)
from pantocheck.conformance.identification.model_order import estimate_noise, find_hidden_poles, select_poles, whiten
from pantocheck.conformance.identification.pole_refinement import refine_poles
from pantocheck.conformance.identification.projection import (
    DataBlock,
    ProjectionFit,
    build_block,
    residue_spread,
    solve_residues,
)
from pantocheck.conformance.identification.start_poles import find_start_poles
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.mass_drops.drop_record import DropRecord

SAME_LENGTH = 0.02  # repeats whose lengths differ by less are cut to the shortest and share one set of columns
SHARED_POLES = 1.5  # squared error over its expectation above which several records do not share their poles
FREQUENCY_REACH = 3  # spectral lines on each side over which a mode's own residual is judged


@dataclass(frozen=True)
class Identification:
    """Modes of one line.

    Parameters
    ----------
    prepared : tuple[PreparedDecay, ...]
        The records, with the stretch used of each.
    band : FrequencyBand
        What was identified.
    modes : tuple[Mode, ...]
        By frequency.
    poles : complex ndarray
        Of the fit, those beyond the reported band included [1/s].
    blocks : tuple[DataBlock, ...]
        Data of the fit; the sensors of record r are the columns `columns[r]` of block `block_of[r]`.
    fits : tuple[ProjectionFit, ...]
        Residues and residual of each block.
    noise : tuple[ndarray, ...]
        Per block, (c,) standard deviation of a line's real or imaginary part.
    block_of, columns : tuple[int, ...] or tuple[slice, ...]
        Where each record's sensors are.
    misfit : float
        Squared error over its expectation; 1 if the model is complete.
    warnings : tuple[str, ...]
        What is doubtful about the whole.
    """

    prepared: tuple[PreparedDecay, ...]
    band: FrequencyBand
    modes: tuple[Mode, ...]
    poles: ComplexArray
    blocks: tuple[DataBlock, ...]
    fits: tuple[ProjectionFit, ...]
    noise: tuple[RealArray, ...]
    block_of: tuple[int, ...]
    columns: tuple[slice, ...]
    misfit: float
    warnings: tuple[str, ...]


def identify_modes(
    records: tuple[DropRecord, ...],
    highest: float = 10.0,
    poles: ComplexArray | None = None,
    progress: Callable[[str], None] = lambda text: None,
) -> tuple[Identification, ...]:
    """Modes of every line that the records are of.

    Records of one line (same spans, same tensions) share their poles; each keeps residues of its own.

    Parameters
    ----------
    records : tuple[DropRecord, ...]
        Repeats, or drops at several places.
    highest : float
        Modes up to here are reported [Hz].
    poles : complex ndarray or None
        Start values placed by hand [1/s]; neither added to nor removed from. None: found from the records.
    progress : Callable[[str], None]
        Told what is being done.

    Raises
    ------
    InputError
        a record that cannot be used.
    """
    if not records:
        raise InputError("records", "none given", "Name at least one record.")
    lines: dict[object, list[DropRecord]] = {}
    for record in records:
        lines.setdefault(_line_key(record), []).append(record)
    return tuple(_identify_line(tuple(own), highest, poles, progress) for own in lines.values())


def _line_key(record: DropRecord) -> object:
    line = record.line
    # Records that say nothing of their line are taken to be of one only if they come from the same file.
    return line if line.spans else (line, record.file or record.source)


def _identify_line(
    records: tuple[DropRecord, ...], highest: float, given: ComplexArray | None, progress: Callable[[str], None]
) -> Identification:
    slowest = min(records, key=lambda record: record.rate)
    band = FrequencyBand.up_to(highest, slowest.rate)
    if band.high < min(2 * band.low, highest):
        raise InputError(
            slowest.name,
            f"its sampling rate of {slowest.rate:g} Hz is too low: modes could be told up to {band.high:.2g} Hz",
            "Export the record at its original rate; 50 Hz and more are usual.",
        )
    prepared = []
    for record in records:
        progress(f"{record.name}: release and linear stretch")
        prepared.append(prepare_decay(record, band))
    stretches, block_of, columns = _arranged(prepared)
    blocks = [build_block(samples, dt, band.low, band.fitted) for samples, dt in stretches]
    progress(f"{records[0].name}: poles")
    if given is not None:
        noise = [estimate_noise(solve_residues(given, data), given.size, data) for data in blocks]
        for _ in range(3):
            given = refine_poles(given, whiten(blocks, noise)).poles
            noise = [estimate_noise(solve_residues(given, data), given.size, data) for data in blocks]
        poles = given
    else:
        structure = find_hidden_poles(select_poles(_start(prepared, stretches, band), blocks), blocks)
        poles, noise = structure.poles, structure.noise
    progress(f"{records[0].name}: uncertainty")
    return _reported(tuple(prepared), band, poles, blocks, noise, block_of, columns)


def _start(
    prepared: list[PreparedDecay], stretches: list[tuple[RealArray, float]], band: FrequencyBand
) -> ComplexArray:
    (dt,) = {dt for _, dt in stretches} if len({dt for _, dt in stretches}) == 1 else (0.0,)
    if dt == 0.0:
        # Records of different rates: the longest alone gives the start.
        return max(prepared, key=lambda one: one.stretch.duration).stretch.poles
    return find_start_poles(
        [samples / samples.std(axis=0) for samples, _ in stretches], 1 / dt, band.low, band.fitted + 0.5
    )


def _arranged(
    prepared: list[PreparedDecay],
) -> tuple[list[tuple[RealArray, float]], tuple[int, ...], tuple[slice, ...]]:
    """Samples of the blocks, and for each record its block and its columns there."""
    stretches: list[tuple[RealArray, float]] = []
    block_of, columns = [], []
    for one in prepared:
        samples, dt = one.stretch.samples, one.stretch.dt
        for b, (other, other_dt) in enumerate(stretches):
            shorter = min(samples.shape[0], other.shape[0])
            if dt == other_dt and shorter > (1 - SAME_LENGTH) * max(samples.shape[0], other.shape[0]):
                columns.append(slice(other.shape[1], other.shape[1] + samples.shape[1]))
                stretches[b] = (np.hstack([other[:shorter], samples[:shorter]]), dt)
                block_of.append(b)
                break
        else:
            block_of.append(len(stretches))
            columns.append(slice(0, samples.shape[1]))
            stretches.append((samples, dt))
    return stretches, tuple(block_of), tuple(columns)


def _reported(
    prepared: tuple[PreparedDecay, ...],
    band: FrequencyBand,
    poles: ComplexArray,
    blocks: list[DataBlock],
    noise: list[RealArray],
    block_of: tuple[int, ...],
    columns: tuple[slice, ...],
) -> Identification:
    white = whiten(blocks, noise)
    refined = refine_poles(poles, white, iterations=10)
    poles, m = refined.poles, refined.poles.size
    fits = tuple(solve_residues(poles, data) for data in blocks)
    spreads = [residue_spread(poles, data) for data in blocks]
    misfit = _misfit(refined.cost, m, white)
    decay_std, omega_std = (np.sqrt(np.diag(refined.covariance)[part]) for part in (slice(0, m), slice(m, None)))
    whole = Identification(prepared, band, (), poles, tuple(blocks), fits, tuple(noise), block_of, columns, misfit, ())
    frequency = np.abs(poles) / (2 * np.pi)
    reported = np.flatnonzero((frequency >= band.low) & (frequency <= band.high))
    lateral = [_lateral_share(whole, r) for r in range(len(prepared))]
    modes = []
    for j in reported:
        inflation = _inflation(white, fits, noise, poles[j])
        nearest = float(np.min(np.abs(np.delete(frequency, j) - frequency[j]), initial=np.inf))
        modes.append(
            _mode(whole, int(j), decay_std[j] * inflation, omega_std[j] * inflation, spreads, nearest, lateral)
        )
    warnings = [text for one in prepared for text in one.warnings]
    if misfit > SHARED_POLES:
        several = " or the records do not share their poles" if len(prepared) > 1 else ""
        warnings.append(
            f"the fit leaves {misfit:.1f} times the noise: the line is not linear{several}; uncertainties are widened"
        )
    lengths = [one.stretch.duration for one in prepared]
    if max(lengths) > (1 + SAME_LENGTH) * min(lengths):
        each = ", ".join(f"{length:.0f} s" for length in lengths)
        warnings.append(f"the decays differ in length ({each}): each is used over its own")
    return replace(whole, modes=_grouped(modes, prepared[0].record), warnings=tuple(dict.fromkeys(warnings)))


def _misfit(cost: float, m: int, blocks: list[DataBlock]) -> float:
    rows = sum(2 * data.lines.size * data.spectrum.shape[1] for data in blocks)
    linear = sum((2 * m + data.residual_terms.shape[1]) * data.spectrum.shape[1] for data in blocks)
    return float(cost / max(rows - linear - 2 * m, 1))


def _inflation(white: list[DataBlock], fits: tuple[ProjectionFit, ...], noise: list[RealArray], pole: complex) -> float:
    """Factor for standard deviations where the residual around a mode is more than noise."""
    energy, count = 0.0, 0
    for data, fit, sigma in zip(white, fits, noise, strict=True):
        reach = max(FREQUENCY_REACH * 2 * np.pi / data.duration, -2 * pole.real)
        near = np.abs(data.omega - pole.imag) < reach
        energy += float(np.sum(np.abs(fit.residual[near] / sigma) ** 2))
        count += 2 * int(near.sum()) * sigma.size
    return float(np.sqrt(max(1.0, energy / count))) if count else 1.0


def _mode(
    whole: Identification,
    j: int,
    decay_std: float,
    omega_std: float,
    spreads: list[RealArray],
    nearest: float,
    lateral: list[RealArray | None],
) -> Mode:
    pole = whole.poles[j]
    best = max(range(len(whole.prepared)), key=lambda r: _signal_to_noise(whole, r, j))
    one = whole.prepared[best]
    same = [r for r, other in enumerate(whole.prepared) if other.test == one.test]
    residues, spread = _shared_shape(whole, same, same.index(best), j, spreads)
    scale = residues[np.argmax(np.abs(residues))]
    frequency, damping = float(np.abs(pole)) / (2 * np.pi), float(-pole.real / np.abs(pole))
    damping_std = float(decay_std / np.abs(pole))
    shares = [share[j] for share in lateral if share is not None]
    share = float(max(shares)) if shares else None
    since = one.stretch.first - one.release.time
    gain = filter_gain(one.stretch.taps, np.array([pole]), one.stretch.rate)[0]
    shape, shape_std = (residues / scale, spread / np.abs(scale)) if np.abs(scale) > 0 else (residues, spread)
    return Mode(
        frequency_Hz=frequency,
        frequency_std_Hz=_finite(omega_std / (2 * np.pi)),
        damping_ratio=damping,
        damping_ratio_std=_finite(damping_std),
        sensor_shape=tuple(
            SensorShape(
                sensor=channel.sensor,
                wire=channel.wire,
                position_m=channel.position,
                re=float(value.real),
                im=float(value.imag),
                std=_finite(std),
            )
            for channel, value, std in zip((one.record.channels[c] for c in one.columns), shape, shape_std, strict=True)
        ),
        error=_error(whole, pole),
        record=one.record.name,
        warnings=list_mode_warnings(frequency, damping, damping_std, one.stretch.duration, nearest, share),
        certain=is_certain(damping, damping_std),
        lateral=is_lateral(share),
        amplitude_at_release=_finite(2 * np.abs(scale / gain * np.exp(-pole * since))),
        phase_collinearity=phase_collinearity(residues),
        lateral_over_vertical=share,
        half_power_points=2 * damping * frequency * one.stretch.duration,
    )


def _finite(value: float) -> float:
    """A value, or 0 (which no measured value is) where the data do not determine it."""
    return float(value) if np.isfinite(value) else 0.0


def _signal_to_noise(whole: Identification, r: int, j: int) -> float:
    b, at = whole.block_of[r], whole.columns[r]
    return float(np.sum(np.abs(whole.fits[b].residues[j, at] / whole.noise[b][at]) ** 2))


def _shared_shape(
    whole: Identification, repeats: list[int], which: int, j: int, spreads: list[RealArray]
) -> tuple[ComplexArray, RealArray]:
    """Residues over the sensors that repeats of a drop agree on best, and the standard deviation of their parts.

    They are scaled to the repeat `which`: residues belong to the first sample, and stretches begin at their own times.
    """
    table = np.array([whole.fits[whole.block_of[r]].residues[j, whole.columns[r]] for r in repeats]).T
    left, values, right = np.linalg.svd(table, full_matrices=False)
    noise = [whole.noise[whole.block_of[r]][whole.columns[r]] * spreads[whole.block_of[r]][j] for r in repeats]
    residues = left[:, 0] * values[0] * right[0, which]
    return residues, np.asarray(np.mean(noise, axis=0) * np.abs(right[0, which]))


def _error(whole: Identification, pole: complex) -> float:
    left = measured = 0.0
    for data, fit, sigma in zip(whole.blocks, whole.fits, whole.noise, strict=True):
        near = np.abs(data.omega - pole.imag) <= max(-pole.real, 2 * np.pi / data.duration)
        left += float(np.sum(np.abs(fit.residual[near] / sigma) ** 2))
        measured += float(np.sum(np.abs(data.spectrum[near] / sigma) ** 2))
    return float(np.sqrt(left / measured)) if measured > 0 else 1.0


def _lateral_share(whole: Identification, r: int) -> RealArray | None:
    """Largest lateral over largest vertical amplitude of every pole, (m,); 0 where nothing lateral stands out."""
    one = whole.prepared[r]
    if one.lateral.shape[1] == 0:
        return None
    data = build_block(one.lateral, one.stretch.dt, whole.band.low, whole.band.fitted)
    fit = solve_residues(whole.poles, data)
    noise = estimate_noise(fit, whole.poles.size, data) * residue_spread(whole.poles, data)[:, None]
    sideways = np.where(np.abs(fit.residues) > 4 * noise, np.abs(fit.residues), 0).max(axis=1)
    upward = np.abs(whole.fits[whole.block_of[r]].residues[:, whole.columns[r]]).max(axis=1)
    return np.asarray(sideways / np.maximum(upward, np.finfo(float).tiny))


def _grouped(modes: list[Mode], record: DropRecord) -> tuple[Mode, ...]:
    upward = [mode for mode in modes if not mode.lateral]
    certain = np.array([mode.frequency_Hz for mode in upward if mode.certain])
    spans = len(record.line.spans) or None
    numbers = number_groups(certain, np.array([mode.frequency_Hz for mode in upward]), spans)
    group = {id(mode): int(number) or None for mode, number in zip(upward, numbers, strict=True)}
    grouped = [mode.model_copy(update={"group": group.get(id(mode))}) for mode in modes]
    far = set[int]()
    for number in {mode.group for mode in grouped} - {None}:
        members = [i for i, mode in enumerate(grouped) if mode.group == number and mode.certain]
        flags = find_group_outliers(np.array([grouped[i].damping_ratio for i in members]))
        far |= {i for i, flag in zip(members, flags, strict=True) if flag}
    return tuple(mode.model_copy(update={"outlier": i in far}) for i, mode in enumerate(grouped))
