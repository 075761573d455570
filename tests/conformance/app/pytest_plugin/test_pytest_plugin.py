"""pytest plugin in sessions of a user."""

import ast
import importlib
import json
import re
import subprocess
import sys
import tomllib
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from _pytest.config import _iter_rewritable_modules

from helpers.command_line import SKIPPER
from helpers.converged_fixtures import StateConverged
from helpers.criterion_fixtures import build_requirement
from helpers.fmu_fixtures import WriteFmu
from helpers.outside_cases import write_case
from helpers.toml_edit import edit_toml, write_toml
from helpers.wave_system import Wave
from pantocheck.conformance.app.pytest_plugin import collection  # noqa: F401 - once here, or anew in every session below
from pantocheck.conformance.app.pytest_plugin.user_fixtures import GradedCase, describe_unmet_criterion
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.converged_file import find_converged
from pantocheck.conformance.cases.library import load_case, select_cases
from pantocheck.conformance.grading.case_grading import grade_case
from pantocheck.conformance.grading.case_selection import BOTH
from pantocheck.conformance.grading.case_verdict import Participation
from pantocheck.conformance.grading.case_verification import build_requirements
from pantocheck.conformance.grading.criterion_grading import build_criterion
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.records.record_writing import write_record
from pantocheck.model.dynamics.active_window import search

pytest_plugins = ["pytester"]

ROOT = Path(__file__).parents[4]


@pytest.fixture(scope="module", autouse=True)
def _load_libraries() -> None:
    """Load all of numba and scipy: pytester forgets what a session loads, and numba cannot be loaded twice."""
    search(np.arange(7.0), 0, 7, 0.5)
    case = load_case(library_folder() / "en50318-2002" / "250.toml")
    grade_case(case, Wave().run(case), "secondary")


PUBLISHED = "record:en50318-2002/known-passing-code"
CODE = "published passing code (Wang et al.)"

# This plugin takes a second to load and is not needed here.
ALONE = ("-p", "no:hypothesispytest")


def session(pytester: pytest.Pytester, *arguments: str) -> pytest.RunResult:
    return pytester.runpytest_inprocess(*ALONE, *arguments)


def process(pytester: pytest.Pytester, *arguments: str) -> pytest.RunResult:
    return pytester.runpytest_subprocess(*ALONE, *arguments)


Start = Callable[..., pytest.RunResult]


@pytest.fixture
def plan(pytester: pytest.Pytester, wave: type[Wave]) -> Path:
    """Plan for records of both cases: sines, whose extremes are outside the limits."""
    pytester.path.joinpath("records").mkdir()
    for case in select_cases(["en50318-2002/*"]):
        write_record(pytester.path / "records" / f"{case.file.speed_km_h:g}.csv", wave().record(case), case.id)
    cases = ["en50318-2002/250", "en50318-2002/300"]
    content = {"cases": cases, "system": "record:records", "verdicts": "criteria", "formats": ["json", "junit"]}
    return write_toml(pytester.path / "conformance.toml", content)


def outcomes_250(verdicts: dict[str, str]) -> list[str]:
    return [f"conformance.toml::en50318-2002/250::{name} {verdict}*" for name, verdict in verdicts.items()]


def test_every_criterion_is_an_item_with_a_one_line_reason(pytester: pytest.Pytester, plan: Path) -> None:
    done = session(pytester, "-v", "conformance.toml")
    passed = dict.fromkeys(("1::mean_force_N", "1::std_force_N", "line::max_uplift_at_support_mm"), "PASSED")
    done.stdout.fnmatch_lines_random(outcomes_250(passed | {"1::max_force_N": "FAILED"}))
    failed = done.parseoutcomes()["failed"]
    assert failed + done.parseoutcomes()["passed"] == 16
    done.stdout.fnmatch_lines(
        ["max_force_N of pantograph 1 = 158.6 N, limits 175 to 210: 16.4 N below the lower limit"]
    )
    assert "Traceback" not in done.stdout.str()
    done.stdout.fnmatch_lines(
        [f"conformance.toml: FAIL: 0 of 2 cases pass, 2 fail ({failed} of 16 values outside limits*report/results.json"]
    )
    results = json.loads((pytester.path / "report" / "results.json").read_text())
    assert [case["id"] for case in results["cases"]] == ["en50318-2002/250", "en50318-2002/300"]
    assert sum(c["verdict"] == "fail" for case in results["cases"] for c in case["criteria"]) == failed
    assert sorted(path.name for path in (pytester.path / "report").iterdir()) == ["junit.xml", "results.json"]


