"""Features of a case: the parts of its line, pantographs and run that a simulator must not neglect."""

from collections.abc import Callable, Collection

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.lift_force import AppliedForces
from pantocheck.conformance.input_files.documentation_pages import DocumentationPage
from pantocheck.conformance.input_files.features import list_features

RUN_FEATURES: dict[str, Callable[[Case], bool]] = {
    "applied_forces": lambda case: any(isinstance(force, AppliedForces) for force in case.law_forces.values()),
    "line_at_rest": lambda case: case.is_static,
    "mass_drop": lambda case: case.file.mass_drop is not None,
    "several_pantographs": lambda case: len(case.pantographs) > 1,
    "uplift_force_tuning": lambda case: any(force.target_mean_force is not None for force in case.lift_forces),
}
"""Features of the run of a case, and whether a case uses them."""


def list_case_features(case: Case) -> list[str]:
    """Features that a case uses, in alphabetic order: of its line, its pantographs and its run."""
    features = {name for table in (case.line, *case.pantographs) for name in list_features(table)}
    return sorted(features | {name for name, is_used in RUN_FEATURES.items() if is_used(case)})


def find_missing_features(case: Case, simulated: Collection[str] | None) -> str | None:
    """Reason to skip a case because a simulator neglects a feature of it; None if it simulates all of them.

    Args:
        case: Case to be simulated.
        simulated: Features that the simulator states; None: it states none.
    """
    if simulated is None:
        return f"the system does not list the features that it simulates, see {DocumentationPage.SYSTEMS}"
    missing = [name for name in list_case_features(case) if name not in simulated]
    return f"the system does not simulate {', '.join(missing)}" if missing else None
