"""Runner: verdicts of cases and suite, isolation of failures, reproducible results."""

import json
import multiprocessing
import re
import sys
import time
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

import jsonschema
import numpy as np
import pytest
from numpy.testing import assert_allclose

from helpers.dying_system import Dying
from helpers.waiting_system import Waiting
from helpers.wave_system import Wave
from pantocheck.conformance.app.schemas import build_schema
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import select_cases, source_text
from pantocheck.conformance.cases.limits import Limit
from pantocheck.conformance.core.trust import Trust
from pantocheck.conformance.execution import runner
from pantocheck.conformance.execution.runner import RunInterrupted, run_cases
from pantocheck.conformance.grading.criterion_grading import criterion_name
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.record_writing import write_record
from pantocheck.conformance.results.results_format import CaseResult, Results
from pantocheck.conformance.runs.record_folder import RecordFolder, open_record_folder
from pantocheck.conformance.runs.system import Delivered, Errored, Outcome, Skipped


@dataclass(frozen=True)
class Scripted:
    """System that delivers the scripted outcome of each case, or raises the scripted exception."""

    script: dict[str, Outcome | BaseException]
    name: str = "scripted"
    version: str = "1"
    kind: Literal["builtin"] = "builtin"

    def run(self, case: Case) -> Outcome:
        step = self.script[case.id]
        if isinstance(step, BaseException):
            raise step
        return step


def limited(case: Case, *bounds: tuple[str, float | None, float | None], trust: Trust = "secondary") -> Case:
    """Case with the given limits only, each as (quantity, lower, upper)."""
    limits = tuple(
        Limit(quantity=name, lower=lower, upper=upper, trust=trust, source="test") for name, lower, upper in bounds
    )
    return replace(case, limits=limits)


def test_results_follow_their_schema_and_are_reproducible(cases: list[Case], wave: type[Wave]) -> None:
    results = run_cases(cases, wave())
    content = json.loads(results.to_json())
    jsonschema.validate(content, build_schema("results"))
    assert content["schema"] == "pantocheck.results/1"
    assert content["verdict"] == "fail"
    first = content["cases"][0]
    assert first["id"] == "en50318-2002/250"
    by_name = {item["quantity"]: item for item in first["criteria"]}
    assert len(by_name) == 8
    deviation = by_name["std_force_N"]
    # One period a span, 1.2 Hz, passes the filter unchanged to (1.2 / 20)^6.
    assert_allclose(deviation["value"], 28.0, rtol=1e-6)
    assert_allclose(deviation["margin"], 0.8, rtol=1e-5)
    assert_allclose(deviation["discretisation_error"], 0.28, rtol=1e-4)
    assert deviation["verdict"] == "pass"
    assert deviation["source"].startswith("Wang, Liu")
    assert by_name["max_force_N"]["verdict"] == "fail"
    assert by_name["max_force_N"]["reason"] == "16.4 N below the lower limit"
    assert by_name["max_uplift_at_support_mm"]["pantograph"] == 0
    # The nearest sample to a support is within half a step of 69 mm at a bump of 5 m.
    assert_allclose(first["quantities"]["0"]["max_uplift_at_support_mm"], 50.0, rtol=1e-4)
    facts = first["run"]
    assert (facts["dt_s"], facts["element_m"], facts["speed_km_h"], facts["rate_Hz"]) == (0.001, 0.5, 250.0, 1000.0)
    assert facts["filter"] == {"kind": "butterworth", "order": 6, "cutoff_Hz": 20.0, "phase": "zero"}
    assert facts["evaluated_m"] == [240.0, 360.0]
    trace = first["traces"]["1"]
    assert len(trace["position_m"]) == len(trace["force_N"]) == len(trace["force_20_N"]) <= 1500
    assert trace["supports_m"] == [240.0, 300.0, 360.0]
    assert max(trace["spectrum"]["frequency_Hz"]) <= 50
    assert [item["support_m"] for item in first["uplift"]] == [240.0, 300.0, 360.0]
    trust = {item["group"]: (item["trust"], item["source"]) for item in first["inputs"]}
    assert trust["case.evaluated_spans"] == ("provisional", source_text("untraced"))
    assert Results.model_validate(content).to_json() == results.to_json()
    first, second = (re.sub(rb'"started": "[^"]*"', b"", run_cases(cases, wave()).to_json()) for _ in "ab")
    assert first == second