@pytest.mark.parametrize("row", [0, 1])
def test_failure_of_one_pantograph_fails_its_items_alone(
    pytester: pytest.Pytester, edited_case: Callable[[str, dict[str, Any]], Path], wave: type[Wave], row: int
) -> None:
    """A mean of 119 N lies between 110 N and 120 N, but not below the limit of 115 N of one pantograph."""
    use = {"model": "pantograph.toml", "uplift_force_N": 120.0, "trust": "secondary", "source": "own"}
    bounds = {"mean_force_N": (110.0, 120.0), "std_force_N": (26.0, 31.0)}
    limits = [
        {"quantity": name, "pantograph": number, "lower": low, "upper": high, "trust": "secondary", "source": "own"}
        for number in (1, 2)
        for name, (low, high) in bounds.items()
    ]
    limits[2 * row]["upper"] = 115.0
    path = edited_case("250.toml", {"spacing_m": [150.0], "pantograph": [use, use], "limit": limits})
    case = load_case(path)
    write_record(pytester.path / "records" / "train.csv", wave().record(case), case.id)
    write_toml(
        pytester.path / "conformance.toml", {"cases": [str(path)], "system": "record:records", "formats": ["json"]}
    )
    done = session(pytester, "-v", "conformance.toml")
    verdicts = {f"{number}::mean_force_N": "FAILED" if number == row + 1 else "PASSED" for number in (1, 2)}
    done.stdout.fnmatch_lines_random(outcomes_250(verdicts | {"1::std_force_N": "PASSED", "2::std_force_N": "PASSED"}))
    assert (done.parseoutcomes()["failed"], done.parseoutcomes()["passed"]) == (1, 3)


def test_ids_select_items_and_options_replace_those_of_the_plan(pytester: pytest.Pytester, plan: Path) -> None:
    done = session(
        pytester,
        "conformance.toml::en50318-2002/250::1::std_force_N", "--pantocheck-out", "asked",
        "--pantocheck-formats", "json", "--pantocheck-trust", "primary",
    )  # fmt: skip
    done.assert_outcomes(skipped=1)
    done = session(pytester, "-rs", "conformance.toml", "-k", "250 and std", "--pantocheck-trust", "primary")
    done.stdout.fnmatch_lines(["SKIPPED*would pass; the limit is secondary and does not count"])
    results = json.loads((pytester.path / "asked" / "results.json").read_text())
    assert results["trust"] == "primary"
    assert results["cases"][1]["reason"] == "not run in this session of pytest"
    assert [path.name for path in (pytester.path / "asked").iterdir()] == ["results.json"]


@pytest.mark.parametrize(("start", "workers"), [(session, ()), (process, ("-n2",))])
def test_each_case_is_run_once_in_a_session(
    pytester: pytest.Pytester, plan: Path, start: Start, workers: tuple[str, ...]
) -> None:
    (pytester.path / "skipper.py").write_text(SKIPPER)
    log = pytester.path / "log"
    edit_toml(plan, {"system": f"command:{sys.executable} skipper.py {log}"})
    done = start(pytester, "-rs", "conformance.toml", *workers)
    done.assert_outcomes(skipped=16)
    done.stdout.fnmatch_lines(["SKIPPED*no such line"])
    assert sorted(log.read_text().split()) == ["en50318-2002/250", "en50318-2002/300"]
    results = json.loads((pytester.path / "report" / "results.json").read_text())
    assert (results["verdict"], results["system"]["name"]) == ("skip", "skipper")


