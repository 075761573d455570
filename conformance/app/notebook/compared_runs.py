"""Comparisons of runs in Python: quantities side by side, and forces at the same positions."""

import csv
import io
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pantocheck.conformance.app.notebook.display import describe_in_one_line, tabulate_rows
from pantocheck.conformance.app.notebook.opened_run import OpenedRun, open_run
from pantocheck.conformance.comparison.run_comparison import compare_subjects
from pantocheck.conformance.core.drawn_axes import provide_axes
from pantocheck.conformance.core.files import write_atomically
from pantocheck.conformance.core.json_file import write_model
from pantocheck.conformance.results.comparison_format import ComparedOwner, ForceAgreement, RunComparison

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
        owner = self._find_owner(pantograph)
        found = {agreement.subject: agreement for agreement in owner.agreements}
        name = self.subjects[subject - 1]
        if name not in found:
            raise KeyError("; ".join(owner.reasons) or f"no force of {name}")
        return found[name]

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

    def _find_owner(self, pantograph: int) -> ComparedOwner:
        return next(owner for case in self.comparison.cases for owner in case.owners if owner.number == pantograph)

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
    """Write all files of a comparison; return their paths.

    Raises:
        InputError: A file cannot be written.
    """
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