def test_verdicts_of_cases(case_250: Case, wave: type[Wave]) -> None:
    inside, outside = ("mean_force_N", 110.0, 120.0), ("std_force_N", 40.0, 50.0)
    by_verdict = {
        "pass": limited(case_250, inside),
        "fail": limited(case_250, inside, outside),
        "info": limited(case_250, outside, trust="provisional"),
        "skip": limited(case_250, inside, ("elasticity_mm_N", None, 0.5)),
    }
    for verdict, case in by_verdict.items():
        results = run_cases([case], wave())
        assert (results.cases[0].verdict, results.verdict) == (verdict, verdict)
    assert run_cases([limited(case_250)], wave()).verdict == "info"


def test_provisional_limit_counts_only_on_request(case_250: Case, wave: type[Wave]) -> None:
    case = limited(case_250, ("std_force_N", 40.0, 50.0), trust="provisional")
    (criterion,) = run_cases([case], wave()).cases[0].criteria
    assert criterion.verdict == "info"
    assert criterion.reason == "would fail: 12 N below the lower limit; the limit is provisional and does not count"
    assert run_cases([case], wave(), trust="provisional").verdict == "fail"
    assert run_cases([limited(case_250, ("std_force_N", 40.0, 50.0))], wave(), trust="primary").verdict == "info"


def test_exception_in_one_case_leaves_the_others(cases: list[Case], wave: type[Wave], case_250: Case) -> None:
    good = Delivered(wave().record(cases[1]))
    results = run_cases(cases, Scripted({cases[0].id: ZeroDivisionError("no mass\n at all"), cases[1].id: good}))
    assert [case.verdict for case in results.cases] == ["error", "fail"]
    assert results.cases[0].reason == "ZeroDivisionError: no mass at all"
    assert results.verdict == "error"
    jsonschema.validate(json.loads(results.to_json()), build_schema("results"))
    for length in (0, 299, 300, 301, 5000):
        (result,) = run_cases([case_250], Scripted({case_250.id: ValueError("x" * length)})).cases
        text = "x" * min(length, 300)
        assert (result.verdict, result.reason) == ("error", f"ValueError: {text}" if text else "ValueError")


def test_skipped_errored_and_foreign_outcomes(cases: list[Case], wave: type[Wave]) -> None:
    case = cases[0]
    for outcome, verdict, reason in (
        (Skipped("no stitch wires"), "skip", "no stitch wires"),
        (Errored("diverged at 1.2 s"), "error", "diverged at 1.2 s"),
        (Delivered(), "error", "delivered no record"),
        (Delivered(wave().record(cases[1])), "error", "made at 300 km/h, the case runs at 250 km/h"),
        (Delivered(replace(wave().record(case), evaluated=(180.0, 300.0))), "error", "evaluates 180 m to 300 m"),
        (Delivered(wave().record(case), {"beauty": 1.0}), "error", "unknown quantity 'beauty'"),
        (Delivered(wave().record(case), {"max_uplift_at_support_mm": 52.0}), "error", "is computed from the record"),
    ):
        (result,) = run_cases([case], Scripted({case.id: outcome})).cases
        assert result.verdict == verdict
        assert reason in (result.reason or "")


def cut_record(record: Record, n: int) -> Record:
    """First samples of a record, without its contact height."""
    return replace(
        record, time=record.time[:n], position=record.position[:, :n], force=record.force[:, :n],
        contact_height=None, support_uplift=record.support_uplift[:, :n],
    )  # fmt: skip


def test_record_that_is_cut_short_gives_an_error_or_a_warning(case_250: Case, wave: type[Wave]) -> None:
    cut = cut_record(wave().record(case_250), int(250 / case_250.speed * 1000))
    (result,) = run_cases([case_250], Scripted({case_250.id: Delivered(cut)})).cases
    assert result.verdict == "error"
    assert not result.quantities  # the uplift, too, needs the record behind the last support
    assert not result.criteria
    assert result.reason == (
        "the record of pantograph 1 is cut short: the record covers 60 m to 309.931 m, "
        "but the analysis section extends from 240 m to 360 m"
    )
    record = wave().record(case_250)
    cut = cut_record(record, int(np.searchsorted(record.position[0], 362.0)))
    (result,) = run_cases([case_250], Scripted({case_250.id: Delivered(cut)})).cases
    assert any("transients of the filter" in warning for warning in result.warnings)
    assert not any("transients of the filter" in warning for warning in run_cases([case_250], wave()).cases[0].warnings)