def test_failed_case_or_missing_record_fails_its_criteria_with_the_reason(
    pytester: pytest.Pytester, plan: Path
) -> None:
    edit_toml(plan, {"system": "record:nowhere"})
    done = session(pytester, "conformance.toml")
    done.assert_outcomes(failed=16)
    done.stdout.fnmatch_lines(["system record:*nowhere: there is no such folder."])
    done.stdout.no_fnmatch_line("*raise InputError*")
    (pytester.path / "skipper.py").write_text(SKIPPER.replace("print(json.dumps(answer), flush=True)", "sys.exit(3)"))
    edit_toml(plan, {"system": f"command:{sys.executable} skipper.py log"})
    done = session(pytester, "conformance.toml")
    done.assert_outcomes(failed=16)
    done.stdout.fnmatch_lines(["error: *ended with exit code 3 before it answered"])


@pytest.mark.parametrize("case", [0, 1])
def test_drift_from_a_baseline_fails_the_session(pytester: pytest.Pytester, plan: Path, case: int) -> None:
    edit_toml(plan, {"system": PUBLISHED, "accept_unconfirmed": [CODE]})
    assert session(pytester, "conformance.toml", "--pantocheck-out", "before").ret == 0
    (pytester.path / "before" / "results.json").rename(pytester.path / "baseline.json")
    edit_toml(plan, {"baseline": "baseline.json"})
    chosen = ("conformance.toml", "-k", "mean_force")
    assert session(pytester, *chosen).ret == 0
    content = json.loads((pytester.path / "baseline.json").read_text())
    content["cases"][case]["quantities"]["1"]["std_force_N"] *= 1.05
    (pytester.path / "baseline.json").write_text(json.dumps(content))
    earlier = content["cases"][case]["quantities"]["1"]["std_force_N"]
    text = f"std_force_N of pantograph 1: drifted by -4.76 % from the baseline of {earlier:.6g} N"
    done = session(pytester, *chosen)
    done.assert_outcomes(passed=2, deselected=16)
    assert done.ret == 1
    summary = f"conformance.toml: {content['cases'][case]['id']}: {text}"
    done.stdout.fnmatch_lines(["*= pantocheck =*", summary])
    every = session(pytester, "conformance.toml", "--junitxml", "tests.xml")
    every.assert_outcomes(passed=17, failed=1)
    every.stdout.fnmatch_lines([text, summary])
    assert f'<failure message="{text}' in (pytester.path / "tests.xml").read_text()


def test_case_that_the_baseline_does_not_have_is_skipped(pytester: pytest.Pytester, plan: Path) -> None:
    edit_toml(plan, {"system": PUBLISHED, "accept_unconfirmed": [CODE], "cases": ["en50318-2002/250"]})
    session(pytester, "conformance.toml", "--pantocheck-out", "before")
    edit_toml(plan, {"baseline": "before/results.json", "cases": ["en50318-2002/*"]})
    done = session(pytester, "conformance.toml", "-rs")
    done.assert_outcomes(passed=17, skipped=1)
    done.stdout.fnmatch_lines(["SKIPPED*baseline results.json has no case en50318-2002/300"])
    assert done.ret == 1


def test_session_passes_only_with_the_verdict_pass(pytester: pytest.Pytester, plan: Path) -> None:
    """Published statistics are inside all limits, but unconfirmed: exit 0 only if the user accepts the system."""
    edit_toml(plan, {"system": PUBLISHED})
    done = session(pytester, "conformance.toml")
    done.assert_outcomes(failed=16)
    done.stdout.fnmatch_lines(["the record is unconfirmed: a summary record*"])
    edit_toml(plan, {"accept_unconfirmed": [CODE]})
    accepted = session(pytester, "conformance.toml")
    accepted.assert_outcomes(passed=16)
    assert accepted.ret == 0
    uncounted = session(pytester, "conformance.toml", "--pantocheck-trust", "primary")
    uncounted.assert_outcomes(skipped=16)
    assert uncounted.ret == 1


