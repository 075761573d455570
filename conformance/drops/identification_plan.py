"""Plan of an identification: method, bands with their orders, excluded channels and stretches, and chosen poles."""

from dataclasses import replace
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from pantocheck.conformance.core.array_types import ComplexArray
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.sourced_table import (
    InputTable,
    NonNegative,
    Positive,
    Problems,
    cross_check,
    validation_problem,
)
from pantocheck.conformance.core.toml_file import read_model
from pantocheck.conformance.drops.decay_preparation import LinearDecay, PreparedDecay
from pantocheck.conformance.drops.drop_record import DropRecord
from pantocheck.conformance.drops.model_order import (
    PoleSelection,
    estimate_block_noise,
    find_best_candidate,
    pole_contributions,
    restrict_fit,
)
from pantocheck.conformance.drops.pole_refinement import refine_poles
from pantocheck.conformance.drops.projection import DataBlock, solve_residues, whiten
from pantocheck.conformance.results.identified_modes import Mode, read_modes

Method = Literal["finite-record", "classical"]
"""`finite-record`: all poles together, with the exact transform of a truncated decay; `classical`: one pole and residue
for each peak of the spectrum.
"""

SHORTEST_REST_S = 20.0
"""Shortest decay that remains beside an excluded stretch [s]."""
NEAR_LINES = 2.0
"""Largest distance of a pole from the one that a plan names, in spectral lines [-]."""


class StartPole(InputTable):
    """Pole that is placed by hand."""

    frequency_Hz: Annotated[Positive, Field(le=1000)]
    """Undamped frequency [Hz]."""
    damping_ratio: Annotated[Positive, Field(lt=1)] = 0.002
    """Damping ratio [-]."""

    @property
    def pole(self) -> complex:
        """Pole [1/s]."""
        return compute_pole(self.frequency_Hz, self.damping_ratio)


class StartPoles(InputTable):
    """File of start poles."""

    pole: Annotated[tuple[StartPole, ...], Field(strict=False, min_length=1, max_length=1000)]
    """Start poles."""


def compute_pole(frequency: float, damping_ratio: float) -> complex:
    """Pole [1/s] of an undamped frequency [Hz] and a damping ratio [-]."""
    return 2 * np.pi * frequency * complex(-damping_ratio, np.sqrt(1 - damping_ratio**2))


def read_poles(path: Path) -> ComplexArray:
    """Read start poles, (m,) [1/s], from a TOML file with tables `[[pole]]`, or from a modes.json.

    Raises:
        InputError: The file cannot be read, its content is invalid, or it holds no pole.
    """
    if path.suffix != ".json":
        return np.array([row.pole for row in read_model(path, StartPoles, "poles").pole])
    modes = read_modes(path)
    if not modes:
        raise InputError(f"modes '{path.name}'", "holds no mode", "Give a file with at least one mode.")
    return np.array([compute_pole(mode.frequency_Hz, mode.damping_ratio) for mode in modes])


class PlannedPole(StartPole):
    """Pole that is placed or chosen by hand."""

    action: Literal["start", "keep", "drop"] = "start"
    """start: the search begins with these poles; keep: added if the search does not find it; drop: removed."""


class PlannedBand(InputTable):
    """Band with reported modes."""

    from_Hz: Annotated[NonNegative, Field(le=1000)]
    to_Hz: Annotated[Positive, Field(le=1000)]
    order: Annotated[int | None, Field(ge=0, le=200)] = None
    """Number of poles in the band; default: as many as the data show."""

    @cross_check
    def _ordered(self) -> Problems:
        if self.from_Hz >= self.to_Hz:
            yield validation_problem("from_Hz", f"{self.from_Hz:g} Hz is not below to_Hz", "Exchange the two edges.")


class ExcludedStretch(InputTable):
    """Stretch of time that is not used, for example a passing train."""

    record: Annotated[str, Field(max_length=200)] = ""
    """Name of the record; default: every record."""
    from_s: NonNegative
    to_s: Positive
    """Start and end, in the time of the record [s]."""


