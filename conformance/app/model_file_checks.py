"""Checks of the files of a model: case, line, pantograph and limits, with the files that they name."""

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.sourced_table import NO_SOURCE
from pantocheck.conformance.core.texts import count_noun
from pantocheck.conformance.core.toml_file import read_model

if TYPE_CHECKING:  # an editor checks a pantograph at every save, without the formats of line and case
    from pantocheck.conformance.cases.limits import Limit
    from pantocheck.conformance.line.line_file import LineFile

LARGEST_REST_ELEMENT_M = 2.0
"""Largest element for the line at rest, whose shape hardly depends on it [m]."""


def _check_case(path: Path) -> str:
    from pantocheck.conformance.cases.library import load_case
    from pantocheck.conformance.grading.validity_warnings import speed_warnings

    case = load_case(path)
    _check_rest(case.line, f"case '{path.name}', line {case.line.title!r}")
    speed = "line at rest" if case.file.speed_km_h is None else f"{case.file.speed_km_h:g} km/h"
    pantographs = [count_noun(len(case.pantographs), "pantograph")] if case.pantographs else []
    speeds = [] if case.is_static else speed_warnings(case)
    warnings = [f"\n  warning: {text}" for text in (*speeds, *_warn_of_limits(case.file.limit))]
    description = f"case {case.id}: {', '.join([speed, *pantographs])}; line: {_describe_line(case.line)}"
    return "".join([description, *warnings])


def _check_limits(path: Path) -> str:
    from pantocheck.conformance.cases.limits import LimitsFile

    limits = read_model(path, LimitsFile, "limits").limit
    return "".join(["limits file", *(f"\n  warning: {text}" for text in _warn_of_limits(limits))])


def _warn_of_limits(limits: Iterable["Limit"]) -> Iterator[str]:
    """Limits without a source, which decide no verdict."""
    for limit in limits:
        if limit.source == NO_SOURCE:
            yield f'the limit of {limit.quantity} does not count. Give it trust, e.g. "primary", and source'


def _check_line(path: Path) -> str:
    from pantocheck.conformance.line.line_file import LineFile

    line = read_model(path, LineFile, "line")
    _check_rest(line, f"line '{path.name}'")
    return f"line: {_describe_line(line)}"


def _check_pantograph(path: Path) -> str:
    from pantocheck.conformance.cases.lift_force import resolve_rule
    from pantocheck.conformance.pantograph.pantograph_file import PantographFile

    resolve_rule(read_model(path, PantographFile, "pantograph"), f"pantograph '{path.name}'")
    return "pantograph file"


def _check_rest(line: "LineFile", where: str) -> None:
    """Refuse a line without a static equilibrium."""
    from pantocheck.conformance.line.catenary_model import build_catenary  # the linear algebra of a line
    from pantocheck.model import discretise
    from pantocheck.model.description.failures import ImpossibleDropper, SimulationError

    try:
        discretise(build_catenary(line), LARGEST_REST_ELEMENT_M)
    except SimulationError as error:
        place = _name_dropper(line, error.position) if isinstance(error, ImpossibleDropper) else ""
        hint = (
            "Check encumbrance, tensions, masses, pre-sag and the positions of the droppers; check that the heights "
            "contact_wire_height_m of supports and droppers count from the same datum."
        )
        raise InputError(where, f"is impossible at rest: {place}{error}", hint) from None


def _name_dropper(line: "LineFile", position: float) -> str:
    """Numbers of the span and of its dropper nearest to a position [m]."""
    number, _ = line.geometry.spans_of_section(position, position)
    dropper = int(abs(line.layout.spans[number - 1].dropper_position - position).argmin()) + 1
    return f"span {number}, dropper {dropper}: "


def _describe_line(line: "LineFile") -> str:
    return f"{line.geometry.spans} spans, {line.geometry.length:g} m"


MODEL_FILE_CHECKS = {"case": _check_case, "limits": _check_limits, "line": _check_line, "pantograph": _check_pantograph}
"""Checks by the kind of the file; each returns kind and size of the valid content, and a line for each warning."""
