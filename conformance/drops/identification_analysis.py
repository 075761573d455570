"""Analysis of an identified line: groups of modes, repeatability, spectra and frequency responses."""

from dataclasses import dataclass
from itertools import pairwise, zip_longest
from math import ceil

import numpy as np
from numpy.typing import NDArray

from pantocheck.conformance.core.array_types import ComplexArray, RealArray
from pantocheck.conformance.core.units import STANDARD_GRAVITY
from pantocheck.conformance.drops.decay_kernel import filter_gain
from pantocheck.conformance.drops.decay_preparation import PreparedDecay
from pantocheck.conformance.drops.drop_record import MOTION_ORDER
from pantocheck.conformance.drops.identify import Identification, PoleSearch
from pantocheck.conformance.drops.line_fit import LineFit, RecordFit, measure_ambient_motion
from pantocheck.conformance.drops.mode_groups import warn_about_overlap
from pantocheck.conformance.drops.repeatability import compare_records, overlay_records, round_curve
from pantocheck.conformance.drops.sensor_clocks import SensorClock
from pantocheck.conformance.drops.start_poles import BandTrials
from pantocheck.conformance.results.identification_format import (
    BandOrders,
    HalfPowerLines,
    IdentifiedClock,
    IdentifiedLine,
    IdentifiedRecord,
    ModeGroup,
    OrderSearch,
    RecordResponses,
    RecordSensor,
    RecordSpectra,
    ResponseCurve,
    SearchStep,
    Spectrogram,
    SpectrogramPart,
)
from pantocheck.conformance.results.identified_modes import Mode
from pantocheck.model.description.one_thread import use_one_thread


@use_one_thread
def analyse_identification(identification: Identification) -> IdentifiedLine:
    """Analyse the identification of one line, for identification.json."""
    fit, modes = identification.fit, identification.modes
    decays = [record.decay for record in fit.records]
    drops = [tuple(d for d in decays if d.test == test) for test in dict.fromkeys(decay.test for decay in decays)]
    repeated = [repeats for repeats in drops if len(repeats) > 1]
    responses = (_responses(fit, record) for record in fit.records)
    return IdentifiedLine(
        quantity=decays[0].record.quantity,
        band_Hz=(fit.band.low, fit.band.high),
        misfit=fit.misfit,
        warnings=(*identification.warnings, *warn_about_overlap(modes)),
        spans_m=decays[0].record.line.spans_m,
        records=tuple(_record(decay) for decay in decays),
        clocks=tuple(_describe_clock(clock) for clock in identification.clocks),
        shared_clock=decays[0].record.shared_clock,
        groups=_groups(fit, modes),
        modes=modes,
        half_power=count_half_power_lines(modes),
        repeatability=tuple(compare_records(repeats) for repeats in repeated),
        overlays=tuple(overlay_records(records) for records in repeated or drops[:1]),
        spectrogram=compute_spectrogram(decays[0]),
        order_search=describe_search(identification.search),
        spectra=tuple(_spectra(fit, record, modes) for record in fit.records),
        frequency_responses=tuple(response for response in responses if response is not None),
    )


def _record(decay: PreparedDecay) -> IdentifiedRecord:
    record, drop = decay.record, decay.record.drop
    return IdentifiedRecord(
        name=record.name,
        source=record.source,
        sampling_rate_Hz=record.rate,
        length_s=record.duration,
        mass_kg=drop.mass,
        drop_wire=drop.wire,
        drop_position_m=drop.position,
        release_s=decay.release.time,
        used_from_s=decay.linear.start,
        used_to_s=decay.linear.end,
        channels=decay.channel_names,
        sensors=tuple(
            RecordSensor(channel=channel.name, wire=channel.wire, position_m=channel.position, onset_s=onset)
            for channel, onset in zip_longest(decay.channels, decay.release.onsets)
        ),
        residual_time_s=round_curve(decay.linear.evidence.time),
        residual_over_rest=round_curve(decay.linear.evidence.ratio),
    )


def _describe_clock(clock: SensorClock) -> IdentifiedClock:
    return IdentifiedClock(
        sensor=clock.sensor,
        rate_ppm=1e6 * clock.rate,
        rate_std_ppm=1e6 * clock.rate_std,
        start_ms=1e3 * clock.start,
        corrected=clock.deviates or clock.is_late,
    )


GROUP_MARGIN = 0.05
"""Frequencies on both sides of a group whose ambient motion counts as that of the group [Hz]."""


def _groups(fit: LineFit, modes: tuple[Mode, ...]) -> tuple[ModeGroup, ...]:
    groups = []
    for number in sorted({mode.group for mode in modes if mode.group is not None}):
        members = [mode for mode in modes if mode.group == number]
        ratios = [mode.damping_ratio for mode in members if mode.certain]
        edges = members[0].frequency_Hz - GROUP_MARGIN, members[-1].frequency_Hz + GROUP_MARGIN
        ambient, noise = measure_ambient_motion(fit, *edges) or (None, None)
        groups.append(
            ModeGroup(
                group=number,
                modes=len(members),
                certain=len(ratios),
                from_Hz=members[0].frequency_Hz,
                to_Hz=members[-1].frequency_Hz,
                median_damping_ratio=float(np.median(ratios)) if ratios else None,
                lowest=min(ratios, default=None),
                highest=max(ratios, default=None),
                ambient_rms=ambient,
                noise_rms=noise,
            )
        )
    return tuple(groups)