def test_value_closer_to_a_limit_than_its_uncertainty_is_marked(case_250: Case, wave: type[Wave]) -> None:
    """The standard deviation is 28 N and changes by 0.28 N on a second mesh: half-width 0.84 N, three times as much."""
    # The shifted sections contain whole periods of the wave and add nothing. The remark is in one place only.
    for upper, marked in ((28.8, True), (28.9, False)):
        (result,) = run_cases([limited(case_250, ("std_force_N", None, upper))], wave()).cases
        assert result.verdict == "pass"
        assert any("mostly discretisation" in remark for remark in result.criteria[0].close) == marked
        assert not any("mostly discretisation" in warning for warning in result.warnings)


def test_list_valued_static_quantity_is_graded_item_by_item(case_250: Case, wave: type[Wave]) -> None:
    lengths = (1.017, 0.896, 0.81)
    limits = tuple(
        Limit(quantity="dropper_length_m", item=i, lower=x - 0.001, upper=x + 0.001, trust="secondary", source="test")
        for i, x in enumerate((1.017, 0.9, 0.81, 0.7), 1)
    )
    outcome = Delivered(wave().record(case_250), {"dropper_length_m": lengths})
    (result,) = run_cases([replace(case_250, limits=limits)], Scripted({case_250.id: outcome})).cases
    assert [item.verdict for item in result.criteria] == ["pass", "fail", "pass", "skip"]
    assert result.quantities["0"]["dropper_length_m"] == list(lengths)


def test_unknown_quantity_of_a_line_at_rest_is_an_error() -> None:
    """If it were ignored, a case with a misspelt name would be skipped for lack of values."""
    (case,) = select_cases(["en50318-2018/ac-simple/static"])
    (result,) = run_cases([case], Scripted({case.id: Delivered(static={"dropper_lenght_m": (1.0,)})})).cases
    assert (result.verdict, result.reason) == ("error", "the system delivered an unknown quantity 'dropper_lenght_m'")


def test_item_of_the_line_close_to_its_limit_is_marked(case_250: Case, wave: type[Wave]) -> None:
    """A dropper 0.4 mm from its limit with a discretisation error of 1 mm; the criterion names dropper and owner."""
    limit = Limit(quantity="dropper_length_m", item=2, lower=0.8956, upper=1.0, trust="secondary", source="test")
    outcome = Delivered(
        wave().record(case_250),
        {"dropper_length_m": (1.017, 0.896)},
        refined=Delivered(wave().record(case_250), {"dropper_length_m": (1.017, 0.897)}),
    )
    (result,) = run_cases([replace(case_250, limits=(limit,))], Scripted({case_250.id: outcome})).cases
    (criterion,) = result.criteria
    assert criterion_name(criterion) == "dropper_length_m[2] of the line"
    assert [remark.split(",")[0] for remark in criterion.close] == ["lies 0.0004 m from a limit"]


def test_case_is_skipped_if_a_required_case_failed_or_was_not_run(cases: list[Case], wave: type[Wave]) -> None:
    first = limited(cases[0], ("mean_force_N", 0.0, 1.0))
    second = replace(cases[1], file=cases[1].file.model_copy(update={"requires": (first.id,)}))
    results = run_cases([second, first], wave())
    assert [case.verdict for case in results.cases] == ["skip", "fail"]
    assert results.cases[0].reason == f"requires {first.id}, whose verdict is fail"
    passing = run_cases([second, limited(cases[0], ("mean_force_N", 110.0, 120.0))], wave())
    assert passing.cases[0].criteria
    assert run_cases([second], wave()).cases[0].reason == f"requires {first.id}, which was not run"


def test_interrupted_run_keeps_the_finished_cases(cases: list[Case], wave: type[Wave]) -> None:
    system = Scripted({cases[0].id: Delivered(wave().record(cases[0])), cases[1].id: KeyboardInterrupt()})
    seen = []
    with pytest.raises(RunInterrupted) as caught:
        run_cases(cases, system, progress=lambda result: seen.append(result.id))
    results = caught.value.results
    assert seen == [cases[0].id]
    assert len(results.cases[0].criteria) == 8
    reason = "the run was interrupted before this case was finished"
    assert (results.cases[1].verdict, results.cases[1].reason) == ("skip", reason)
    jsonschema.validate(json.loads(results.to_json()), build_schema("results"))


@pytest.fixture
def recorded(cases: list[Case], wave: type[Wave], tmp_path: Path) -> RecordFolder:
    for case in cases:
        path = tmp_path / f"{case.file.speed_km_h:g}.csv"
        write_record(path, wave().record(case), case.id, {"name": "w", "version": "2"})
    return open_record_folder(tmp_path)


