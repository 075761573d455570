"""Case in the `run` message of a program: all numbers, without limits."""

from typing import Any, cast

from pantocheck.conformance.cases.case import Case, drop_keys
from pantocheck.conformance.input_files.sourced_table import PROVENANCE
from pantocheck.conformance.simulation.derived_values import build_derived


def build_case_message(case: Case) -> dict[str, Any]:
    """Build the case of a `run` message, see `protocol_messages.RequestedCase`.

    Notes and sources are left out, because they mention results.

    Raises
    ------
    SimulationError
        The line has no equilibrium at rest or at the start.
    """
    file = case.file
    content: dict[str, Any] = {
        "id": case.id,
        "case_digest": case.digest,
        "title": file.title,
        "speed_km_h": file.speed_km_h,
        "evaluated_m": list(case.analysis_section),
        "filter": file.filter.model_dump(mode="json"),
        "discretisation": file.discretisation.model_dump(mode="json"),
        "line": case.line.model_dump(mode="json"),
        "pantographs": [
            {
                **model.model_dump(mode="json", exclude={"title"}),
                "uplift_force_N": use.uplift_force_N,
                "target_mean_force_N": use.target_mean_force_N,
                "start_m": start,
                "end_m": end,
            }
            for use, model, start, end in zip(
                file.pantograph, case.pantographs, case.start_positions, case.end_positions, strict=True
            )
        ],
        "derived": build_derived(case).model_dump(mode="json"),
    }
    return cast(dict[str, Any], drop_keys(content, PROVENANCE))
