"""Lines in Python: shape at rest, droppers, elasticity, and a figure of some spans."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pantocheck.conformance.app.notebook.display import describe_in_one_line, tabulate_columns
from pantocheck.conformance.cases.case_parts import locate_part, read_line_file, read_pantograph_file
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.drawn_axes import GREY, INK, in_report_style, label_logarithms, provide_axes
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.texts import count_noun
from pantocheck.conformance.line.catenary_model import discretise_line
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.line.line_shape import find_deflection, list_element_marks
from pantocheck.conformance.pantograph.pantograph_file import PantographFile
from pantocheck.conformance.pantograph.pantograph_model import build_pantograph
from pantocheck.model import Catenary, DiscretisedLine, Kind, Pantograph, static_uplift
from pantocheck.model.description.one_thread import use_one_thread
from pantocheck.model.description.pantograph import apparent_mass, frequencies

WIRE_STYLES = {
    Kind.CONTACT_WIRE: {"color": INK, "linewidth": 1.6},
    Kind.MESSENGER_WIRE: {"color": INK, "linewidth": 0.9},
    Kind.STITCH_WIRE: {"color": INK, "linewidth": 0.6},
}


@dataclass(frozen=True)
class OpenedLine:
    """A line at rest, in the elements of its case."""

    file: LineFile
    """Content of the line file."""
    element_m: float
    """Largest length of an element [m]."""

    def __repr__(self) -> str:
        """Title, spans, length and elements in one line."""
        spans = count_noun(self.file.geometry.spans, "span")
        length = f"{self.file.geometry.length:g} m"
        return describe_in_one_line(self, spans, length, f"elements of {self.element_m:g} m", self.file.title)

    @property
    def span_limits(self) -> RealArray:
        """Positions of the supports, with both ends of the line [m]."""
        return np.array(self.file.geometry.span_limits)

    @property
    def discretised(self) -> DiscretisedLine:
        """Finite elements of the line at rest, for the functions of `pantocheck.model`.

        Raises:
            SimulationError: The prescribed geometry has no equilibrium.
        """
        return discretise_line(self.file, self.element_m)

    @property
    def catenary(self) -> Catenary:
        """Description of the line for `pantocheck.model`."""
        return self.discretised.catenary

    def shape(self) -> Any:
        """Shape of all wires at rest: a table of pandas, or columns of numpy.

        Columns are `wire`, `position_m`, `height_m` above the datum of the line and, if the line has a stagger,
        `lateral_m`.
        """
        line = self.discretised
        stations = {wire.name: self._stations(wire.start, wire.end) for wire in line.catenary.wires}
        columns = {
            "wire": np.array([name for name, x in stations.items() for _ in x], dtype=object),
            "position_m": np.concatenate(list(stations.values())),
        }
        for field, name in (("z", "height_m"), ("y", "lateral_m")):
            if field == "z" or line.catenary.has_lateral_field:
                columns[name] = np.concatenate([find_deflection(line, wire, field, x) for wire, x in stations.items()])
        return tabulate_columns(columns)

    def droppers(self) -> Any:
        """Droppers at rest: a table of pandas, or columns of numpy.

        Columns are `position_m`, `lower` and `upper` (names of the wires), `length_m` between the wires and `force_N`.
        """
        droppers, state = self.catenary.droppers, self.discretised.state
        return tabulate_columns(
            {
                "position_m": np.array([dropper.position for dropper in droppers]),
                "lower": np.array([dropper.lower for dropper in droppers], dtype=object),
                "upper": np.array([dropper.upper for dropper in droppers], dtype=object),
                "length_m": state.dropper_length.copy(),
                "force_N": state.dropper_tension.copy(),
            }
        )

    @use_one_thread
    def elasticity(self, position_m: ArrayLike, force_N: float = 1.0) -> RealArray:
        """Elasticity: static uplift of the contact wire under a force, over that force; droppers may slacken.

        Args:
            position_m: Positions of the force, which acts at one of them at a time [m].
            force_N: Force upwards [N].

        Returns:
            Elasticity at every position, (n,) [mm/N].

        Raises:
            InputError: A position is not on the line, or the force is not positive.
        """
        positions, limits = np.atleast_1d(np.asarray(position_m, dtype=float)), self.span_limits
        outside = positions[~((limits[0] <= positions) & (positions <= limits[-1]))]
        if outside.size:
            hint = f"Give positions from {limits[0]:g} to {limits[-1]:g} m."
            raise InputError("elasticity, position_m", f"{outside[0]:g} m is not on the line", hint)
        if not force_N > 0:
            raise InputError("elasticity, force_N", f"found {force_N:g} N", "Give a force above zero, in newtons.")
        return 1e3 * static_uplift(self.discretised, positions, force_N) / force_N

    @in_report_style
    def plot(self, first_span: int = 1, last_span: int | None = None, axes: Any = None) -> Any:
        """Plot some spans in elevation, the height enlarged; returns matplotlib axes.

        Args:
            first_span, last_span: Numbers of the spans, from 1; default: all spans.
            axes: Axes of the figure; None: those of a new one.

        Raises:
            InputError: The line does not have these spans.
        """
        start, end = self._section(first_span, last_span)
        axes = provide_axes(axes)
        for x, heights, style in self._list_curves(start, end):
            axes.plot(x, heights, **style)
        for mark in list_element_marks(self.catenary):
            if start <= mark.position <= end and not mark.text:
                height = find_deflection(self.discretised, mark.wire, "z", mark.position)
                style = {"color": INK, "markerfacecolor": "white", "markersize": 5}
                axes.plot(mark.position, height, mark.symbol.marker, **style)
        axes.set(xlabel="position along the track [m]", ylabel="height [m]", title=self.file.title)
        return axes

    def _section(self, first: int, last: int | None) -> tuple[float, float]:
        """Both ends of a stretch of spans [m]."""
        spans = self.file.geometry.spans
        if not 1 <= first <= (last or spans) <= spans:
            hint = f"Give spans from 1 to {spans}."
            raise InputError("plot, first_span and last_span", f"found {first} to {last or spans}", hint)
        return self.file.geometry.section(first, last or spans)

    def _stations(self, start: float, end: float) -> RealArray:
        """Stations of the mesh between two positions [m]."""
        x = self.discretised.mesh.position
        return x[(x >= start - 1e-6) & (x <= end + 1e-6)]

    def _list_curves(self, start: float, end: float) -> Iterator[tuple[RealArray, RealArray, dict[str, Any]]]:
        """Positions, heights and style of every wire and dropper between two positions."""
        line = self.discretised
        for wire in line.catenary.wires:
            x = self._stations(max(wire.start, start), min(wire.end, end))
            if x.size:
                yield x, find_deflection(line, wire.name, "z", x), WIRE_STYLES[wire.kind]
        for dropper in line.catenary.droppers:
            if start <= dropper.position <= end:
                x = np.full(2, dropper.position)
                ends = [find_deflection(line, name, "z", dropper.position) for name in (dropper.lower, dropper.upper)]
                yield x, np.array(ends), {"color": GREY, "linewidth": 0.6}


def open_line(name: str | Path, element_m: float = 0.5) -> OpenedLine:
    """Open a line file.

    Args:
        name: Path of the file, or its name in the library such as `en50318-2018/ac-simple/line.toml`.
        element_m: Largest length of an element [m].

    Raises:
        InputError: There is no such file, it is invalid, or the length of the elements is not positive.
    """
    if not element_m > 0:
        raise InputError("open_line, element_m", f"found {element_m:g} m", "Give a length above zero, in metres.")
    return OpenedLine(read_line_file(locate_part(str(name), Path.cwd(), f"line '{name}'")), element_m)


# Pantographs in Python: read a file, frequency response at the head, and a figure.
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

    @in_report_style
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