def test_case_for_information_does_not_fail_the_session(pytester: pytest.Pytester, plan: Path) -> None:
    edit_toml(plan, {"information": ["*/300", "*/250"]})
    done = session(pytester, "-rs", "conformance.toml")
    assert done.parseoutcomes().get("failed", 0) == 0
    done.stdout.fnmatch_lines(["SKIPPED*for information: max_force_N of pantograph 1*below the lower limit"])
    assert done.ret == 1  # no case takes part in the verdict


def test_check_fails_on_uncounted_limits_and_unconfirmed_records(pytester: pytest.Pytester, plan: Path) -> None:
    pytester.makepyfile(
        f"""
        import pytest

        def test_check(pantocheck_run):
            graded = pantocheck_run("en50318-2002/250", system="{PUBLISHED}")
            with pytest.raises(AssertionError, match="the record is unconfirmed: a summary record"):
                graded.check("std_force_N")
            graded.check("std_force_N", accept_unconfirmed=True)
            graded.check(accept_unconfirmed=True)
            assert len(graded.reasons) == 1

        def test_check_of_uncounted_limits(pantocheck_run):
            graded = pantocheck_run("en50318-2002/250", system="{PUBLISHED}", trust="primary")
            for quantities in ((), ("std_force_N",)):
                with pytest.raises(AssertionError, match="no limit counts"):
                    graded.check(*quantities, accept_unconfirmed=True)
        """
    )
    session(pytester, "--pantocheck-verdicts", "criteria").assert_outcomes(passed=2)


def test_verification_adds_a_test_for_every_converged_value(pytester: pytest.Pytester, plan: Path) -> None:
    """A sine of one wave per span has nothing in 20-50 Hz; its mean is right, and lies within the limits of both."""
    done = session(pytester, "-v", "--pantocheck-verdicts", "verification", "conformance.toml")
    text = done.stdout.str()
    assert re.search(r"::verification::1::rms_20_50_N FAILED", text)
    assert re.search(r"::verification::1::mean_force_N PASSED", text)
    tested = set(re.findall(r"::verification::(\S+) (?:PASSED|FAILED)", text))
    converged = find_converged("en50318-2002/250")
    assert converged is not None
    expected = {f"{row.pantograph or 'line'}::{row.quantity}" for row in build_requirements(converged, is_static=False)}
    assert tested == expected
    assert len(expected) == 10, "mean, standard deviation, three bands, four extremes, uplift"
    done.stdout.no_fnmatch_line("*250::1::*")
    both = session(pytester, "--co", "-q", "--pantocheck-verdicts", "both", "conformance.toml")
    both.stdout.fnmatch_lines(["*250::1::mean_force_N", "*250::verification::1::mean_force_N"])


def test_fixture_checks_both_verdicts_of_another_system(pytester: pytest.Pytester, plan: Path) -> None:
    pytester.makepyfile(
        """
        import pytest

        def test_default(pantocheck_assess):
            graded = pantocheck_assess("en50318-2002/250", "records/250.csv")
            with pytest.raises(AssertionError, match="verification of rms_20_50_N of pantograph 1 = "):
                graded.check("rms_20_50_N")

        def test_criteria(pantocheck_assess):
            pantocheck_assess("en50318-2002/250", "records/250.csv", verdicts="criteria").check("mean_force_N")

        def test_builtin(pantocheck_run):
            assert pantocheck_run("en50318-2002/250").requested == ("criteria",)
        """
    )
    session(pytester).assert_outcomes(passed=3)