def _spectra(fit: LineFit, record: RecordFit, modes: tuple[Mode, ...]) -> RecordSpectra:
    data, columns = record.block.data, record.columns
    shown = data.omega <= 2 * np.pi * fit.band.high
    measured, residual = (values[shown][:, columns] * data.dt for values in (data.spectrum, record.block.fit.residual))
    magnitudes = [
        tuple(round_curve(np.abs(column)) for column in spectra.T)
        for spectra in (measured, measured - residual, residual)
    ]
    return RecordSpectra(
        record=record.decay.record.name,
        channels=record.decay.channel_names,
        frequency_Hz=round_curve(data.omega[shown] / (2 * np.pi)),
        measured=magnitudes[0],
        fitted=magnitudes[1],
        residual=magnitudes[2],
        poles_Hz=tuple(mode.frequency_Hz for mode in modes),
    )


def _responses(fit: LineFit, record: RecordFit) -> RecordResponses | None:
    response = compute_frequency_response(fit, record)
    if response is None:
        return None
    measured, identified = (
        tuple(ResponseCurve(magnitude=round_curve(np.abs(h)), phase_rad=round_curve(np.angle(h))) for h in columns.T)
        for columns in (response.measured, response.identified)
    )
    return RecordResponses(
        record=record.decay.record.name,
        channels=record.decay.channel_names,
        frequency_Hz=round_curve(response.frequency),
        measured=measured,
        identified=identified,
    )


# Description of the search for the model order: which poles are stable from one order to the next.
STABLE_FREQUENCY, STABLE_DAMPING = 0.001, 0.1
"""Largest relative changes of frequency and damping ratio of a stable pole from one order to the next [-]."""


def describe_search(search: PoleSearch) -> OrderSearch:
    """Frequencies and stability of the poles of all orders, and the poles after each step."""
    return OrderSearch(
        bands=tuple(_describe_band(band) for band in search.trials),
        steps=tuple(SearchStep(name=name, frequency_Hz=round_curve(_frequency(poles))) for name, poles in search.steps),
    )


def _describe_band(band: BandTrials) -> BandOrders:
    before = (np.zeros(0, dtype=np.complex128), *band.poles)
    stable = [_are_stable(poles, previous) for previous, poles in pairwise(before)]
    return BandOrders(
        from_Hz=band.low,
        to_Hz=band.high,
        selected_order=band.selected,
        order=tuple(order for order, poles in enumerate(band.poles, 1) for _ in poles),
        frequency_Hz=round_curve(_frequency(np.concatenate(before))),
        stable=tuple(bool(value) for values in stable for value in values),
    )


def _are_stable(poles: ComplexArray, previous: ComplexArray) -> NDArray[np.bool_]:
    """Whether each pole has a counterpart among those of the order before."""
    near = np.abs(np.abs(poles)[:, None] / np.abs(previous) - 1) < STABLE_FREQUENCY
    damping, other = (-p.real / np.abs(p) for p in (poles, previous))
    return np.asarray((near & (np.abs(damping[:, None] - other) < STABLE_DAMPING * other)).any(axis=1))


def _frequency(poles: ComplexArray) -> NDArray[np.float64]:
    return np.asarray(np.abs(poles) / (2 * np.pi), dtype=np.float64)


# Spectrogram of a record: amplitude over time and frequency, over the whole record and around the release.
HIGHEST_SHOWN = 20.0
"""Highest frequency [Hz]: slack droppers excite the line above the band of the reported modes."""

LOWEST_LEVEL = -60
"""Lowest level [dB]; the level of the largest amplitude is 0 dB."""

WHOLE_WINDOW, WHOLE_COLUMNS = 4.0, 120
"""Window over the whole record [s], which separates the groups of span modes, and about the number of its columns."""

START_WINDOW, START_STEP, START_SPAN = 1.0, 0.1, (-2.0, 8.0)
"""Window and step around the release, and its range after the release [s]: slack droppers become taut in seconds."""


def compute_spectrogram(decay: PreparedDecay) -> Spectrogram:
    """Spectrogram of the channel with the largest motion."""
    record, release = decay.record, decay.release.time
    signals = record.signals[:, list(decay.columns)]
    column = int(np.argmax(signals.std(axis=0)))
    signal = np.asarray(signals[:, column] - np.median(signals[:, column]))
    begin, end = (round((release + t) * record.rate) for t in START_SPAN)
    whole_step = ceil(record.duration / WHOLE_COLUMNS)
    return Spectrogram(
        record=record.name,
        channel=decay.channel_names[column],
        whole=_transform(signal, record.rate, WHOLE_WINDOW, whole_step, -release),
        start=_transform(
            signal[max(begin, 0) : end], record.rate, START_WINDOW, START_STEP, max(begin, 0) / record.rate - release
        ),
    )


