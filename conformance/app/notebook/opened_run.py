"""Runs in Python: quantities, signals and figures of a simulated or recorded passage, and comparisons."""

import csv
import io
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pantocheck.conformance.app.notebook.display import describe_in_one_line, tabulate_columns, tabulate_rows
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.comparison.compared_run import ComparedRun, read_record_run
from pantocheck.conformance.comparison.run_comparison import compare_subjects
from pantocheck.conformance.core.drawn_axes import GREY, INK, in_report_style, provide_axes
from pantocheck.conformance.core.files import write_atomically
from pantocheck.conformance.core.json_file import write_model
from pantocheck.conformance.core.texts import count_noun
from pantocheck.conformance.pages.words import quantity_label, quantity_unit
from pantocheck.conformance.quantities.bands import amplitude_spectrum
from pantocheck.conformance.quantities.evaluation import Value
from pantocheck.conformance.quantities.pantograph_signals import PantographSignals
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.record_writing import write_record
from pantocheck.conformance.results.comparison_format import ForceAgreement, RunComparison
from pantocheck.conformance.runs.system import System


@dataclass(frozen=True)
class OpenedRun:
    """A passage with its contact forces: simulated, delivered by a system, or read from a record."""

    run: ComparedRun
    """Quantities and signals of the passage."""

    def __repr__(self) -> str:
        """Case, speed, pantographs and origin in one line."""
        speed = "unknown speed" if self.run.speed_km_h is None else f"{self.run.speed_km_h:g} km/h"
        owners = count_noun(len(self.run.signals), "pantograph")
        return describe_in_one_line(
            self, self.run.case or "no case", speed, owners, f"{self.run.kind}: {self.run.name}"
        )

    @property
    def pantographs(self) -> tuple[int, ...]:
        """Numbers of the pantographs, from 1 in running order."""
        return tuple(self.run.signals)

    def quantity(self, name: str, pantograph: int = 1) -> Value:
        """Value of a quantity.

        Args:
            name: Name such as `std_force_N`.
            pantograph: Number of the pantograph; 0: the line.

        Raises:
            KeyError: The run does not have this quantity.
        """
        return self.run.values[pantograph][name]

    def to_dataframe(self) -> Any:
        """Quantities with their uncertainty, one per row: a table of pandas, or columns of numpy.

        The column `unknown_components` names the components that the uncertainty lacks, such as those of mesh and start
        after `simulate`. Quantities with several values, such as the elasticity along a span, are left out.
        """
        rows = [
            {
                "pantograph": owner,
                "quantity": name,
                "value": value,
                "unit": quantity_unit(name),
                "uncertainty": _select_number(self.run.uncertainty.get(owner, {}), name),
                "unknown_components": ", ".join(self.run.unknown_components),
                "label": quantity_label(name),
            }
            for owner, values in self.run.values.items()
            for name, value in values.items()
            if not isinstance(value, tuple)
        ]
        return tabulate_rows(
            rows, ("pantograph", "quantity", "value", "unit", "uncertainty", "unknown_components", "label")
        )

    def signals(self, pantograph: int = 1) -> Any:
        """Signals over the analysis section: a table of pandas, or columns of numpy.

        Columns are `position_m`, `force_N` (as delivered), `force_20_N` (filtered as graded) and, if it is known,
        `contact_height_m`.

        Args:
            pantograph: Number of the pantograph, from 1 in running order.

        Raises:
            KeyError: There is no such pantograph, or the run has no signals.
            QuantityUnavailable: The run does not cover its analysis section.
        """
        signals = self.run.signals[pantograph]
        columns = {
            "position_m": signals.position[signals.inside],
            "force_N": signals.delivered,
            "force_20_N": signals.graded,
        }
        if signals.contact_height is not None:
            columns["contact_height_m"] = signals.height
        return tabulate_columns(columns)

    @in_report_style
    def plot(self, pantograph: int = 1, axes: Any = None) -> Any:
        """Plot the force over the position, as delivered and as graded; returns matplotlib axes.

        Args:
            pantograph: Number of the pantograph, from 1 in running order.
            axes: Axes to draw in; None: those of a new figure.
        """
        signals = self.run.signals[pantograph]
        axes = provide_axes(axes)
        position = signals.position[signals.inside]
        axes.plot(position, signals.delivered, color=GREY, linewidth=0.8, label="as delivered")
        axes.plot(position, signals.graded, color=INK, linewidth=1.2, label="0-20 Hz")
        axes.set(xlabel="position along the track [m]", ylabel="contact force [N]", title=self._title(pantograph))
        axes.legend()
        return axes

    @in_report_style
    def plot_spectrum(self, pantograph: int = 1, axes: Any = None) -> Any:
        """Plot the amplitude spectrum of the force up to 50 Hz; returns matplotlib axes.

        Args:
            pantograph: Number of the pantograph, from 1 in running order.
            axes: Axes to draw in; None: those of a new figure.
        """
        signals: PantographSignals = self.run.signals[pantograph]
        axes = provide_axes(axes)
        axes.plot(*amplitude_spectrum(signals.delivered, signals.force.rate, signals.highest_frequency), color=INK)
        axes.set(xlabel="frequency [Hz]", ylabel="amplitude [N]", title=self._title(pantograph))
        return axes

    def _title(self, pantograph: int) -> str:
        return f"{self.run.case or self.run.name}, pantograph {pantograph}"