@pytest.mark.parametrize("quantities", [(), ("mean_force_N",)])
def test_check_needs_the_requested_verification(
    state_converged: StateConverged, case_250: Case, quantities: tuple[str, ...]
) -> None:
    """Every criterion passes, but the converged values belong to another version of the case: its verdict is info."""
    limits = tuple(limit for limit in case_250.limits if limit.quantity == "mean_force_N")
    state_converged(case_250, {1: {"mean_force_N": 119.0}}, case_digest="sha256:0")
    result = grade_case(replace(case_250, limits=limits), Wave().run(case_250), "secondary")
    GradedCase(result, ("criteria",)).check(*quantities)
    both = GradedCase(Participation(requested=BOTH).decide_case(result), BOTH)
    assert both.verdict == "info"
    with pytest.raises(AssertionError, match="verification: info, the converged values belong to another version"):
        both.check(*quantities)
    assert len(both.reasons) == 1


def test_criteria_are_one_group_of_xdist_and_an_unnamed_plan_is_ignored(pytester: pytest.Pytester, plan: Path) -> None:
    """With `--dist loadgroup` one worker takes a case; without the plugin its mark would be unknown."""
    grouped = session(pytester, "--collect-only", "-q", "conformance.toml", "-m", "xdist_group")
    assert grouped.stdout.str().count("conformance.toml::") == 16
    alone = session(pytester, "--collect-only", "-q", "conformance.toml", "-p", "no:xdist", "-W", "error")
    assert alone.ret == 0
    assert alone.stdout.str().count("conformance.toml::") == 16
    # The plugin ignores other TOML files, too.
    pytester.makepyfile("def test_own(): pass")
    done = session(pytester)
    done.assert_outcomes(passed=1)
    assert "pantocheck" not in done.stdout.str().split("collected 1 item")[1]
    assert not (pytester.path / "report").exists()


@pytest.mark.parametrize(
    ("value", "lower", "upper", "name", "line"),
    [
        (158.6, 175.0, 210.0, "max_force_N", "max_force_N of pantograph 2 = 158.6 N, limits 175 to 210: "
         "16.4 N below the lower limit"),
        (0.35, None, 0.3, "cov_20", "cov_20 of pantograph 2 = 0.3500, limits <= 0.3: 0.05 above the upper limit"),
        (1.0, 2.0, None, "cov_20", "cov_20 of pantograph 2 = 1.000, limits >= 2: 1 below the lower limit"),
        (None, 0.0, 1.0, "cov_20", "cov_20 of pantograph 2: skip, not delivered"),
    ],
)  # fmt: skip
def test_line_of_a_criterion(
    value: float | None, lower: float | None, upper: float | None, name: str, line: str
) -> None:
    requirement, reason = build_requirement(name, lower, upper, trust="primary"), None if value else "not delivered"
    assert describe_unmet_criterion(build_criterion(requirement, value, reason, "primary")) == line


def test_invalid_plan_is_reported_with_a_hint(pytester: pytest.Pytester, plan: Path) -> None:
    for text, message in (
        ('cases = ["en50318-2002/25"]', "*there is no case with this id*"),
        ("case = 1", "*key case: unknown key*"),
        ("cases = [", "*is not valid TOML*"),
        ('formats = ["htm"]', "*format 'htm': there is no such format*"),
    ):
        plan.write_text(f'system = "builtin"\n{text}')
        done = session(pytester, "conformance.toml")
        done.assert_outcomes(errors=1)
        done.stdout.fnmatch_lines([message])
        assert "Traceback" not in done.stdout.str()


@pytest.mark.parametrize("arguments", [("conformance.toml",), (".", "conformance.toml"), ()])
def test_plan_is_collected_when_named(pytester: pytest.Pytester, plan: Path, arguments: tuple[str, ...]) -> None:
    """On the command line, also beside a folder that holds it, or in `testpaths`."""
    if not arguments:
        pytester.makeini("[pytest]\ntestpaths = conformance.toml")
    done = session(pytester, "--collect-only", "-q", *arguments)
    assert done.stdout.str().count("conformance.toml::") == 16
    assert not (pytester.path / "report" / "results.json").exists()