class IdentificationPlan(InputTable):
    """Choices of the user for an identification; an empty plan changes nothing."""

    method: Method = "finite-record"
    highest_Hz: Annotated[float | None, Field(ge=0.5, le=200)] = None
    """Highest frequency of a mode [Hz]; default: that of the command."""
    exclude_channels: Annotated[tuple[str, ...], Field(strict=False, max_length=200)] = ()
    """Names of channels that are not used."""
    exclude: Annotated[tuple[ExcludedStretch, ...], Field(strict=False, max_length=200)] = ()
    band: Annotated[tuple[PlannedBand, ...], Field(strict=False, max_length=100)] = ()
    pole: Annotated[tuple[PlannedPole, ...], Field(strict=False, max_length=1000)] = ()

    def list_poles(self, action: Literal["start", "keep", "drop"]) -> ComplexArray:
        """Poles with an action, (m,) [1/s]."""
        return np.array([pole.pole for pole in self.pole if pole.action == action], dtype=np.complex128)

    @property
    def changes_poles(self) -> bool:
        """Whether the plan changes the poles that a search finds."""
        return any(pole.action != "start" for pole in self.pole) or any(band.order is not None for band in self.band)


def read_identification_plan(path: Path) -> IdentificationPlan:
    """Read the plan of an identification from a TOML file.

    Raises:
        InputError: The file cannot be read, or its content is invalid.
    """
    return read_model(path, IdentificationPlan, "plan")


def exclude_channels(records: tuple[DropRecord, ...], plan: IdentificationPlan) -> tuple[DropRecord, ...]:
    """Records without the excluded channels.

    Raises:
        InputError: No record has an excluded channel.
    """
    names = {channel.name for record in records for channel in record.channels}
    for name in plan.exclude_channels:
        if name not in names:
            raise InputError(f"plan, key exclude_channels: {name!r}", "no record has this channel", f"Known: {names}.")
    return tuple(_keep_channels(record, plan.exclude_channels) for record in records)


def _keep_channels(record: DropRecord, excluded: tuple[str, ...]) -> DropRecord:
    kept = [i for i, channel in enumerate(record.channels) if channel.name not in excluded]
    if len(kept) == len(record.channels):
        return record
    return replace(record, signals=record.signals[:, kept], channels=tuple(record.channels[i] for i in kept))


def exclude_stretches(decay: PreparedDecay, plan: IdentificationPlan) -> PreparedDecay:
    """Decay cut to the longest part beside the excluded stretches.

    Raises:
        InputError: Less than `SHORTEST_REST_S` remains.
    """
    linear, name = decay.linear, decay.record.name
    half = (linear.taps.size - 1) / 2 / linear.rate
    time = linear.first + linear.dt * np.arange(linear.samples.shape[0])
    free = np.ones(time.size, dtype=np.bool_)
    for stretch in plan.exclude:
        if stretch.record in ("", name):
            free &= (time < stretch.from_s - half) | (time > stretch.to_s + half)
    if free.all():
        return decay
    edges = np.flatnonzero(np.diff(np.concatenate([[False], free, [False]]).astype(int)))
    begin, end = max(zip(edges[::2], edges[1::2], strict=True), key=lambda part: part[1] - part[0], default=(0, 0))
    if (end - begin) * linear.dt < SHORTEST_REST_S:
        raise InputError(name, f"the plan leaves {(end - begin) * linear.dt:.1f} s", "Exclude shorter stretches.")
    part = f"{name}: the longest part beside the excluded stretches is used, {time[begin]:.0f} to {time[end - 1]:.0f} s"
    cut = _cut_decay(linear, int(begin), int(end), half)
    return replace(decay, linear=cut, lateral=decay.lateral[begin:end], warnings=(*decay.warnings, part))


def _cut_decay(linear: LinearDecay, begin: int, end: int, half: float) -> LinearDecay:
    first = linear.first + begin * linear.dt
    last = linear.first + (end - 1) * linear.dt
    return replace(linear, samples=linear.samples[begin:end], first=first, start=first - half, end=last + half)


