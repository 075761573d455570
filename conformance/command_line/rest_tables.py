"""What `pantocheck show --at-rest` prints: the line under its weight, and the pantographs on a test rig."""

from typing import TYPE_CHECKING

import numpy as np
from rich.padding import Padding
from rich.table import Table

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.command_line.console import escape_text, format_number
from pantocheck.conformance.quantities.registry import QUANTITIES
from pantocheck.conformance.records.evaluation import Value
from pantocheck.conformance.simulation.catenary_model import build_catenary
from pantocheck.conformance.simulation.pantograph_model import build_pantograph
from pantocheck.conformance.simulation.static_quantities import compute_static_quantities, first_modes, sample_span
from pantocheck.model import discretise
from pantocheck.model.pantograph import apparent_mass

if TYPE_CHECKING:
    from rich.console import RenderableType

FREQUENCIES_Hz = (0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 7.0, 10.0, 15.0, 20.0, 30.0, 50.0)
ALONG = "_along_span_mm_N"


def build_rest_tables(case: Case) -> "list[RenderableType]":
    """Quantities of the line at rest, elasticity along a span, and the apparent mass of the pantographs.

    Parameters
    ----------
    case : Case
        Any case, with or without a speed.
    """
    element = case.file.discretisation.element_m
    found = compute_static_quantities(case, discretise(build_catenary(case.line), element))
    found.setdefault("natural_frequency_Hz", tuple(map(float, first_modes(case.line, element).frequency)))
    parts = [_quantities(found), _elasticity(case, found)]
    models = dict.fromkeys(case.pantograph_files)
    for model in models:
        table = _table(f"Apparent mass at the head: {model.title}", "frequency [Hz]", "size [kg]", "phase [deg]")
        response = apparent_mass(build_pantograph(model, 0.0, 0.0), np.array(FREQUENCIES_Hz))
        for frequency, mass in zip(FREQUENCIES_Hz, response, strict=True):
            table.add_row(format_number(frequency), format_number(abs(mass)), f"{np.degrees(np.angle(mass)):.1f}")
        parts.append(table)
    return [Padding(part, (1, 0, 0, 0)) for part in parts]


def _quantities(found: dict[str, Value]) -> Table:
    table = _table("Line at rest, a span half way along it", "quantity", "value", "unit", "definition")
    for name, value in found.items():
        if not name.endswith(ALONG):
            numbers = value if isinstance(value, tuple) else (value,)
            quantity = QUANTITIES[name]
            text = ", ".join(format_number(one) for one in numbers)
            table.add_row(escape_text(name), escape_text(text), quantity.unit, escape_text(quantity.definition))
    return table


def _elasticity(case: Case, found: dict[str, Value]) -> Table:
    table = _table("Elasticity along the span", "from the support [m]", "small load [mm/N]", "200 N [mm/N]")
    columns = [found[f"{name}{ALONG}"] for name in ("elasticity", "elasticity_200_N")]
    small, large = (column if isinstance(column, tuple) else (column,) for column in columns)
    start, end = case.line.geometry.span(case.line.geometry.middle_span)
    for x, one, other in zip(sample_span(0.0, end - start), small, large, strict=True):
        table.add_row(f"{x:.2f}", format_number(one), format_number(other))
    return table


def _table(title: str, *columns: str) -> Table:
    return Table(*columns, title=title, title_justify="left", box=None, pad_edge=False)
