"""Fits of records without noise, built from the exact poles: every result has a closed form."""

from dataclasses import replace

import numpy as np

from pantocheck.conformance.core.array_types import ComplexArray, RealArray
from pantocheck.conformance.drops.decay_kernel import FrequencyBand, filter_full_overlap, low_pass_taps
from pantocheck.conformance.drops.decay_preparation import LinearDecay, PreparedDecay
from pantocheck.conformance.drops.drop_record import DropChannel, DropDescription, DropRecord
from pantocheck.conformance.drops.line_fit import LineFit, fit_line, group_into_blocks
from pantocheck.conformance.drops.projection import build_block
from pantocheck.conformance.drops.release import Release
from pantocheck.conformance.results.identified_modes import MeasuredLine

RATE, RELEASE = 50.0, 2.0
BAND = FrequencyBand.up_to(4.0, RATE)


def build_exact_decay(
    poles: ComplexArray,
    residues: ComplexArray,
    name: str = "exact",
    after: float = 1.0,
    duration: float = 40.0,
    lateral: ComplexArray | None = None,
) -> PreparedDecay:
    """Prepared record whose sensors move by 2 Re(sum residues exp(poles t)), t from the release [s].

    Args:
        poles: Poles, (m,) [1/s].
        residues: Residues of the vertical channels at the release, (m, c).
        name: Name of the record.
        after: Start of the linear decay after the release [s].
        duration: Duration of the record after the release [s].
        lateral: Residues of a lateral channel at the release, (m,).
    """
    t = np.arange(round((RELEASE + duration) * RATE)) / RATE - RELEASE
    table = residues if lateral is None else np.column_stack([residues, lateral])
    moving = (np.exp(np.outer(np.maximum(t, 0.0), poles)) @ table).real
    signals = np.where(t[:, None] > -1e-9, 2 * moving, 0.0)
    count = residues.shape[1]
    channels = [DropChannel(f"S{i}_z", i, "z", "CW", 20.0 * i) for i in range(1, count + 1)]
    if lateral is not None:
        channels.append(DropChannel("S1_y", 1, "y", "CW", 20.0))
    drop = DropDescription(20.0, "CW", 100.0, RELEASE)
    record = DropRecord(name, name, RATE, signals, tuple(channels), drop=drop, line=MeasuredLine(spans_m=(60.0,) * 6))
    taps = low_pass_taps(RATE, BAND.fitted, BAND.stop, 80.0)
    begin, half = round((RELEASE + after) * RATE), (taps.size - 1) / 2 / RATE
    filtered = filter_full_overlap(signals[begin:], taps)
    linear = LinearDecay(
        samples=filtered[:, :count],
        dt=1 / RATE,
        taps=taps,
        rate=RATE,
        start=begin / RATE,
        end=signals.shape[0] / RATE,
        first=begin / RATE + half,
        poles=poles,
    )
    return PreparedDecay(record, tuple(range(count)), Release(RELEASE, RELEASE - 0.6), linear, filtered[:, count:], ())


def build_exact_fit(decays: list[PreparedDecay], poles: ComplexArray, noise: RealArray) -> LineFit:
    """Fit of records with the exact poles, and a noise of each channel, (c,), as the cause of the uncertainty."""
    samples, places = group_into_blocks(decays)
    data = [build_block(channels, dt, BAND.low, BAND.fitted) for channels, dt in samples]
    levels = [np.resize(noise, block.spectrum.shape[1]) for block in data]
    return fit_line(decays, places, data, poles, levels, BAND)


def with_quantity(decay: PreparedDecay, quantity: str) -> PreparedDecay:
    """The same signals as another quantity."""
    return replace(decay, record=replace(decay.record, quantity=quantity))
