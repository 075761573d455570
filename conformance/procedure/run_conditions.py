"""Conditions of a run that a claim on the range of validity refers to: line, pantographs, speed, spacing, inputs."""

from collections.abc import Iterable, Sequence

from pydantic import BaseModel

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.line_file import LineFile
from pantocheck.conformance.cases.pantograph_file import PantographFile
from pantocheck.conformance.procedure.dossier import Dossier
from pantocheck.conformance.results.procedure_format import Evidence


def describe_conditions(name: str, case: Case, dossier: Dossier) -> Evidence | None:
    """Conditions of the run of a case; None for a case without a train.

    Args:
        name: Id of the result.
        case: The case.
        dossier: Dossier with the names of lines and pantographs, and the inputs whose change is claimed.
    """
    if case.is_static or case.file.mass_drop is not None or case.file.speed_km_h is None:
        return None
    return Evidence(
        id=name,
        line=dossier.name_line(case.line),
        pantographs=[dossier.name_pantograph(part) for part in case.pantographs],
        speed_km_h=case.file.speed_km_h,
        spacing_m=list(case.file.spacing_m or ()),
        inputs=list_inputs(dossier, case.line, case.pantographs),
    )


def list_inputs(dossier: Dossier, line: LineFile, pantographs: Sequence[PantographFile]) -> dict[str, float]:
    """Inputs whose change the dossier claims, by key as for `--set`; an input that is no number is left out."""
    found = {claim.key: _find_input(claim.key, line, pantographs) for claim in dossier.file.validity.change}
    return {key: value for key, value in found.items() if value is not None}


def _find_input(key: str, line: LineFile, pantographs: Sequence[PantographFile]) -> float | None:
    part, *names = key.split(".")
    if part == "line":
        return _follow(line, names)
    values = {_follow(pantograph, names) for pantograph in pantographs} if part == "pantograph" else set()
    return values.pop() if len(values) == 1 else None


def _follow(table: BaseModel, names: Iterable[str]) -> float | None:
    """Number at a path of keys in a table; items of a list count from 1. None if there is no number."""
    content: object = table
    for name in names:
        if isinstance(content, BaseModel):
            content = getattr(content, name, None)
        elif isinstance(content, tuple) and name.isdigit() and 1 <= int(name) <= len(content):
            content = content[int(name) - 1]
        else:
            return None
    return float(content) if isinstance(content, int | float) and not isinstance(content, bool) else None
