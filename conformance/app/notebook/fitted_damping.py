"""Damping fits in Python: coefficients with their intervals, figures, and the files of a report."""

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
from pantocheck.conformance.core.drawn_axes import provide_axes
from pantocheck.conformance.core.files import write_atomically
from pantocheck.conformance.core.json_file import write_model
from pantocheck.conformance.core.texts import count_noun
from pantocheck.conformance.drops.damping_results import write_damping_toml
from pantocheck.conformance.pages.document import Document
from pantocheck.conformance.results.damping_format import Coefficient, DampingResults

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
        """Coefficients with their 95 % intervals, one per row: a table of pandas, or columns of numpy."""
        return tabulate_rows([row.model_dump(mode="json") for row in self.results.coefficients], COEFFICIENT_COLUMNS)

    def models(self) -> Any:
        """Damping ratios of the computed modes: a table of pandas, or columns of numpy.

        Columns are `frequency_Hz` and one per model: `line as it is` (the damping of the line file), `Rayleigh` (the
        fit) and `Rayleigh + modal`.
        """
        comparison = self.results.comparison
        columns = {"frequency_Hz": comparison.frequency_Hz, **comparison.models}
        return tabulate_columns({name: np.array(values) for name, values in columns.items()})

    def plot(self, axes: Any = None) -> Any:
        """Plot the damping ratios over the frequency, identified and of the models; returns matplotlib axes.

        Args:
            axes: Axes to draw in; None: those of a new figure.
        """
        axes, comparison = provide_axes(axes), self.results.comparison
        measured = comparison.measured
        axes.errorbar(
            measured.frequency_Hz,
            [100 * ratio for ratio in measured.damping_ratio],
            yerr=[196 * std for std in measured.std],
            fmt="o",
            color="0.1",
            markersize=4,
            label="identified, 95 % interval",
        )
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


def write_damping_fit(results: DampingResults, folder: Path) -> tuple[Document, list[Path]]:
    """Write all files of a fit; returns the report and the paths of the files.

    Raises:
        InputError: A file cannot be written.
    """
    from pantocheck.conformance.pages.damping_page import build_damping_document
    from pantocheck.conformance.pages.report_writers import write_document

    block, with_modal, data = (folder / name for name in DATA_FILES)
    text = write_damping_toml(results)
    document = build_damping_document(results, text)
    write_atomically(block, text.encode("utf-8"))
    write_atomically(with_modal, write_damping_toml(results, results.modal).encode("utf-8"))
    write_model(data, results)
    return document, [block, with_modal, data, *write_document(document, folder / "damping")]