def test_loading_the_plugin_imports_nothing_heavy() -> None:
    code = "import sys, pantocheck.conformance.app.pytest_plugin.hooks; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    loaded = set(done.stdout.split())
    assert "pantocheck.conformance.app.pytest_plugin.hooks" in loaded
    assert not loaded & {"numpy", "scipy", "numba", "pydantic", "typer", "rich", "h5py", "matplotlib", "filelock"}
    ours = {name for name in loaded if name.startswith("pantocheck")}
    plugin = "pantocheck.conformance.app.pytest_plugin"
    packages = {"pantocheck", "pantocheck.conformance", "pantocheck.conformance.app", plugin}
    assert ours == {*packages, f"{plugin}.hooks", f"{plugin}.shared_folder"}


def test_fixtures_grade_records_and_arrays(pytester: pytest.Pytester, plan: Path) -> None:
    pytester.makepyfile(
        """
        import numpy as np
        import pytest
        from pantocheck.conformance.core.input_error import InputError

        def test_record(pantocheck_assess):
            graded = pantocheck_assess("en50318-2002/250", "records/250.csv")
            assert graded.verdict == "fail"
            assert any("max_force_N of pantograph 1" in reason for reason in graded.reasons)
            graded.check("mean_force_N", "std_force_N")
            with pytest.raises(AssertionError, match="16.4 N below the lower limit"):
                graded.check()
            with pytest.raises(AssertionError, match="rms_0_5_N has no limits"):
                graded.check("rms_0_5_N")

        def test_arrays(pantocheck_assess):
            time = np.arange(0, 5.2, 1e-3)
            position = 60 + 250 / 3.6 * time
            force = 119 + 28 * np.sqrt(2) * np.sin(2 * np.pi * position / 60)
            graded = pantocheck_assess("en50318-2002/250", time_s=time, position_m=position, force_N=force)
            assert graded.value("mean_force_N") == pytest.approx(119, abs=0.1)
            with pytest.raises(InputError, match="channel|force"):
                pantocheck_assess("en50318-2002/250", time_s=time, position_m=position, force_N=force[1:])
            with pytest.raises(InputError, match="no record"):
                pantocheck_assess("en50318-2002/250")

        def test_run(pantocheck_run):
            graded = pantocheck_run("en50318-2002/250", system="record:records")
            assert graded.result.id == "en50318-2002/250"

        def test_shown(pantocheck_run):
            pantocheck_run("en50318-2002/250", "record:records").check("max_force_N")
        """
    )
    done = session(pytester, "--pantocheck-verdicts", "criteria")
    done.assert_outcomes(passed=3, failed=1)
    done.stdout.fnmatch_lines(["E*en50318-2002/250: max_force_N of pantograph 1 = 158.6 N, limits 175 to 210: 16.4 N*"])


def test_fixtures_check_an_fmu_and_run_it(pytester: pytest.Pytester, write_fmu: WriteFmu, tmp_path: Path) -> None:
    """In long steps; a limit beside the value fails, and an FMU with an added delay is named."""
    write_fmu()
    write_fmu(fault="delay", folder="late")
    case = write_case(tmp_path / "own.toml", "own/coarse")
    edit_toml(case, {"discretisation": {"element_m": 5.0, "time_step_s": 0.01}})
    limit = {"trust": "primary", "source": "limits of this test"}
    limits = [limit | {"quantity": "mean_force_N", "lower": 50.0}, limit | {"quantity": "std_force_N", "upper": 1.0}]
    write_toml(tmp_path / "limits.toml", {"limit": limits})
    pytester.makepyfile(
        f"""
        FOLDER = "{tmp_path}"

        def test_fmu(pantocheck_pantograph, pantocheck_run):
            assert pantocheck_pantograph(f"{{FOLDER}}/fmu/model.fmu", step_s=0.01).passed
            fmu, limits = [f"{{FOLDER}}/fmu/model.fmu"], f"{{FOLDER}}/limits.toml"
            graded = pantocheck_run(f"{{FOLDER}}/own.toml", pantographs=fmu, limits=limits)
            assert graded.result.fmus[0].file == "model.fmu"
            graded.check("mean_force_N", accept_unconfirmed=True)
            graded.check("std_force_N")

        def test_late(pantocheck_pantograph):
            pantocheck_pantograph(f"{{FOLDER}}/late/model.fmu", step_s=0.01)
        """
    )
    done = session(pytester)
    done.assert_outcomes(failed=2)
    done.stdout.fnmatch_lines(["E*std_force_N of pantograph 1 = *", "E*model.fmu: run: *"])