@dataclass(frozen=True, repr=False)
class SimulatedRun(OpenedRun):
    """A passage that a system has run."""

    case: Case
    """Case of the run."""
    system: System
    """System that ran it."""
    record: Record
    """Samples of the run."""

    def write(self, path: str | Path) -> Path:
        """Write the run as a record, CSV or HDF5 by its suffix, with a sidecar; returns the sidecar.

        Args:
            path: Path of the table; its suffix chooses CSV or HDF5.

        Raises:
            InputError: The suffix is not that of a record, or a file cannot be written.
        """
        further = {
            "case_digest": self.case.digest,
            "changes": list(self.case.changes) or None,
            "line": {"span_m": self.case.line.geometry.longest_span},
        }
        system = {"name": self.system.name, "version": self.system.version}
        return write_record(Path(path), self.record, case=self.case.id, system=system, further=further)


def _select_number(values: Mapping[str, Value], name: str) -> float | None:
    value = values.get(name)
    return value if isinstance(value, float) else None


def open_run(path: str | Path) -> OpenedRun:
    """Read a simulated or measured record with its sidecar.

    Args:
        path: Sidecar, or table with the sidecar beside it.

    Raises:
        InputError: The record cannot be read or is invalid.
    """
    return OpenedRun(read_record_run(Path(path)))


# Comparisons: quantities side by side, and forces at the same positions.
COMPARED_COLUMNS = (
    "case",
    "pantograph",
    "quantity",
    "subject",
    "value",
    "uncertainty",
    "difference",
    "beyond_uncertainty",
)
"""Columns of the table of a comparison."""


