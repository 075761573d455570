"""Irregularity of the contact wire of a line, realised from its line file."""

from dataclasses import replace
from functools import lru_cache

import numpy as np

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.cases.irregularity_table import IrregularityTable, SpectralIrregularity
from pantocheck.conformance.cases.line_file import LineFile
from pantocheck.model.irregularity import Irregularity, SpectralDensity, realise_irregularity
from pantocheck.model.irregularity_spline import irregularity_height


def build_irregularity(line: LineFile) -> Irregularity | None:
    """Irregularity of the contact wires of a line; parallel wires have the same. None: smooth wires."""
    table = line.contact_wire.irregularity
    return None if table is None else _realise(table, line.geometry.length)


@lru_cache(maxsize=8)
def _realise(table: IrregularityTable, length: float) -> Irregularity:
    """Irregularity of a table over a line of a length [m]."""
    if isinstance(table, SpectralIrregularity):
        realised = realise_irregularity(SpectralDensity(table.frequency_1_m, table.density_m3), length, table.seed)
    else:
        realised = Irregularity(table.x_m, table.height_m)
    return replace(realised, height=tuple(table.scale * height for height in realised.height))


def irregularity_at(line: LineFile, position: RealArray) -> RealArray:
    """Heights of the irregularity of a line at positions (n,) [m]; zero on smooth wires [m]."""
    irregularity = build_irregularity(line)
    return np.zeros_like(position) if irregularity is None else irregularity_height(irregularity, position)
