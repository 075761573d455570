"""Pantographs in Python: a chain of masses fitted to measured frequency responses."""

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w

from pantocheck.conformance.app.notebook.display import describe_in_one_line, tabulate_rows
from pantocheck.conformance.comparison.pantograph_fit import (
    CONTACT_SOURCE,
    FileTexts,
    build_pantograph_fit,
    describe_pantograph,
)
from pantocheck.conformance.comparison.response_comparison import compare_responses, model_stiffness
from pantocheck.conformance.core.array_types import ComplexArray, RealArray
from pantocheck.conformance.core.drawn_axes import INK, in_report_style, label_logarithms, provide_axes
from pantocheck.conformance.core.files import write_atomically
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.json_file import write_model
from pantocheck.conformance.core.toml_file import validate_model
from pantocheck.conformance.pantograph.chain_fit import ChainSelection, FitTask, fit_chains
from pantocheck.conformance.pantograph.pantograph_file import PantographFile
from pantocheck.conformance.pantograph.response_record import ResponseRecord, read_response
from pantocheck.conformance.pantograph.transfer_function import FittedTransfer
from pantocheck.conformance.results.comparison_format import ResponseComparison
from pantocheck.conformance.results.pantograph_fit_format import ChainParameter, PantographFit

LONGEST_SOURCE = 500
"""Largest number of characters of a source in a pantograph file."""

CONTACT_STIFFNESS_N_M = 50e3
"""Stiffness of the contact in a fitted file, if none is given [N/m]."""


@dataclass(frozen=True)
class FittedPantograph:
    """Chain of masses, fitted to frequency responses of a head."""

    tables: dict[str, Any]
    """Content of the pantograph file."""
    report: PantographFit
    """Content of the JSON report."""
    records: tuple[ResponseRecord, ...]
    """Measured responses."""

    def __repr__(self) -> str:
        """Number of masses in one line."""
        return describe_in_one_line(self, f"{self.report.masses} masses")

    def parameter(self, key: str, number: int) -> ChainParameter:
        """Fitted value of the chain.

        Args:
            key: `masses_kg`, `stiffness_N_m` or `damping_N_s_m`.
            number: Number of the mass or element, from 1 at the base.

        Returns:
            With `value`, `half_width` (of the 95 % interval) and `determination`.

        Raises:
            KeyError: The chain has no such parameter.
        """
        found = {(str(item.key), item.number): item for item in self.report.parameters}
        return found[key, number]

    def to_dataframe(self) -> Any:
        """Parameters of the chain, one per row: a table of pandas, or columns of numpy."""
        rows = [item.model_dump(mode="json") for item in self.report.parameters]
        return tabulate_rows(rows, ("key", "number", "value", "half_width", "determination"))

    def dynamic_stiffness(self, frequency_Hz: RealArray) -> ComplexArray:
        """Force at the head over its displacement in the same direction [N/m].

        Args:
            frequency_Hz: Frequencies, (n,) [Hz].
        """
        pantograph = validate_model(self.tables, PantographFile, "fitted pantograph")
        return model_stiffness(pantograph, np.asarray(frequency_Hz, dtype=np.float64))

    @in_report_style
    def plot(self, axes: Any = None) -> Any:
        """Plot the modulus of the apparent mass over the frequency, measured and fitted; returns matplotlib axes.

        Args:
            axes: Axes to draw in; None: those of a new figure.
        """
        axes = provide_axes(axes)
        for record, mark in zip(self.records, ".x+^" * len(self.records), strict=False):
            squared = (2 * np.pi * record.frequency) ** 2
            axes.plot(record.frequency, np.abs(record.stiffness) / squared, mark, markersize=4, label=record.source)
        frequency = np.geomspace(*self.report.band_Hz, 400)
        fitted = np.abs(self.dynamic_stiffness(frequency)) / (2 * np.pi * frequency) ** 2
        axes.loglog(frequency, fitted, color=INK, linewidth=1.2, label=f"chain of {self.report.masses} masses")
        axes.set(xlabel="frequency [Hz]", ylabel="apparent mass [kg]")
        label_logarithms(axes)
        axes.legend()
        return axes

    def write(self, path: str | Path) -> list[Path]:
        """Write the pantograph file, and the report beside it; returns the paths.

        Args:
            path: Path of the pantograph file; it ends in .toml.

        Raises:
            InputError: The name does not end in .toml, or a file cannot be written.
        """
        from pantocheck.conformance.pages.pantograph_pages import build_pantograph_fit_document
        from pantocheck.conformance.pages.report_writers import write_document

        out = Path(path)
        if out.suffix != ".toml":
            raise InputError(str(out), "is not a TOML file", "Give a name that ends in .toml .")
        write_atomically(out, tomli_w.dumps(self.tables).encode())
        data = out.with_name(f"{out.stem}-fit.json")
        write_model(data, self.report)
        document = build_pantograph_fit_document(self.report)
        return [out, data, *write_document(document, data.with_suffix(""))]


