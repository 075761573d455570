"""Analysis of an identified line: groups of modes, repeatability, spectra and frequency responses."""

import numpy as np

from pantocheck.conformance.identification.decay_preparation import PreparedDecay
from pantocheck.conformance.identification.frequency_response import compute_frequency_response
from pantocheck.conformance.identification.half_power import count_half_power_lines
from pantocheck.conformance.identification.identification_format import (
    IdentifiedLine,
    IdentifiedRecord,
    ModeGroup,
    RecordResponses,
    RecordSensor,
    RecordSpectra,
    ResponseCurve,
)
from pantocheck.conformance.identification.identify import Identification
from pantocheck.conformance.identification.line_fit import LineFit, RecordFit
from pantocheck.conformance.identification.mode import Mode
from pantocheck.conformance.identification.order_search import describe_search
from pantocheck.conformance.identification.overlapping_bands import warn_about_overlap
from pantocheck.conformance.identification.repeatability import compare_records, overlay_records, round_curve
from pantocheck.conformance.identification.spectrogram import compute_spectrogram
from pantocheck.model.one_thread import use_one_thread


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
        spans_m=decays[0].record.line.spans,
        records=tuple(_record(decay) for decay in decays),
        groups=_groups(modes),
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
            RecordSensor(channel=channel.name, wire=channel.wire, position_m=channel.position)
            for channel in decay.channels
        ),
    )


def _groups(modes: tuple[Mode, ...]) -> tuple[ModeGroup, ...]:
    groups = []
    for number in sorted({mode.group for mode in modes if mode.group is not None}):
        members = [mode for mode in modes if mode.group == number]
        ratios = [mode.damping_ratio for mode in members if mode.certain]
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