def _transform(signal: RealArray, rate: float, window: float, step: float, first: float) -> SpectrogramPart:
    """Levels in windows (Hann) of a length at steps [s]; `first` is the time of the first sample [s]."""
    length = max(round(window * rate), 4)
    frames = np.lib.stride_tricks.sliding_window_view(signal, length)[:: max(round(step * rate), 1)]
    frequency = np.asarray(np.fft.rfftfreq(length, 1 / rate), dtype=np.float64)
    shown = frequency <= min(HIGHEST_SHOWN, 0.45 * rate)
    amplitude = np.abs(np.fft.rfft(frames * np.hanning(length), axis=1))[:, shown]
    largest = max(float(amplitude.max(initial=0.0)), np.finfo(float).tiny)
    levels = 20 * np.log10(np.maximum(amplitude / largest, 10 ** (LOWEST_LEVEL / 20)))
    samples = np.arange(frames.shape[0], dtype=np.float64) * max(round(step * rate), 1)
    return SpectrogramPart(
        window_s=window,
        time_s=round_curve(first + (samples + length / 2) / rate),
        frequency_Hz=round_curve(frequency[shown]),
        level_dB=tuple(tuple(int(level) for level in row) for row in np.rint(levels)),
    )


# Spectral lines in the half-power band of the modes, a rule for methods that read this band from a spectrum.
#
# A mode with damping ratio z and frequency f has 2 z f T lines in a linear decay of the duration T.
RECOMMENDED_LINES = 5
"""Recommended number of spectral lines in the half-power band (Vo Van, Balmes, Lorang 2015)."""


def count_half_power_lines(modes: tuple[Mode, ...]) -> HalfPowerLines:
    """Count the modes with fewer lines than recommended; the needed duration is that of the certain vertical modes."""
    lines = [mode.half_power_points for mode in modes if mode.half_power_points is not None]
    bandwidths = [2 * mode.damping_ratio * mode.frequency_Hz for mode in modes if mode.certain and not mode.lateral]
    return HalfPowerLines(
        recommended=RECOMMENDED_LINES,
        modes=len(lines),
        fewer=sum(number < RECOMMENDED_LINES for number in lines),
        needed_s=RECOMMENDED_LINES / min(bandwidths) if bandwidths else None,
    )


# Frequency responses to a mass drop. The release is an upward step force m g at the position of the mass.
#
# A step of height F at t = 0 has the transform F / (i w), so the accelerance of a sensor is
#
#     H(w) = i w A(w) / (m g)      [m/s2/N],        A(w) the transform of its acceleration from the release on.
@dataclass(frozen=True)
class FrequencyResponse:
    """Accelerance of the sensors of one record [m/s2/N], each (k, c), at k frequencies [Hz].

    The measured response is that from the release to the end of the linear decay. The identified response is that of
    the poles, extrapolated back to the release.
    """

    frequency: RealArray
    measured: ComplexArray
    identified: ComplexArray


def compute_frequency_response(fit: LineFit, record_fit: RecordFit) -> FrequencyResponse | None:
    """Compute the frequency responses of one record of a fit; None if its mass is not known."""
    decay, linear = record_fit.decay, record_fit.decay.linear
    record, columns = decay.record, list(decay.columns)
    if record.drop.mass is None:
        return None
    begin, end = (int(t * record.rate) for t in (decay.release.time, linear.end))
    signals = record.signals[begin:end, columns]
    rest = record.signals[: max(int(decay.release.rest_end * record.rate), 1), columns]
    n = signals.shape[0]
    frequency = np.asarray(np.fft.rfftfreq(n, 1 / record.rate), dtype=np.float64)
    used = (frequency >= fit.band.low) & (frequency <= fit.band.high)
    omega: RealArray = 2 * np.pi * frequency[used]
    to_accelerance = (1j * omega) ** (3 - MOTION_ORDER[record.quantity]) / (record.drop.mass * STANDARD_GRAVITY)
    offset = rest.mean(axis=0) if rest.shape[0] > 10 else signals.mean(axis=0)
    measured = np.fft.rfft(signals - offset, axis=0)[used] / record.rate
    inside = np.abs(fit.poles) < 2 * np.pi * fit.band.fitted
    poles, duration = fit.poles[inside], n / record.rate
    to_release = np.exp(-poles * (linear.first - decay.release.time)) / filter_gain(linear.taps, poles, linear.rate)
    residues = record_fit.residues[inside] * to_release[:, None]

    def transform(decays: ComplexArray) -> ComplexArray:
        """Transform of exp(lambda t) over the duration, (k, m) [s]."""
        difference = decays[None, :] - 1j * omega[:, None]
        return np.asarray(np.expm1(difference * duration) / difference)

    identified = transform(poles) @ residues
    identified += transform(poles.conj()) @ residues.conj()
    return FrequencyResponse(frequency[used], measured * to_accelerance[:, None], identified * to_accelerance[:, None])
