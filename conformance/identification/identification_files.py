"""The files of an identification: modes.json, which other tools read, and identification.json with every number."""

import json
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, TypeAdapter

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.identification.frequency_response import compute_frequency_response
from pantocheck.conformance.identification.identify import Identification
from pantocheck.conformance.identification.mode import Mode
from pantocheck.conformance.identification.repeatability import (
    LATER,
    WINDOW,
    Repeatability,
    align_records,
    compare_records,
)
from pantocheck.conformance.input_files.atomic_writing import write_atomically
from pantocheck.conformance.input_files.json_file import read_json, validate_json

MAX_MODES_BYTES = 50_000_000  # bytes
SIGNIFICANT = 8


class SensorShape(BaseModel):
    """One component of a mode's shape."""

    model_config = ConfigDict(extra="ignore", allow_inf_nan=False)

    sensor: int
    wire: str = ""
    position_m: float | None = None
    re: float
    im: float


class ModeRow(BaseModel):
    """One mode of modes.json."""

    model_config = ConfigDict(extra="ignore", allow_inf_nan=False)

    frequency_Hz: Annotated[float, Field(gt=0)]
    damping_ratio: Annotated[float, Field(gt=0, lt=1)]
    damping_ratio_std: Annotated[float, Field(ge=0)]
    group: int | None = None
    sensor_shape: tuple[SensorShape, ...]
    error: float | None = None
    record: str = ""
    warnings: tuple[str, ...] = ()
    certain: bool = True
    outlier: bool = False
    lateral: bool = False


def build_mode_row(mode: Mode) -> dict[str, Any]:
    """A mode as modes.json has it."""
    shape = [
        {
            "sensor": channel.sensor,
            "wire": channel.wire,
            "position_m": channel.position,
            "re": round_significant(value.real),
            "im": round_significant(value.imag),
            "std": round_significant(std),
        }
        for channel, value, std in zip(mode.channels, mode.shape, mode.shape_std, strict=True)
    ]
    return {
        "frequency_Hz": round_significant(mode.frequency),
        "frequency_std_Hz": round_significant(mode.frequency_std),
        "damping_ratio": round_significant(mode.damping_ratio),
        "damping_ratio_std": round_significant(mode.damping_ratio_std),
        "group": mode.group,
        "sensor_shape": shape,
        "error": round_significant(mode.error),
        "record": mode.record,
        "warnings": list(mode.warnings),
        "certain": mode.certain,
        "outlier": mode.outlier,
        "lateral": mode.lateral,
        "amplitude_at_release": round_significant(mode.amplitude),
        "phase_collinearity": None if mode.collinearity is None else round_significant(mode.collinearity),
        "lateral_over_vertical": None if mode.lateral_share is None else round_significant(mode.lateral_share),
        "half_power_points": round_significant(mode.half_power_points),
    }


def summarise_identification(found: Identification) -> dict[str, Any]:
    """Every number of one line's identification."""
    repeats = _repeats(found)
    return {
        "quantity": found.prepared[0].record.quantity,
        "band_Hz": [found.band.low, found.band.high],
        "misfit": round_significant(found.misfit),
        "warnings": list(found.warnings),
        "records": [_record(found, r) for r in range(len(found.prepared))],
        "groups": _groups(found),
        "modes": [build_mode_row(mode) for mode in found.modes],
        "repeatability": [_repeatability(one) for one in repeats],
        "overlays": _overlays(found),
        "spectra": [_spectra(found, r) for r in range(len(found.prepared))],
        "frequency_responses": [
            response for r in range(len(found.prepared)) if (response := _response(found, r)) is not None
        ],
    }


def write_modes(path: Path, all_found: tuple[Identification, ...]) -> None:
    """Write modes.json: the modes of all lines, one list.

    Raises
    ------
    InputError
        It cannot be written.
    """
    write_json(path, [build_mode_row(mode) for found in all_found for mode in found.modes])


def write_json(path: Path, value: Any) -> None:
    """Write plain data as JSON; the same data, the same bytes."""
    write_atomically(path, (json.dumps(value, indent=1, allow_nan=False) + "\n").encode("ascii"))


def read_modes(path: Path) -> tuple[ModeRow, ...]:
    """Modes of a modes.json.

    Raises
    ------
    InputError
        It cannot be read, is no JSON, or is no list of modes.
    """
    data = read_json(path, "modes", MAX_MODES_BYTES)
    hint = "Give the modes.json that `pantocheck identify` writes."
    return tuple(validate_json(data, TypeAdapter(list[ModeRow]), f"modes '{path.name}'", hint))


def round_significant(value: float) -> float:
    """A number to `SIGNIFICANT` digits; what is not finite becomes 0, which no measured number is."""
    return float(f"{value:.{SIGNIFICANT}g}") if np.isfinite(value) else 0.0


