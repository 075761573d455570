"""Modes of a line in Python, identified from mass drops, and damping models fitted to them."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from pantocheck.conformance.app.notebook.display import (
    describe_in_one_line,
    tabulate_columns,
    tabulate_rows,
    warn_missing_formats,
)
from pantocheck.conformance.app.notebook.opened_case import OpenedCase
from pantocheck.conformance.app.notebook.opened_drop import OpenedDrop
from pantocheck.conformance.core.drawn_axes import INK, in_report_style, provide_axes
from pantocheck.conformance.core.files import write_atomically
from pantocheck.conformance.core.json_file import write_model
from pantocheck.conformance.core.texts import count_noun
from pantocheck.conformance.drops.damping_results import (
    FitOptions,
    WireCoefficients,
    build_damping_results,
    write_damping_toml,
)
from pantocheck.conformance.drops.drop_reading import read_drop_records
from pantocheck.conformance.drops.drop_record import DropRecord
from pantocheck.conformance.drops.identification_analysis import analyse_identification
from pantocheck.conformance.drops.identify import identify_modes
from pantocheck.conformance.drops.line_comparison import compare_line, refuse_other_line
from pantocheck.conformance.drops.mode_matching import select_usable
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.line.line_parameters import MECHANICAL, ParameterGroup, build_factor_covariance
from pantocheck.conformance.pages.document import Document
from pantocheck.conformance.results.damping_format import Coefficient, DampingResults
from pantocheck.conformance.results.identification_format import IdentificationFile, IdentifiedLine
from pantocheck.conformance.results.identified_modes import Mode, ModesFile, read_modes
from pantocheck.model import Catenary

COEFFICIENT_COLUMNS = ("kind", "matrix", "value", "low_95", "high_95", "determined", "reason")
"""Columns of the table of coefficients, with the keys of damping.json."""

DATA_FILES = ("damping.toml", "damping_with_modal.toml", "damping.json")
"""Files of a fit beside its report."""

MODEL_STYLES = ("--", "-", ":")
"""Lines of the models in a figure."""


@dataclass(frozen=True)
class FittedDamping:
    """Damping model of a line, fitted to identified modes: C = sum over the components of (a M + b K)."""

    results: DampingResults
    """Content of damping.json."""

    def __repr__(self) -> str:
        """Number of coefficients in one line."""
        return describe_in_one_line(self, count_noun(len(self.results.coefficients), "coefficient"))

    @property
    def toml(self) -> str:
        """Table `damping` of a line file, without the coefficients that the modes do not determine."""
        return write_damping_toml(self.results)

    def coefficient(self, kind: str, matrix: str) -> Coefficient:
        """Fitted coefficient of one kind of component.

        Args:
            kind: Kind of component, for example `contact_wire`.
            matrix: Matrix of the coefficient: `stiffness` [s] or `mass` [1/s].

        Returns:
            With `value`, `low_95`, `high_95` and `determined`.

        Raises:
            KeyError: The fit has no such coefficient.
        """
        found = {(row.kind, row.matrix): row for row in self.results.coefficients}
        return found[kind, matrix]

    def to_dataframe(self) -> Any:
        """Coefficients with their nominal 95 % intervals, one per row: a table of pandas, or columns of numpy."""
        return tabulate_rows([row.model_dump(mode="json") for row in self.results.coefficients], COEFFICIENT_COLUMNS)

    def models(self) -> Any:
        """Damping ratios of the computed modes: a table of pandas, or columns of numpy.

        Columns are `frequency_Hz` and one per model: `line as it is` (the damping of the line file), `Rayleigh` (the
        fit) and `Rayleigh + modal`.
        """
        comparison = self.results.comparison
        columns = {"frequency_Hz": comparison.frequency_Hz, **comparison.models}
        return tabulate_columns({name: np.array(values) for name, values in columns.items()})

    @in_report_style
    def plot(self, axes: Any = None) -> Any:
        """Plot the damping ratios over the frequency, identified and of the models; returns matplotlib axes.

        Args:
            axes: Axes to draw in; None: those of a new figure.
        """
        axes, comparison = provide_axes(axes), self.results.comparison
        measured = comparison.measured
        _draw_intervals(axes, measured.frequency_Hz, measured.damping_ratio, measured.std)
        for (name, ratios), style in zip(comparison.models.items(), MODEL_STYLES, strict=False):
            axes.plot(comparison.frequency_Hz, [100 * ratio for ratio in ratios], style, label=name)
        axes.set(xlabel="frequency [Hz]", ylabel="damping ratio [%]")
        axes.legend()
        return axes

    def write(self, folder: str | Path) -> list[Path]:
        """Write damping.toml, damping_with_modal.toml, damping.json and the report; returns the paths of the files.

        Args:
            folder: Folder of the files.

        Raises:
            InputError: A file cannot be written.
        """
        warn_missing_formats()
        return write_damping_fit(self.results, Path(folder))[1]


def _draw_intervals(
    axes: Any, frequency_Hz: Sequence[float], ratio: Sequence[float], std: Sequence[float], capsize: int = 0
) -> None:
    """Draw identified damping ratios with their nominal 95 % intervals in percent."""
    values, widths = [100 * value for value in ratio], [196 * value for value in std]
    label = "identified, nominal 95 % interval"
    axes.errorbar(frequency_Hz, values, widths, fmt="o", color=INK, markersize=4, capsize=capsize, label=label)


def refuse_other_modes(modes: tuple[Mode, ...], catenary: Catenary, name: str) -> None:
    """Refuse modes whose record is of another line; `name` is that of their file."""
    refuse_other_line(compare_line(select_usable(modes, name), catenary), name)


def write_damping_fit(results: DampingResults, folder: Path) -> tuple[Document, list[Path]]:
    """Write all files of a fit; returns the report and the paths of the files."""
    from pantocheck.conformance.pages.damping_page import build_damping_document
    from pantocheck.conformance.pages.report_writers import write_document

    block, with_modal, data = (folder / name for name in DATA_FILES)
    text = write_damping_toml(results)
    document = build_damping_document(results, text)
    write_atomically(block, text.encode("utf-8"))
    write_atomically(with_modal, write_damping_toml(results, results.modal).encode("utf-8"))
    write_model(data, results)
    return document, [block, with_modal, data, *write_document(document, folder / "damping")]


HIGHEST_FREQUENCY_HZ = 10.0
"""Highest frequency of a mode, if none is given [Hz]."""

MODE_KEYS = (
    "frequency_Hz",
    "frequency_std_Hz",
    "damping_ratio",
    "damping_ratio_std",
    "group",
    "certain",
    "lateral",
    "outlier",
    "record",
)
"""Columns of the table of modes, with the keys of modes.json."""


@dataclass(frozen=True)
class IdentifiedLines:
    """Modes that were identified from mass-drop records."""

    modes: tuple[Mode, ...]
    """Modes of all lines, in the order of frequency within a line."""

    def __repr__(self) -> str:
        """Number of modes in one line."""
        return describe_in_one_line(self, count_noun(len(self.modes), "mode"))

    def to_dataframe(self) -> Any:
        """Modes, one per row: a table of pandas, or columns of numpy.

        Columns have the keys of modes.json; `damping_ratio_std` is the standard deviation of `damping_ratio`.
        """
        return tabulate_rows([mode.model_dump(mode="json") for mode in self.modes], MODE_KEYS)

    @in_report_style
    def plot(self, axes: Any = None) -> Any:
        """Plot the damping ratios of the certain modes over their frequency, with nominal 95 % intervals; returns axes.

        Args:
            axes: Axes to draw in; None: those of a new figure.
        """
        axes = provide_axes(axes)
        certain = [mode for mode in self.modes if mode.certain and not mode.lateral]
        keys = ("frequency_Hz", "damping_ratio", "damping_ratio_std")
        frequency, ratio, std = ([getattr(mode, key) for mode in certain] for key in keys)
        _draw_intervals(axes, frequency, ratio, std, capsize=2)
        axes.set(xlabel="frequency [Hz]", ylabel="damping ratio [%]")
        axes.legend()
        return axes

    def fit_damping(
        self,
        case: OpenedCase,
        element_m: float = 0.5,
        wires: WireCoefficients = "separate",
        free: tuple[ParameterGroup, ...] = ("tensions",),
    ) -> FittedDamping:
        """Fit a damping model of the line of a case to the modes, as `pantocheck drop fit` does.

        Args:
            case: Case with the line of the records.
            element_m: Element length [m].
            wires: Whether contact and messenger wire have their own coefficients, or the same.
            free: Properties of the line that are fitted as well: tensions, droppers, supports, arms.

        Raises:
            InputError: The line is not that of the record, or the modes do not determine a model.
        """
        line = case.case.line
        catenary = build_catenary(line)
        refuse_other_modes(self.modes, catenary, "modes")
        options = FitOptions(wires, free=free, tolerances=build_factor_covariance(line, MECHANICAL))
        return FittedDamping(build_damping_results(self.modes, catenary, element_m, "modes", options))

    def write(self, folder: str | Path) -> list[Path]:
        """Write modes.json; returns the paths of the files.

        Args:
            folder: Folder of the files.

        Raises:
            InputError: A file cannot be written.
        """
        path = Path(folder) / "modes.json"
        write_model(path, ModesFile(self.modes))
        return [path]


@dataclass(frozen=True, repr=False)
class IdentifiedRecords(IdentifiedLines):
    """Modes of the lines of mass-drop records, with the records and the course of the identification."""

    lines: tuple[IdentifiedLine, ...]
    """Content of identification.json, line by line."""

    def write(self, folder: str | Path) -> list[Path]:
        """Write modes.json, identification.json and the report as HTML and PDF; returns the paths of the files.

        Args:
            folder: Folder of the files.

        Raises:
            InputError: A file cannot be written.
        """
        paths = super().write(folder)
        warn_missing_formats()
        return [*paths, *write_identification(self.lines, Path(folder))[1]]


def write_identification(lines: tuple[IdentifiedLine, ...], folder: Path) -> tuple[Document, list[Path]]:
    """Write identification.json and the report; returns the report and the paths of the files."""
    from pantocheck.conformance.pages.identification_page import build_identification_document
    from pantocheck.conformance.pages.report_writers import write_document

    document = build_identification_document(lines)
    write_model(folder / "identification.json", IdentificationFile(lines=lines))
    return document, [folder / "identification.json", *write_document(document, folder / "identification")]


def identify_line(*drops: str | Path | OpenedDrop, highest_Hz: float = HIGHEST_FREQUENCY_HZ) -> IdentifiedRecords:
    """Identify the modes of a line from mass drops, as `pantocheck drop identify` does.

    Args:
        *drops: Records, or simulated drops, of one or more drops.
        highest_Hz: Highest frequency of a mode [Hz].

    Raises:
        InputError: A record cannot be read, or holds no decay.
    """
    records = tuple(record for drop in drops for record in _list_records(drop))
    lines = tuple(map(analyse_identification, identify_modes(records, highest_Hz)))
    return IdentifiedRecords(tuple(mode for line in lines for mode in line.modes), lines)


def _list_records(drop: str | Path | OpenedDrop) -> Iterator[DropRecord]:
    """Records of a file, or that of a simulated drop."""
    if isinstance(drop, OpenedDrop):
        yield drop.record
    else:
        yield from read_drop_records(Path(drop))


def open_modes(path: str | Path) -> IdentifiedLines:
    """Read a modes.json.

    Args:
        path: Path of the file.

    Raises:
        InputError: The file cannot be read, or is not a list of modes.
    """
    return IdentifiedLines(read_modes(Path(path)))
