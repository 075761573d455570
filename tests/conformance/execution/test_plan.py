"""Plans: reading, preparation, and the messages for wrong options."""

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import pytest

from helpers.command_line import pantocheck
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.trust import decides_verdict
from pantocheck.conformance.core.verdicts import Verdict
from pantocheck.conformance.execution.plan import Plan, prepare_plan, read_plan
from pantocheck.conformance.execution.study_dispatch import ONLY_BUILTIN, run_study
from pantocheck.conformance.grading.case_verdict import Participation
from pantocheck.conformance.runs.system import Outcome, Skipped


def test_plan_adds_its_damping_study_and_replaces_limits(tmp_path: Path) -> None:
    path = tmp_path / "conformance.toml"
    path.write_text("system = 'builtin'\ncases = ['en50318-2002/250']\ndamping_study = true\nformats = ['html']\n")
    prepared = prepare_plan(read_plan(path))
    assert [case.file.study is not None for case in prepared.cases] == [True]
    assert prepared.formats == ("json", "html")
    assert prepared.out == tmp_path / "report"
    limits = tmp_path / "limits.toml"
    limits.write_text('[[limit]]\nquantity = "mean_force_N"\nupper = 1.0\ntrust = "primary"\nsource = "own"\n')
    prepared = prepare_plan(Plan(cases=("en50318-2002/250",), limits=str(limits), out=str(tmp_path / "report")))
    assert {limit.upper for limit in prepared.cases[0].limits if limit.quantity == "mean_force_N"} == {1.0}


@pytest.mark.parametrize("text", ["", "cases = ['en50318-2002/250']\n", "jobs = 2\n"])
def test_plan_without_a_system_is_refused(tmp_path: Path, text: str) -> None:
    """Graded by default, the reference simulator would pass in place of the system that the plan forgot."""
    path = tmp_path / "conformance.toml"
    path.write_text(text)
    with pytest.raises(InputError, match=r"plan 'conformance\.toml', key system: missing"):
        read_plan(path)
    result = pantocheck("run", "--plan", str(path), "--out", str(tmp_path / "out"))
    assert (result.exit_code, (tmp_path / "out").exists()) == (2, False)


def test_required_case_without_limits_is_run_for_information_only(tmp_path: Path) -> None:
    """By default a case joins because another one requires it; named in the plan, it takes part in the verdict."""
    cases = {case.id: case for case in prepare_plan(Plan(out=str(tmp_path))).cases}
    required = {name for case in cases.values() for name in case.file.requires}
    information = prepare_plan(Plan(out=str(tmp_path))).participation.information
    without_limits = {
        name for name in required if not any(decides_verdict(i.trust, "secondary") for i in cases[name].limits)
    }
    assert set(information) == without_limits
    prepared = prepare_plan(Plan(trust="secondary"))
    counting = {case.id for case in prepared.cases if any(i.trust in ("primary", "secondary") for i in case.limits)}
    assert set(TWO) <= counting
    assert set(prepared.participation.information) == {case.id for case in prepared.cases} - counting
    added = prepare_plan(Plan(out=str(tmp_path))).added
    assert added == {name: tuple(id for id, case in cases.items() if name in case.file.requires) for name in added}
    assert set(added) == without_limits
    assert required <= set(cases)
    participation = Participation(information)
    verdicts: list[tuple[str, Verdict]] = [(name, "info" if name in without_limits else "pass") for name in cases]
    assert participation.judge_run(verdicts, "any") == "pass"
    named = Plan(cases=tuple(cases), out=str(tmp_path))
    assert prepare_plan(named).participation.information == ()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"cases": ("no-such-case",)}, "there is no case with this id"),
        ({"formats": ("htm",)}, "there is no such format"),
        ({"baseline": "no-such-file.json"}, "no-such-file.json"),
        ({"out": "/dev/null/report"}, "/dev/null"),
    ],
)
def test_wrong_option_is_reported_before_any_run(options: dict[str, object], message: str, tmp_path: Path) -> None:
    plan = Plan.model_validate({"cases": ("en50318-2002/250",), "out": str(tmp_path / "report")} | options)
    with pytest.raises(InputError, match=message):
        prepare_plan(plan).start_system()


TWO = ("en50318-2002/250", "en50318-2002/300")


@pytest.mark.parametrize(
    ("cases", "information", "listed"),
    [
        (TWO, (), ()),
        (TWO, ("*/300",), ("en50318-2002/300",)),
        (TWO, ("*/300", "*/250"), TWO),
        (TWO, ("*/300", "en50318-2002/*"), TWO),
        (("en50318-2018/ac-simple/275",), (), ()),
        (("en50318-2018/ac-simple/275",), ("*/275",), ("en50318-2018/ac-simple/275",)),
    ],
)
def test_cases_for_information_are_those_of_any_pattern(
    cases: tuple[str, ...], information: tuple[str, ...], listed: tuple[str, ...]
) -> None:
    """A case that the user names takes part in the verdict, even if none of its limits counts."""
    prepared = prepare_plan(Plan(cases=cases, information=information))
    assert prepared.participation.information == listed


@pytest.mark.parametrize("information", [("*/320",), ("*/250", "*/320"), ("*/320", "*/250")])
def test_pattern_that_matches_no_case_is_refused(information: tuple[str, ...]) -> None:
    number = information.index("*/320") + 1
    with pytest.raises(InputError, match=rf"key information\[{number}\]: no case of this run matches '\*/320'"):
        prepare_plan(Plan(cases=TWO, information=information))


def test_paths_of_a_plan_are_relative_to_its_file(tmp_path: Path) -> None:
    """Case files, records, results, baseline and limits; ids of the library stay as they are."""
    (tmp_path / "records").mkdir()
    path = tmp_path / "conformance.toml"
    path.write_text(
        'system = "record:records"\ncases = ["own.toml", "en50318-2002/250"]\nout = "certificates"\n'
        'baseline = "b.json"\nlimits = "limits.toml"\n'
    )
    plan = read_plan(path)
    assert plan.cases == (str(tmp_path / "own.toml"), "en50318-2002/250")
    assert plan.system == f"record:{tmp_path / 'records'}"
    assert [plan.out, plan.baseline, plan.limits] == [
        str(tmp_path / name) for name in ("certificates", "b.json", "limits.toml")
    ]
    path.write_text('system = "record:en50318-2002/known-passing-code"\n')
    plan = read_plan(path)
    assert (plan.system, plan.baseline, plan.limits) == ("record:en50318-2002/known-passing-code", None, None)
    assert (plan.timeout_s, plan.jobs, plan.trust) == (600.0, None, "secondary")


# Choice between a single run and a study: by the tables of the case and by the kind of the system.


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
    [("vovan2015/mass-drop/stand-in", "command"), ("en50318-2002/250", "command"), ("en50318-2002/250", "builtin")],
)
def test_case_without_a_study_is_run_once(name: str, kind: Literal["builtin", "command"]) -> None:
    (case,) = select_cases([name])
    assert run_study(case, SingleRun(kind)) == Skipped(f"single run of {case.id}")