def _repeats(found: Identification) -> list[Repeatability]:
    tests = dict.fromkeys(one.test for one in found.prepared)
    compared = [compare_records(tuple(one for one in found.prepared if one.test == test)) for test in tests]
    return [one for one in compared if one is not None]


def _record(found: Identification, r: int) -> dict[str, Any]:
    one = found.prepared[r]
    drop, stretch = one.record.drop, one.stretch
    return {
        "name": one.record.name,
        "source": one.record.source,
        "sampling_rate_Hz": one.record.rate,
        "length_s": round_significant(one.record.duration),
        "mass_kg": drop.mass,
        "drop_wire": drop.wire,
        "drop_position_m": drop.position,
        "release_s": round_significant(one.release.time),
        "used_from_s": round_significant(stretch.start),
        "used_to_s": round_significant(stretch.end),
        "channels": [one.record.channels[c].name for c in one.columns],
    }


def _groups(found: Identification) -> list[dict[str, Any]]:
    rows = []
    for number in sorted({mode.group for mode in found.modes if mode.group is not None}):
        members = [mode for mode in found.modes if mode.group == number]
        certain = [mode.damping_ratio for mode in members if mode.certain]
        rows.append(
            {
                "group": number,
                "modes": len(members),
                "certain": len(certain),
                "from_Hz": round_significant(members[0].frequency),
                "to_Hz": round_significant(members[-1].frequency),
                "median_damping_ratio": round_significant(float(np.median(certain))) if certain else None,
                "lowest": round_significant(min(certain)) if certain else None,
                "highest": round_significant(max(certain)) if certain else None,
            }
        )
    return rows


def _repeatability(one: Repeatability) -> dict[str, Any]:
    return {
        "verdict": one.verdict,
        "reason": one.reason,
        "comparisons": [
            {
                "first": c.first,
                "second": c.second,
                "channel": c.channel,
                "shift_s": round_significant(c.shift),
                "correlation_at_start": round_significant(c.correlation[0]),
                "correlation_later": _maybe(c.correlation[1]),
                "possible_at_start": round_significant(c.possible[0]),
                "possible_later": _maybe(c.possible[1]),
                "residual_at_start": round_significant(c.residual[0]),
                "residual_later": _maybe(c.residual[1]),
            }
            for c in one.comparisons
        ],
    }


def _overlays(found: Identification) -> list[dict[str, Any]]:
    """Repeats of each test at the sensor that moves most, at the start and a minute later."""
    overlays = []
    for test in dict.fromkeys(one.test for one in found.prepared):
        repeats = [one for one in found.prepared if one.test == test]
        if len(repeats) < 2:
            continue
        lowest_rate = min(one.record.rate for one in repeats)
        curves = [align_records(one, lowest_rate) for one in repeats]
        channel = int(np.argmax(curves[0][1].std(axis=0)))
        runs = []
        for one, (time, samples) in zip(repeats, curves, strict=True):
            windows = []
            for begin in (0.0, LATER):
                grid = np.arange(begin, begin + WINDOW, 0.025)
                if grid[-1] <= time[-1]:
                    signal = np.interp(grid, time, samples[:, channel])
                    windows.append({"time_s": _list(grid), "signal": _list(signal - signal.mean())})
            runs.append({"name": one.record.name, "windows": windows})
        name = repeats[0].record.channels[repeats[0].columns[channel]].name
        overlays.append({"channel": name, "runs": runs})
    return overlays


def _maybe(value: float | None) -> float | None:
    return None if value is None else round_significant(value)


def _spectra(found: Identification, r: int) -> dict[str, Any]:
    one, data = found.prepared[r], found.blocks[found.block_of[r]]
    fit, columns = found.fits[found.block_of[r]], found.columns[r]
    shown = data.omega <= 2 * np.pi * found.band.high
    measured, left = data.spectrum[shown][:, columns] * data.dt, fit.residual[shown][:, columns] * data.dt
    return {
        "record": one.record.name,
        "channels": [one.record.channels[c].name for c in one.columns],
        "frequency_Hz": _list(data.omega[shown] / (2 * np.pi)),
        "measured": [_list(np.abs(column)) for column in measured.T],
        "fitted": [_list(np.abs(column)) for column in (measured - left).T],
        "residual": [_list(np.abs(column)) for column in left.T],
        "poles_Hz": [round_significant(mode.frequency) for mode in found.modes],
    }


def _response(found: Identification, r: int) -> dict[str, Any] | None:
    response = compute_frequency_response(found, r)
    if response is None:
        return None
    return {
        "record": response.record,
        "channels": list(response.channels),
        "frequency_Hz": _list(response.frequency),
        "measured": [{"abs": _list(np.abs(h)), "phase_rad": _list(np.angle(h))} for h in response.measured.T],
        "identified": [{"abs": _list(np.abs(h)), "phase_rad": _list(np.angle(h))} for h in response.identified.T],
    }


def _list(values: RealArray) -> list[float]:
    return [float(f"{value:.6g}") for value in values]
