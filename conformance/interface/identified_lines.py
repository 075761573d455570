"""Mass drops in Python: modes of a line, and a damping model fitted to them."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.identification.damping.damping_format import DampingResults
from pantocheck.conformance.identification.damping.damping_results import FitOptions, build_damping_results
from pantocheck.conformance.identification.damping.line_comparison import compare_line, refuse_other_line
from pantocheck.conformance.identification.damping.mode_matching import select_usable
from pantocheck.conformance.identification.identification_analysis import analyse_identification
from pantocheck.conformance.identification.identify import identify_modes
from pantocheck.conformance.identification.mode import Mode, read_modes
from pantocheck.conformance.interface.column_table import tabulate_rows
from pantocheck.conformance.mass_drops.drop_reading import read_drop_records
from pantocheck.conformance.simulation.catenary_model import build_catenary

HIGHEST_FREQUENCY_HZ = 10.0
"""Highest frequency of a mode, if none is given [Hz]."""


@dataclass(frozen=True)
class IdentifiedLines:
    """Modes that were identified from mass-drop records.

    Parameters
    ----------
    modes : tuple of Mode
        Modes of all lines, in the order of frequency within a line.
    """

    modes: tuple[Mode, ...]

    def to_dataframe(self) -> Any:
        """Modes, one per row: a table of pandas, or columns of numpy."""
        rows = [mode.model_dump(mode="json") for mode in self.modes]
        names = [name for name, value in rows[0].items() if isinstance(value, float | int | str)] if rows else []
        return tabulate_rows(rows, names)

    def fit_damping(self, case: Case, element_m: float = 0.5) -> DampingResults:
        """Fit a damping model of the line of a case to the modes, as `pantocheck fit-damping` does.

        Raises
        ------
        InputError
            The line is not that of the record, or the modes do not determine a model.
        """
        catenary, name = build_catenary(case.line), "modes"
        refuse_other_line(compare_line(select_usable(self.modes, name), catenary), name)
        return build_damping_results(self.modes, catenary, element_m, name, FitOptions())


def identify_line(*paths: str | Path, highest_Hz: float = HIGHEST_FREQUENCY_HZ) -> IdentifiedLines:
    """Identify the modes of a line from mass-drop records, as `pantocheck identify` does.

    Parameters
    ----------
    *paths : str or Path
        Records of one or more drops.
    highest_Hz : float
        Highest frequency of a mode [Hz].

    Raises
    ------
    InputError
        A record cannot be read, or holds no decay.
    """
    records = tuple(record for path in paths for record in read_drop_records(Path(path)))
    lines = map(analyse_identification, identify_modes(records, highest_Hz))
    return IdentifiedLines(tuple(mode for line in lines for mode in line.modes))


def open_modes(path: str | Path) -> IdentifiedLines:
    """Read a modes.json.

    Raises
    ------
    InputError
        The file cannot be read, or is no list of modes.
    """
    return IdentifiedLines(read_modes(Path(path)))
