"""Forces that the force laws of pantographs give at the speed of a case, in results.json and in words."""

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.lift_force import AppliedForces, LiftForce
from pantocheck.conformance.results.case_facts_format import AppliedForceFacts, MeanForceFacts
from pantocheck.conformance.results.results_part import Owner


def list_law_forces(case: Case) -> dict[Owner, AppliedForceFacts | MeanForceFacts]:
    """Forces of the pantographs of a case whose force law applies, by the number of the pantograph as text."""
    return {str(number): _describe_lift_force(lift) for number, lift in case.law_forces.items()}


def _describe_lift_force(lift: LiftForce) -> AppliedForceFacts | MeanForceFacts:
    if isinstance(lift, AppliedForces):
        return AppliedForceFacts(static_force_N=lift.static_force, aerodynamic_force_N=lift.aerodynamic_force)
    return MeanForceFacts(mean_force_N=lift.target_mean_force)
