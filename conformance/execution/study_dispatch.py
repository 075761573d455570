"""Choice between a single run of a case and its study. A study is imported only when it runs."""

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.study_tables import (
    DampingChange,
    DampingSensitivity,
    DropperDamping,
    DropperOscillation,
    ReleaseVelocity,
    SteadyArmDamper,
)
from pantocheck.conformance.runs.system import Outcome, Skipped, System

ONLY_BUILTIN = "only the reference simulator can run this study"


def run_study(case: Case, system: System) -> Outcome:
    """Run a case on a system: a single run, a study with all its runs, or a mass drop with its identification.

    Any system can run the studies of changed damping. The others need the reference simulator.
    """
    match case.file.study:
        case None if case.file.mass_drop is None or system.kind != "builtin":
            return system.run(case)
        case DampingChange() as study:
            from pantocheck.conformance.studies.vovan2015.damping_change import run_damping_change

            return run_damping_change(case, study, system)
        case DampingSensitivity():
            from pantocheck.conformance.studies.damping_sensitivity import run_damping_sensitivity

            return run_damping_sensitivity(case, system)
        case _ if system.kind != "builtin":
            return Skipped(ONLY_BUILTIN)
        case _ if case.fmus:
            return Skipped("this study runs no FMU")
        case None:
            from pantocheck.conformance.studies.vovan2015.mass_drop_study import run_mass_drop_study

            return run_mass_drop_study(case)
        case ReleaseVelocity() as study:
            from pantocheck.conformance.studies.vovan2015.release_velocity import run_release_velocity

            return run_release_velocity(case, study)
        case DropperDamping() as study:
            from pantocheck.conformance.studies.vovan2015.dropper_coefficient import run_dropper_damping

            return run_dropper_damping(case, study)
        case DropperOscillation() as study:
            from pantocheck.conformance.studies.vovan2015.dropper_coefficient import run_dropper_oscillation

            return run_dropper_oscillation(case, study)
        case SteadyArmDamper() as study:
            from pantocheck.conformance.studies.vovan2015.steady_arm_damper import run_steady_arm_damper

            return run_steady_arm_damper(case, study)
