"""Limits of validity: the claims of a dossier. The runs that passed verify them."""

from collections.abc import Iterator

from pantocheck.conformance.procedure.dossier import Dossier
from pantocheck.conformance.procedure.dossier_tables import ValidityTable
from pantocheck.conformance.procedure.step_result import StepResult
from pantocheck.conformance.results.procedure_format import ValidityClaim


def list_claims(dossier: Dossier) -> StepResult:
    """Claims of a dossier; their verdicts follow from those of the runs."""
    table = dossier.file.validity
    if table.claims_nothing:
        return StepResult("limits_of_validity", "not done", "the dossier claims no range of validity (table validity)")
    return StepResult("limits_of_validity", claims=tuple(_list_claims(table)))


def _list_claims(table: ValidityTable) -> Iterator[ValidityClaim]:
    for name in table.lines:
        yield ValidityClaim(kind="line", name=name, unit="", claimed=None)
    for name in table.pantographs:
        yield ValidityClaim(kind="pantograph", name=name, unit="", claimed=None)
    if table.speed_km_h is not None:
        yield ValidityClaim(kind="speed", name="", unit="km/h", claimed=table.speed_km_h)
    if table.spacing_m is not None:
        yield ValidityClaim(kind="spacing", name="", unit="m", claimed=table.spacing_m)
    for change in table.change:
        yield ValidityClaim(kind="change", name=change.key, unit="", claimed=change.range)