def test_parallel_run_gives_the_same_results_and_skips_circles(
    cases: list[Case], recorded: RecordFolder, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(runner, "announce_compilation", lambda: pytest.fail("records need no kernel"))
    after = replace(cases[0], file=cases[0].file.model_copy(update={"id": "after", "requires": (cases[1].id,)}))
    ordered = [after, *cases]
    sequential, parallel = run_cases(ordered, recorded), run_cases(ordered, recorded, jobs=2)
    assert parallel.model_copy(update={"started": None}) == sequential.model_copy(update={"started": None})
    assert sequential.cases[0].reason == f"requires {cases[1].id}, whose verdict is fail"
    assert sequential.system.name == "w"
    loop = [
        replace(case, file=case.file.model_copy(update={"requires": (other.id,)}))
        for case, other in zip(cases, cases[::-1], strict=True)
    ]
    for jobs in (1, 2):
        assert [case.verdict for case in run_cases(loop, recorded, jobs=jobs).cases] == ["skip", "skip"]


@pytest.mark.skipif(sys.platform != "linux", reason="signals as on Linux")
def test_interrupted_parallel_run_ends_every_worker(
    cases: list[Case], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A worker ends its case after a signal; one that ignores the signal is killed after the grace."""
    monkeypatch.setattr("pantocheck.conformance.core.processes.GRACE", 1.0)
    # Both waiting cases would run for a minute. A start of three interpreters and the end of the pool take seconds.
    waiting = [replace(cases[1], file=cases[1].file.model_copy(update={"id": f"own/{name}"})) for name in "ab"]
    system = Waiting(tmp_path, cases[0].id, len(waiting), deaf="own/b")
    interrupted = []

    def interrupt(result: CaseResult) -> None:
        interrupted.append(time.monotonic())
        raise KeyboardInterrupt

    with pytest.raises(RunInterrupted) as caught:
        run_cases([cases[0], *waiting], system, jobs=3, progress=interrupt)
    assert time.monotonic() - interrupted[0] < 30
    assert multiprocessing.active_children() == []
    assert [path.name for path in tmp_path.glob("ended-*")] == ["ended-own-a"]
    reason = "the run was interrupted before this case was finished"
    assert [case.reason for case in caught.value.results.cases] == ["all have begun", reason, reason]


LOST = ("error", "the process of this case, or of a parallel case, ended unexpectedly")


def named(case: Case, name: str, *required: str) -> Case:
    return replace(case, file=case.file.model_copy(update={"id": name, "requires": required}))


def test_death_of_the_processes_is_an_error_of_the_running_cases_only(case_250: Case, tmp_path: Path) -> None:
    """Two cases run after the first one, and both processes end. The last case runs in new processes."""
    system = Dying(tmp_path, {"a": "b", "b": "a"}, {})
    cases = [named(case_250, "first"), *(named(case_250, name, "first") for name in ("a", "b", "last"))]
    results = run_cases(cases, system, jobs=2).cases
    finished = ("skip", "finished")
    assert [(case.verdict, case.reason) for case in results] == [finished, LOST, LOST, finished]


def test_death_of_a_process_before_the_next_case_starts(case_250: Case, tmp_path: Path) -> None:
    """The process of `fatal` ends after `quick` is finished and before `last` is started, which loses nothing."""

    def end_process(result: CaseResult) -> None:
        if result.id == "quick":
            (tmp_path / "kept").touch()
            limit = time.monotonic() + 60.0
            while multiprocessing.active_children() and time.monotonic() < limit:
                time.sleep(0.02)

    system = Dying(tmp_path, {"fatal": "kept"}, {"quick": "fatal"})
    cases = [named(case_250, name) for name in ("quick", "fatal", "last")]
    results = run_cases(cases, system, jobs=2, progress=end_process).cases
    assert [(case.verdict, case.reason) for case in results] == [("skip", "finished"), LOST, ("skip", "finished")]


def test_requirements_of_requirements_come_first(cases: list[Case], wave: type[Wave]) -> None:
    """c requires b, b requires a: run in the order a, b, c, reported as given; a failure of a skips c as well as b."""

    def case(name: str, *required: str, upper: float = 300.0) -> Case:
        file = cases[0].file.model_copy(update={"id": name, "requires": required})
        return limited(replace(cases[0], file=file), ("mean_force_N", 0.0, upper))

    order: list[str] = []
    given = [case("c", "b"), case("b", "a"), case("a")]
    results = run_cases(given, wave(), progress=lambda result: order.append(result.id))
    assert order == ["a", "b", "c"]
    assert [(result.id, result.verdict) for result in results.cases] == [("c", "pass"), ("b", "pass"), ("a", "pass")]
    failed = run_cases([*given[:2], case("a", upper=1.0)], wave())
    assert [result.reason for result in failed.cases[:2]] == ["requires a, whose verdict is fail"] * 2
