"""Pantographs in Python: read a file, frequency response at the head, and a figure."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.cases.named_parts import locate_part, read_pantograph_file
from pantocheck.conformance.cases.pantograph_file import PantographFile
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.interface.drawn_axes import label_logarithms, provide_axes
from pantocheck.conformance.interface.one_line import describe_in_one_line
from pantocheck.conformance.simulation.pantograph_model import build_pantograph
from pantocheck.model import Pantograph
from pantocheck.model.pantograph import apparent_mass, frequencies


@dataclass(frozen=True)
class OpenedPantograph:
    """A pantograph."""

    path: Path
    """Pantograph file."""
    file: PantographFile
    """Content of the file."""

    def __repr__(self) -> str:
        """File and title in one line."""
        return describe_in_one_line(self, self.path.name, self.file.title)

    @property
    def model(self) -> Pantograph:
        """Linear model with the base fixed, for the functions of `pantocheck.model`."""
        return build_pantograph(self.file, 0.0, 0.0)

    @property
    def frequencies_Hz(self) -> RealArray:
        """Undamped natural frequencies with the base fixed and the head free [Hz]."""
        return frequencies(self.model)

    def apparent_mass_kg(self, frequency_Hz: ArrayLike) -> NDArray[np.complex128]:
        """Force over acceleration at the head, as on a test rig.

        Args:
            frequency_Hz: Frequencies [Hz].

        Returns:
            Apparent mass, (n,) [kg].

        Raises:
            InputError: A frequency is not above zero.
        """
        frequency = np.atleast_1d(np.asarray(frequency_Hz, dtype=float))
        if not np.all(frequency > 0):
            raise InputError("apparent_mass_kg", f"found {frequency.min():g} Hz", "Give frequencies above zero.")
        return np.asarray(apparent_mass(self.model, frequency))

    def plot(self, frequency_Hz: ArrayLike | None = None, axes: Any = None) -> Any:
        """Plot the magnitude of the apparent mass; returns matplotlib axes.

        Args:
            frequency_Hz: Frequencies [Hz]; default: 200 from 0.5 Hz to 50 Hz.
            axes: Axes of the figure; None: those of a new one.
        """
        frequency = np.geomspace(0.5, 50.0, 200) if frequency_Hz is None else np.asarray(frequency_Hz, dtype=float)
        axes = provide_axes(axes)
        axes.loglog(frequency, np.abs(self.apparent_mass_kg(frequency)))
        label_logarithms(axes)
        axes.set(xlabel="frequency [Hz]", ylabel="apparent mass [kg]", title=self.file.title)
        return axes


def open_pantograph(name: str | Path) -> OpenedPantograph:
    """Open a pantograph file.

    Args:
        name: Path of the file, or its name in the library such as `en50318-2018/pantograph.toml`.

    Raises:
        InputError: There is no such file, or it is invalid.
    """
    path = locate_part(str(name), Path.cwd(), f"pantograph '{name}'")
    return OpenedPantograph(path, read_pantograph_file(path))
