"""Start poles placed by hand."""

from pathlib import Path
from typing import Annotated

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from pantocheck.conformance.array_types import ComplexArray
from pantocheck.conformance.identification.mode import read_modes
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.input_files.toml_file import read_model


class _Pole(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)

    frequency_Hz: Annotated[float, Field(gt=0, le=1000)]
    """Undamped frequency [Hz]."""
    damping_ratio: Annotated[float, Field(gt=0, lt=1)] = 0.002
    """Damping ratio [-]."""


class _Poles(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)

    pole: Annotated[tuple[_Pole, ...], Field(strict=False, min_length=1, max_length=1000)]
    """Start poles."""


def read_poles(path: Path) -> ComplexArray:
    """Read start poles, (m,) [1/s], from a TOML file with tables `[[pole]]`, or from a modes.json.

    Raises:
        InputError: The file cannot be read, its content is invalid, or it holds no pole.
    """
    rows: list[tuple[float, float]]
    if path.suffix == ".json":
        rows = [(mode.frequency_Hz, mode.damping_ratio) for mode in read_modes(path)]
        if not rows:
            raise InputError(f"modes '{path.name}'", "holds no mode", "Give a file with at least one mode.")
    else:
        rows = [(pole.frequency_Hz, pole.damping_ratio) for pole in read_model(path, _Poles, "poles").pole]
    frequency, damping = np.array(rows).T
    omega = 2 * np.pi * frequency
    return np.asarray(-damping * omega + 1j * omega * np.sqrt(1 - damping**2))