@dataclass(frozen=True)
class ComparedRuns:
    """Runs beside the first of them."""

    comparison: RunComparison
    """Content of comparison.json."""
    runs: tuple[OpenedRun, ...]
    """Compared runs, in the order of `subjects`."""

    def __repr__(self) -> str:
        """Names of the runs in one line."""
        return describe_in_one_line(self, *self.subjects)

    @property
    def subjects(self) -> tuple[str, ...]:
        """Names of the runs, unique in the comparison."""
        return tuple(subject.name for subject in self.comparison.subjects)

    def to_dataframe(self) -> Any:
        """Quantities of every run, one per row: a table of pandas, or columns of numpy.

        `difference` is the value minus that of the first run; `beyond_uncertainty` tells whether it exceeds the joint
        uncertainty of both values. Quantities with several values are left out.
        """
        return tabulate_rows(list(self._list_rows()), COMPARED_COLUMNS)

    def agreement(self, pantograph: int = 1, subject: int = 2) -> ForceAgreement:
        """Agreement of the force of a run with that of the first run.

        Args:
            pantograph: Number of the pantograph, from 1.
            subject: Number of the run, from 2.

        Returns:
            Agreement with `correlation`, `rms_difference_N`, `bands` and `spans`.

        Raises:
            KeyError: The forces were not compared; the message gives the reason.
        """
        owners = (owner for case in self.comparison.cases for owner in case.owners)
        owner = next(owner for owner in owners if owner.number == pantograph)
        found = {agreement.subject: agreement for agreement in owner.agreements}
        name = self.subjects[subject - 1]
        if name not in found:
            raise KeyError("; ".join(owner.reasons) or f"no force of {name}")
        return found[name]

    @in_report_style
    def plot(self, pantograph: int = 1, axes: Any = None) -> Any:
        """Plot the graded forces of all runs over the position; returns matplotlib axes.

        Args:
            pantograph: Number of the pantograph, from 1 in running order.
            axes: Axes to draw in; None: those of a new figure.
        """
        axes = provide_axes(axes)
        for name, opened, style in zip(self.subjects, self.runs, ("-", "--", ":", "-.") * len(self.runs), strict=False):
            signals = opened.run.signals[pantograph]
            axes.plot(signals.position[signals.inside], signals.graded, style, linewidth=1.3, label=name)
        axes.set(xlabel="position along the track [m]", ylabel="contact force, 0-20 Hz [N]")
        axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2)
        return axes

    def write(self, folder: str | Path) -> list[Path]:
        """Write comparison.json, .html, .pdf and .csv; returns their paths.

        Args:
            folder: Folder of the files.

        Raises:
            InputError: A file cannot be written.
        """
        return write_comparison(self.comparison, Path(folder))

    def _list_rows(self) -> Iterator[dict[str, object]]:
        for case in self.comparison.cases:
            for owner in case.owners:
                for quantity in owner.quantities:
                    if any(isinstance(value, tuple) for value in quantity.values):
                        continue
                    columns = (quantity.values, quantity.uncertainty, quantity.difference, quantity.beyond_uncertainty)
                    for subject, *numbers in zip(self.subjects, *columns, strict=True):
                        row = (case.id, owner.number, quantity.name, subject, *numbers)
                        yield dict(zip(COMPARED_COLUMNS, row, strict=True))


def compare_runs(*runs: OpenedRun | str | Path) -> ComparedRuns:
    """Compare runs with the first of them, as `pantocheck compare` does.

    Args:
        *runs: Two or more runs: simulated ones, or paths of records.

    Raises:
        InputError: A record cannot be read, or the runs have no common case.
    """
    opened = tuple(run if isinstance(run, OpenedRun) else open_run(run) for run in runs)
    return ComparedRuns(compare_subjects([[each.run] for each in opened], None), opened)


def write_comparison(comparison: RunComparison, folder: Path) -> list[Path]:
    """Write all files of a comparison; return their paths."""
    from pantocheck.conformance.pages.report_writers import write_document
    from pantocheck.conformance.pages.run_comparison_page import build_run_comparison

    data, values = folder / "comparison.json", folder / "comparison.csv"
    write_model(data, comparison)
    pages = write_document(build_run_comparison(comparison), folder / "comparison")
    write_atomically(values, _list_values(comparison).encode())
    return [data, *pages, values]


def _list_values(comparison: RunComparison) -> str:
    """Table of all values as comma-separated values; one row per quantity and subject."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(("case", "pantograph", "quantity", "subject", "item", "value", "uncertainty"))
    for case in comparison.cases:
        for owner in case.owners:
            for quantity in owner.quantities:
                for subject, value, width in zip(
                    comparison.subjects, quantity.values, quantity.uncertainty, strict=True
                ):
                    numbers = value if isinstance(value, tuple) else (value,)
                    widths = width if isinstance(width, tuple) else (width,) * len(numbers)
                    for item, (number, half_width) in enumerate(zip(numbers, widths, strict=True), 1):
                        place = item if isinstance(value, tuple) else ""
                        writer.writerow((case.id, owner.number, quantity.name, subject.name, place, number, half_width))
    return text.getvalue()