def test_modules_of_a_user_with_names_of_our_folders_do_not_collide(pytester: pytest.Pytester, plan: Path) -> None:
    """`model.py`, `templates/` and `conformance/` beside the tests, imported by them and found first."""
    pytester.makepyfile(model="WHOSE = 'mine'", conformance="WHOSE = 'mine'")
    pytester.mkpydir("templates")
    pytester.mkpydir("reference_cases")
    pytester.makepyfile(
        """
        import conformance, model, reference_cases, templates

        def test_both(pantocheck_run):
            assert model.WHOSE == conformance.WHOSE == "mine"
            assert "pantocheck" not in templates.__file__
            from pantocheck.model import Catenary
            assert Catenary.__module__ == "pantocheck.model.description.catenary"
            assert pantocheck_run("en50318-2002/250", "record:records").verdict == "fail"
        """
    )
    edit_toml(plan, {"cases": ["en50318-2002/250"]})
    done = process(pytester, "-v", *pytester.path.glob("test_*.py"), "conformance.toml", "--pantocheck-formats=html,md")
    done.stdout.fnmatch_lines(["*::test_both PASSED*", "conformance.toml::*::mean_force_N PASSED*"])
    assert (pytester.path / "report" / "certificate.html").is_file()


def test_plans_and_fixtures_take_folders_of_cases(pytester: pytest.Pytester) -> None:
    """Cases from outside are named by id in a plan and in a test."""
    path = write_case(pytester.path / "lines" / "fast.toml", "own/acme/fast")
    write_record(pytester.path / "records" / "fast.csv", Wave().record(load_case(path)), "own/acme/fast")
    plan = {"cases": ["own/acme/fast"], "system": "record:records", "formats": ["json"]}
    write_toml(pytester.path / "conformance.toml", plan)
    pytester.makepyfile("""
        def test_mean(pantocheck_run):
            graded = pantocheck_run("own/acme/fast", "record:records")
            assert 118 < graded.value("mean_force_N") < 120  # the record has a mean of 119 N
    """)
    done = session(pytester, "conformance.toml", "test_plans_and_fixtures_take_folders_of_cases.py",
                   "--pantocheck-cases", "lines")  # fmt: skip
    assert sum(done.parseoutcomes()[word] for word in ("passed", "failed")) == 8 + 1
    assert "test_mean" not in "".join(line for line in done.outlines if "FAILED" in line)


def test_distribution_has_one_module_with_the_hooks_and_fixtures_of_the_plugin() -> None:
    """Without a top-level module, pytest would prepare `__main__` and user modules with the names of our folders."""
    # The function is private, but no public one tells which modules pytest prepares.
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    packages = [name.replace(".", "/") + "/__init__.py" for name in project["tool"]["setuptools"]["packages"][1:]]
    modules = [f"{name}.py" for name in project["tool"]["setuptools"]["py-modules"]]
    prepared = _iter_rewritable_modules([*modules, "pantocheck/__main__.py", *packages])
    assert list(prepared) == list(project["project"]["entry-points"]["pytest11"].values()) == ["pytest_pantocheck"]
    assert "__main__" in _iter_rewritable_modules(["pantocheck/__main__.py", *packages])
    plugin = importlib.import_module("pantocheck.conformance.app.pytest_plugin.hooks")
    parts = {name for name in vars(plugin) if name.startswith("pytest_")}
    parts |= {"pantocheck_assess", "pantocheck_pantograph", "pantocheck_run"}
    tree = ast.parse((ROOT / "pytest_pantocheck.py").read_text(encoding="utf-8"))
    (imported,) = (node for node in tree.body if isinstance(node, ast.ImportFrom))
    assert {alias.name for alias in imported.names} == parts
