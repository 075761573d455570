"""Check of an adapter: each gap and each fault is named with the next step."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pytest

from helpers.command_line import pantocheck
from pantocheck.conformance.app.self_test.adapter_check import (
    AdapterCheck,
    AdapterFinding,
    build_case_at_rest,
    build_short_case,
    build_twin_case,
    check_adapter,
)
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.sidecar_tables import RunTable, StartTable
from pantocheck.conformance.runs.reference_simulator import ReferenceSimulator
from pantocheck.conformance.runs.system import Delivered, Errored, Outcome, Skipped


@dataclass(frozen=True)
class Adapter:
    """Adapter that delivers a prepared outcome for the short case, and refuses others unless they are prepared too."""

    outcome: Outcome
    others: Mapping[str, Outcome] = field(default_factory=dict)
    name: str = "adapter"
    version: str = "1"
    kind: Literal["command"] = "command"

    def run(self, case: Case) -> Outcome:
        return self.outcome if case.id == "check-adapter/short" else self.others.get(case.id, Skipped("no solver"))


@pytest.fixture(scope="module")
def delivered() -> Delivered:
    """Complete delivery of the short case."""
    case = build_short_case()
    return replace(ReferenceSimulator().run_unrefined(case), case_digest=case.digest)


@pytest.fixture(scope="module")
def twin() -> Delivered:
    """Complete delivery of the short case with two pantographs."""
    case = build_twin_case()
    return replace(ReferenceSimulator().run_unrefined(case), case_digest=case.digest)


def change_record(**changes: Any) -> Callable[[Delivered], Outcome]:
    """Replace channels of the record; a function changes the channel itself."""

    def change(delivered: Delivered) -> Outcome:
        record = delivered.record
        assert record is not None
        values = {key: new(getattr(record, key)) if callable(new) else new for key, new in changes.items()}
        return replace(delivered, record=replace(record, **values))

    return change


def keep_first_support(delivered: Delivered) -> Outcome:
    record = delivered.record
    assert isinstance(record, Record)
    assert record.support_position is not None
    assert record.support_uplift is not None
    kept = {"support_position": record.support_position[:1], "support_uplift": record.support_uplift[:1]}
    return replace(delivered, record=replace(record, **kept))


OTHER_START = StartTable(place_m=60.0, ramp_m=30.0, state="line_at_rest")

GAPS: dict[str, tuple[Callable[[Delivered], Outcome], str, str, str]] = {
    "start": (lambda d: replace(d, start=None), "missing", "start", ". State place_m, ramp_m and state"),
    "digest": (lambda d: replace(d, case_digest=None), "missing", "case digest", "Copy it from the case"),
    "height": (change_record(contact_height=None), "missing", "channels", "contact_height_range_mm are skipped"),
    "uplift": (
        change_record(support_position=None, support_uplift=None),
        "missing", "channels", "max_uplift_at_support_mm are skipped",
    ),
    "one support": (keep_first_support, "missing", "channels", "max_uplift_at_support_mm are skipped"),
    "filtered force": (change_record(filter_applied_Hz=20.0), "missing", "channels", "rms_20_50_N"),
    "force in kN": (change_record(force=lambda f: f / 1e3), "wrong", "units", "mean_force_N is 0.001 times"),
    "uplift in mm": (
        change_record(support_uplift=lambda u: 1e3 * u), "wrong", "units", "max_uplift_at_support_mm is 1000 times",
    ),
    "height in cm": (
        change_record(contact_height=lambda h: 100 * h), "wrong", "units", "contact_height_range_mm is 100 times",
    ),
    "height above the rail": (
        change_record(contact_height=lambda h: h + 5.3),
        "note", "height", "begins at 5.332 m, the case starts with 0.0296 m",
    ),
    "position from the start": (
        change_record(position=lambda x: x - 60), "wrong", "position",
        "the first sample of the last pantograph is at 0.06944 m, but [start] states 60 m",
    ),
    "force of another run": (change_record(force=lambda f: f[:, ::-1]), "wrong", "record", "contradicted: "),
    "other start": (lambda d: replace(d, start=OTHER_START), "note", "start", "its ramp is 30 m long"),
    "run": (lambda d: replace(d, run=RunTable()), "note", "run", "no dt_s and element_m in [run]"),
    "no record": (lambda d: replace(d, record=None), "missing", "record", "'delivered' without a record"),
    "skipped": (lambda _: Skipped("no droppers"), "missing", "short case", "no droppers"),
    "failed": (lambda _: Errored("diverged"), "wrong", "short case", "diverged"),
    "another speed": (change_record(speed=50.0), "wrong", "record", "50"),
}  # fmt: skip


@pytest.mark.parametrize("name", GAPS)
def test_gaps_are_named(delivered: Delivered, name: str) -> None:
    change, state, subject, text = GAPS[name]
    check = check_adapter(Adapter(change(delivered)))
    found = [finding for finding in check.findings if (finding.state, finding.subject) == (state, subject)]
    assert any(text in finding.text for finding in found), check.findings
    assert check.passed == (state == "note")


def test_complete_delivery(delivered: Delivered, twin: Delivered) -> None:
    """The reference simulator itself passes, and equals itself in every compared value."""
    at_rest = ReferenceSimulator().run_unrefined(build_case_at_rest())
    check = check_adapter(Adapter(delivered, {"check-adapter/twin": twin, "check-adapter/at-rest": at_rest}))
    assert check.passed
    assert {finding.state for finding in check.findings} == {"ok"}
    assert len(check.values) == 5
    assert all(value.difference == 0 for value in check.values)


def find(adapter: Adapter, subject: str) -> AdapterFinding:
    """The only finding on a subject; its state decides whether the adapter passes."""
    check = check_adapter(adapter)
    (found,) = (finding for finding in check.findings if finding.subject == subject)
    assert check.passed == (found.state in ("ok", "note"))
    return found


@pytest.mark.parametrize(
    ("answer", "state", "text"),
    [
        (Delivered(static={"wave_speed_m_s": 121.7}), "ok", "values were delivered: wave_speed_m_s."),
        (Skipped("no statics"), "note", "refused: no statics. Checks of the line at rest are skipped."),
        (Errored("TypeError: 'NoneType'"), "wrong", "error: TypeError: 'NoneType'. In this message, speed_km_h and"),
        (Delivered(), "missing", "'delivered' without a value"),
        (
            Delivered(static={"dropper_length_m[1]": 1.0}),
            "wrong", "unknown quantity 'dropper_length_m[1]'; give the list 'dropper_length_m'",
        ),
        (Delivered(static={"beauty[1]": 1.0}), "wrong", "unknown quantity 'beauty[1]'."),
    ],
)  # fmt: skip
def test_answer_to_the_line_at_rest(delivered: Delivered, answer: Outcome, state: str, text: str) -> None:
    """A crash here would keep cases that require a static case from being run; a refusal would not."""
    found = find(Adapter(delivered, {"check-adapter/at-rest": answer}), "line at rest")
    assert (found.state, text in found.text) == (state, True), found


def keep_first_pantograph(twin: Delivered) -> Outcome:
    """Record of an adapter that writes the first pantograph only."""
    record = twin.record
    assert isinstance(record, Record)
    assert record.contact_height is not None
    kept = {key: getattr(record, key)[:1] for key in ("position", "force", "contact_height")}
    return replace(twin, record=replace(record, **kept))


TWINS: dict[str, tuple[Callable[[Delivered], Outcome], str, str]] = {
    "both": (lambda twin: twin, "ok", "a record of both pantographs"),
    "first only": (keep_first_pantograph, "wrong", "the record has 1 pantograph, the case has 2. Write position"),
    "refused": (lambda _: Skipped("one only"), "note", "refused: one only. Cases with several pantographs are"),
    "error": (lambda _: Errored("diverged"), "wrong", "error: diverged. Answer with a record of all pantographs"),
    "no record": (lambda twin: replace(twin, record=None), "missing", "without a record"),
    "equal forces": (
        change_record(force=lambda force: force[[0, 0]]), "wrong", "the record is contradicted: pantograph 2",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", TWINS)
def test_answer_to_two_pantographs(delivered: Delivered, twin: Delivered, name: str) -> None:
    change, state, text = TWINS[name]
    found = find(Adapter(delivered, {"check-adapter/twin": change(twin)}), "two pantographs")
    assert (found.state, text in found.text) == (state, True), found


def test_errors_end_the_check_and_other_values_are_a_note(delivered: Delivered) -> None:
    """An adapter that fails on the short case is corrected first; one that refuses it receives the others too."""
    assert [finding.subject for finding in check_adapter(Adapter(Errored("diverged"))).findings] == ["short case"]
    subjects = [finding.subject for finding in check_adapter(Adapter(Skipped("tuned only"))).findings]
    assert subjects == ["short case", "line at rest", "two pantographs"]
    # A value far from the reference simulator is no fault of an adapter.
    larger = change_record(force=lambda f: f + 40 * np.sin(2 * np.pi * 40 * np.arange(f.size) / 1000))
    check: AdapterCheck = check_adapter(Adapter(larger(delivered)))
    assert any("rms_20_50_N" in finding.text for finding in check.findings if finding.subject == "values")


def test_command_names_a_program_that_does_not_answer(tmp_path: Path) -> None:
    (tmp_path / "silent.py").write_text("print('hello')")
    result = pantocheck("system", "check", f"python3 {tmp_path / 'silent.py'}")
    assert result.exit_code == 1
    assert "its answer is not JSON: 'hello'" in " ".join(result.stdout.split())
    missing = pantocheck("system", "check", "no-such-program")
    assert missing.exit_code == 2
