"""Choice between a single run and a study: by the tables of the case and by the kind of the system."""

from dataclasses import dataclass
from typing import Literal

import pytest

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.execution.study_dispatch import ONLY_BUILTIN, run_study
from pantocheck.conformance.runs.system import Outcome, Skipped

STUDIES = {
    "vovan2015/mass-drop/stand-in": "mass_drop_study.run_mass_drop_study",
    "vovan2015/release-velocity": "release_velocity.run_release_velocity",
    "vovan2015/dropper-damping": "dropper_coefficient.run_dropper_damping",
    "vovan2015/dropper-oscillation": "dropper_coefficient.run_dropper_oscillation",
    "vovan2015/steady-arm-damper": "steady_arm_damper.run_steady_arm_damper",
}
"""Studies that need the reference simulator: module and function by case."""


@dataclass(frozen=True)
class SingleRun:
    """System whose run of a case is skipped with its own reason."""

    kind: Literal["builtin", "command"]
    name: str = "single run"
    version: str = "1"

    def run(self, case: Case) -> Outcome:
        return Skipped(f"single run of {case.id}")


@pytest.mark.parametrize("name", STUDIES)
def test_reference_simulator_runs_the_study_of_the_case(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    for study in STUDIES.values():
        function = f"pantocheck.conformance.studies.vovan2015.{study}"
        monkeypatch.setattr(function, lambda case, *_, study=study: Skipped(study))
    (case,) = select_cases([name])
    assert run_study(case, SingleRun("builtin")) == Skipped(STUDIES[name])


@pytest.mark.parametrize("name", [name for name in STUDIES if "mass-drop" not in name])
def test_other_systems_skip_studies_of_the_reference_simulator(name: str) -> None:
    (case,) = select_cases([name])
    assert run_study(case, SingleRun("command")) == Skipped(ONLY_BUILTIN)


@pytest.mark.parametrize(
    ("name", "kind"),
    [
        ("vovan2015/mass-drop/stand-in", "command"),
        ("en50318-2002/250", "command"),
        ("en50318-2002/250", "builtin"),
    ],
)
def test_case_without_a_study_is_run_once(name: str, kind: Literal["builtin", "command"]) -> None:
    (case,) = select_cases([name])
    assert run_study(case, SingleRun(kind)) == Skipped(f"single run of {case.id}")
