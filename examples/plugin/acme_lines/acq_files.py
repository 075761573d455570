"""Reader of files with the suffix .acq: a line of names, then rows of numbers."""

from pathlib import Path

import numpy as np

from pantocheck.conformance.extension import InputError, MeasuredTable, TableColumn, TableReader


def read_acq(path: Path) -> list[MeasuredTable]:
    """Read the run of an ACQ file."""
    head, *rows = path.read_text(encoding="utf-8").splitlines()
    if not head.startswith("ACQ "):
        raise InputError(f"record '{path.name}'", "does not begin with ACQ", "Export the record again.")
    names = head.split()[1:]
    values = np.loadtxt(rows, ndmin=2)
    return [MeasuredTable(path.name, values, tuple(map(TableColumn, names)))]


reader = TableReader(read=read_acq)
