"""Case in the `run` message of a program: all numbers, without limits."""

from typing import Any, cast

from pantocheck.conformance.cases.case import Case, drop_keys
from pantocheck.conformance.cases.case_features import list_case_features
from pantocheck.conformance.cases.force_law import AppliedForceLaw
from pantocheck.conformance.cases.lift_force import AppliedForces
from pantocheck.conformance.input_files.sourced_table import PROVENANCE
from pantocheck.conformance.simulation.derived_values import build_derived
from pantocheck.conformance.systems.command.protocol_messages import RequestedAppliedForces


def build_case_message(case: Case) -> dict[str, Any]:
    """Build the case of a `run` message, see `protocol_messages.RequestedCase`.

    Notes and sources are left out, because they mention results.

    Raises:
        SimulationError: The line has no equilibrium at rest or at the start.
    """
    file = case.file
    content: dict[str, Any] = {
        "id": case.id,
        "case_digest": case.digest,
        "title": file.title,
        "features": list_case_features(case),
        "speed_km_h": file.speed_km_h,
        "evaluated_m": list(case.analysis_section),
        "filter": file.filter.model_dump(mode="json"),
        "discretisation": file.discretisation.model_dump(mode="json"),
        "line": case.line.model_dump(mode="json"),
        "pantographs": [
            {
                **model.model_dump(mode="json", exclude={"title", "force_law"}),
                "uplift_force_N": lift.stated_uplift_force,
                "target_mean_force_N": lift.target_mean_force,
                **_applied_forces(case, number),
                "start_m": start,
                "end_m": end,
            }
            for number, (lift, model, start, end) in enumerate(
                zip(case.lift_forces, case.pantographs, case.start_positions, case.end_positions, strict=True), 1
            )
        ],
        "derived": build_derived(case).model_dump(mode="json"),
    }
    return cast(dict[str, Any], drop_keys(content, PROVENANCE))


def _applied_forces(case: Case, number: int) -> dict[str, Any]:
    """Key `applied_forces` of a pantograph whose force law gives them, or no key."""
    lift, law = case.law_forces.get(number), case.pantographs[number - 1].force_law
    if not (isinstance(lift, AppliedForces) and isinstance(law, AppliedForceLaw)):
        return {}
    forces = RequestedAppliedForces(
        static_force_N=lift.static_force,
        aerodynamic_force_N=lift.aerodynamic_force,
        aerodynamic_force_on=law.aerodynamic_force.on,
    )
    return {"applied_forces": forces.model_dump(mode="json")}