def choose_poles(
    selection: PoleSelection, data: list[DataBlock], plan: IdentificationPlan
) -> tuple[PoleSelection, ComplexArray]:
    """Drop, keep and count poles as the plan says, and refine all; their number no longer changes.

    Returns:
        The poles, and the dropped ones among them, which the data need: their modes are not reported.

    Raises:
        InputError: There is no pole near one that is to be dropped, or a band has too few lines for its order.
    """
    poles, reach, hidden = selection.poles, near_distance(data), list[complex]()
    for pole in plan.list_poles("drop"):
        if not poles.size or np.abs(poles.imag - pole.imag).min() > reach:
            raise InputError(
                f"plan, pole at {pole.imag / 2 / np.pi:.4g} Hz", "no pole is there to drop", "Leave the table out."
            )
        nearest = int(np.argmin(np.abs(poles - pole)))
        rest = np.delete(poles, nearest)
        refined = refine_all(rest, data).poles
        # Without the pole of a strong peak, another pole would move to it: such a pole stays, and is not reported.
        if np.all(np.abs(refined.imag - np.sort(rest.imag)) < reach):
            poles = rest
        else:
            hidden.append(poles[nearest])
    for pole in plan.list_poles("keep"):
        if not poles.size or np.abs(poles.imag - pole.imag).min() > reach:
            poles = np.append(poles, pole)
    white = whiten(data, selection.noise)
    for band in plan.band:
        poles = _fit_order(poles, white, band)
    return refine_all(poles, data), np.array(hidden, dtype=np.complex128)


def near_distance(data: list[DataBlock]) -> float:
    """Largest distance of a pole from the one that a plan names [rad/s]."""
    return NEAR_LINES * 2 * np.pi / max(block.duration for block in data)


def refine_all(poles: ComplexArray, data: list[DataBlock]) -> PoleSelection:
    """Refine poles [1/s] whose number is kept, with the noise that they leave."""
    for _ in range(3):
        poles = refine_poles(poles, whiten(data, estimate_block_noise(poles, data))).poles
    return PoleSelection(poles, estimate_block_noise(poles, data))


def _fit_order(poles: ComplexArray, white: list[DataBlock], band: PlannedBand) -> ComplexArray:
    """Remove the weakest poles of a band, or add the strongest, until their number is the order of the band."""
    low, high = 2 * np.pi * band.from_Hz, 2 * np.pi * band.to_Hz
    while band.order is not None:
        inside = np.flatnonzero((poles.imag >= low) & (poles.imag < high))
        if inside.size == band.order:
            break
        if inside.size > band.order:
            weakest = inside[np.argmin(pole_contributions(poles, white)[inside])]
            poles = refine_poles(np.delete(poles, weakest), white, iterations=10).poles
            continue
        added = _find_strongest(poles, white, (low, high))
        poles = np.append(poles, added)
    return np.asarray(poles[np.argsort(poles.imag)])


def _find_strongest(poles: ComplexArray, white: list[DataBlock], edges: tuple[float, float]) -> complex:
    """Pole in a band [rad/s] that reduces the residual most.

    Raises:
        InputError: The band has too few spectral lines for a further pole.
    """
    fits = [solve_residues(poles, block) for block in white]
    longest = max(white, key=lambda block: block.duration)
    energy = np.sum(np.abs(fits[white.index(longest)].residual) ** 2, axis=1)
    inside = np.flatnonzero((longest.omega >= edges[0]) & (longest.omega < edges[1]))
    for k in inside[np.argsort(-energy[inside])]:
        centre = float(longest.omega[k])
        local = restrict_fit(poles, white, fits, centre)
        trial = find_best_candidate(local, centre) if local.blocks else None
        if trial is not None and edges[0] <= trial[0].imag < edges[1]:
            return trial[0]
    where = f"plan, band from {edges[0] / 2 / np.pi:g} Hz"
    raise InputError(where, "too few spectral lines for its order", "Lower the order, or widen the band.")


def select_reported(modes: tuple[Mode, ...], plan: IdentificationPlan, hidden: ComplexArray) -> tuple[Mode, ...]:
    """Modes inside a band of the plan, by default all, without the nearest one to each hidden pole [1/s]."""
    omega = np.array([2 * np.pi * mode.frequency_Hz for mode in modes])
    excluded = {int(np.argmin(np.abs(omega - abs(pole)))) for pole in hidden if omega.size}
    return tuple(
        mode
        for number, mode in enumerate(modes)
        if number not in excluded
        and (not plan.band or any(band.from_Hz <= mode.frequency_Hz < band.to_Hz for band in plan.band))
    )