def fit_pantograph(
    *responses: str | Path,
    masses: int | None = None,
    bending_modes: int = 0,
    band_Hz: tuple[float, float] = (0.0, math.inf),
    title: str = "Fitted pantograph",
    contact_stiffness_N_m: float = CONTACT_STIFFNESS_N_M,
) -> FittedPantograph:
    """Fit a chain of masses to frequency responses of a head, as `pantocheck pantograph fit` does.

    Args:
        *responses: Tables of measured responses, or their sidecars.
        masses: Number of masses, 2 to 4; None: that with the lowest information criterion.
        bending_modes: Number of bending modes of the head beside the chain.
        band_Hz: Lowest and highest frequency of the fit [Hz].
        title: Title of the pantograph.
        contact_stiffness_N_m: Stiffness of the contact, which a response does not contain [N/m].

    Raises:
        InputError: A response cannot be read, is not that of the centre of the head, or has too few rows in the band.
    """
    records = tuple(read_response(Path(path)) for path in responses)
    selection = fit_chains(records, FitTask(band_Hz, None, bending_modes))
    if masses is not None and masses not in selection.fits:
        raise InputError("masses", f"{masses} is not possible", f"Give one of {', '.join(map(str, selection.fits))}.")
    return build_fitted_pantograph(records, selection, masses or selection.best, title, contact_stiffness_N_m)


def build_fitted_pantograph(
    records: tuple[ResponseRecord, ...], selection: ChainSelection, masses: int, title: str, contact_stiffness: float
) -> FittedPantograph:
    """Pantograph file and report of the fitted chain with one number of masses; contact stiffness in [N/m]."""
    texts = _describe_source(records, title)
    tables = describe_pantograph(selection, masses, texts, contact_stiffness)
    comparison = _complete_tables(tables, records, texts.source)
    return FittedPantograph(tables, build_pantograph_fit(selection, masses, title, comparison), records)


def _describe_source(records: tuple[ResponseRecord, ...], title: str) -> FileTexts:
    names = ", ".join(f"{record.source} ({record.sidecar.source})" for record in records)
    return FileTexts(title, f"pantocheck pantograph fit, from {names}"[:LONGEST_SOURCE])


def _complete_tables(tables: dict[str, Any], records: tuple[ResponseRecord, ...], source: str) -> ResponseComparison:
    """Compare a pantograph file with its responses, and state in it the frequency that they support."""
    comparison = compare_responses(records, validate_model(tables, PantographFile, "fitted pantograph"))
    if (highest := comparison.supported_to_Hz) is not None:
        tables["validity"] = {"supported_to_Hz": highest, "basis": "measured_response", "source": source}
    return comparison


def build_transfer_pantograph(
    records: tuple[ResponseRecord, ...], fit: FittedTransfer, title: str, contact_stiffness: float
) -> tuple[dict[str, Any], ResponseComparison]:
    """Tables of the pantograph file of a fitted transfer function, and its comparison with the responses.

    Args:
        records: Measured responses.
        fit: Fitted transfer function.
        title: Title of the pantograph.
        contact_stiffness: Stiffness of the contact, which the responses do not contain [N/m].
    """
    texts = _describe_source(records, title)
    columns = {"poles_1_s": fit.pole, "residues_m_N_s": fit.residue}
    values = {key: [[float(f"{v:.12g}") for v in (x.real, x.imag)] for x in row] for key, row in columns.items()}
    distance = f"{100 * fit.distance:.2g} % of the receptance"
    note = f"Nearest passive model, {distance} from the fit. uplift_factor is not measured."
    tables = {
        "title": texts.title,
        "transfer_function": {**values, "source": texts.source, "note": note},
        "contact": {"stiffness_N_m": contact_stiffness, "source": CONTACT_SOURCE},
    }
    return tables, _complete_tables(tables, records, texts.source)
