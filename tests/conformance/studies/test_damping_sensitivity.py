"""Damping study of a case: one column of the table per damping model."""

from contextlib import nullcontext
from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import Literal

import pytest

from helpers.wave_system import Wave
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.execution.runner import run_cases
from pantocheck.conformance.runs.system import Delivered, Outcome, Skipped, System
from pantocheck.conformance.studies import damping_sensitivity
from pantocheck.conformance.studies.damping_sensitivity import CASE_DAMPING, MODELS, add_damping_study


def damping_dependent(wave: type[Wave]) -> System:
    """System with a standard deviation of the force of 20 N plus 1e5 N/s times the stiffness coefficient."""

    @dataclass(frozen=True)
    class Damped(Wave):
        def run(self, case: Case) -> Delivered:
            stiffness = case.line.damping.contact_wire.stiffness_coefficient_s
            return Delivered(wave(sigma=20 + 1e5 * stiffness).record(case))

    return Damped()


def test_every_model_has_its_column(case_250: Case, wave: type[Wave], monkeypatch: pytest.MonkeyPatch) -> None:
    """The parts of the progress follow one another to its end."""
    parts: list[tuple[float, float]] = []
    monkeypatch.setattr(damping_sensitivity, "use_part", lambda *part: parts.append(part) or nullcontext())
    studied = add_damping_study(case_250)
    (result,) = run_cases([studied], damping_dependent(wave)).cases
    assert [0.0, *(end for _, end in parts)] == [*(start for start, _ in parts), 1.0]
    (table,) = result.tables
    assert table.columns == ["Quantity", "Pantograph or line", CASE_DAMPING, *MODELS]
    rows = {(row[0], row[1]): row[2:] for row in table.rows}
    # The case and the benchmark have 1e-4 s, the initial model 2.35e-4 s.
    updated = studied.dampings["updated"].contact_wire.stiffness_coefficient_s
    assert rows["std_force_N", "pantograph 1"] == ["30", "30", "43.5", f"{20 + 1e5 * updated:.4g}"]
    assert rows["max_uplift_at_support_mm", "line"] == ["50", "50", "50", "50"]
    assert len(result.charts) == 1


def test_uplift_is_read_over_the_run_of_the_case(case_250: Case, wave: type[Wave]) -> None:
    """A run may begin 80 m before its first support; its record may not end 10 m behind the last one.

    Without a run, a record needs its rest 100 to 150 m before each support, and 5 m behind the last one.
    """

    @dataclass(frozen=True)
    class Cut(Wave):
        def run(self, case: Case) -> Delivered:
            record = super().record(case)
            kept = record.position[0] < (case.analysis_section[1] + 10 if case.id.endswith("/initial") else case.end)
            cut = {name: getattr(record, name)[:, kept] for name in ("position", "force", "support_uplift")}
            return Delivered(replace(record, time=record.time[kept], contact_height=None, **cut))

    start = case_250.analysis_section[0] - 80
    near = replace(case_250, file=case_250.file.model_copy(update={"start_m": start}))
    outcome = damping_sensitivity.run_damping_sensitivity(add_damping_study(near), Cut())
    assert isinstance(outcome, Delivered)
    assert outcome.study is not None
    (row,) = (row for row in outcome.study.tables[0].rows if row[0] == "max_uplift_at_support_mm")
    assert row == ["max_uplift_at_support_mm", "line", "50", "50", "-", "50"]


def test_study_changes_no_grade_and_is_for_passages_alone(case_250: Case, wave: type[Wave]) -> None:
    plain, studied = (run_cases([case], wave()).cases[0] for case in (case_250, add_damping_study(case_250)))
    assert studied.criteria == plain.criteria
    assert studied.input_digest == plain.input_digest
    for case in select_cases(["en50318-2018/ac-simple/static", "vovan2015/contact-force"]):
        assert add_damping_study(case) is case


def test_warning_names_each_model_that_the_system_cannot_run(case_250: Case, wave: type[Wave]) -> None:
    @dataclass(frozen=True)
    class OneModel:
        name: str = "one model"
        version: str = "1"
        kind: Literal["builtin"] = "builtin"

        def run(self, case: Case) -> Outcome:
            return wave().run(case) if case.id == case_250.id else Skipped("there is no record of this case")

    (result,) = run_cases([add_damping_study(case_250)], OneModel()).cases
    skipped = Skipped("no record")
    system = SimpleNamespace(run=lambda case: skipped)
    assert damping_sensitivity.run_damping_sensitivity(add_damping_study(case_250), system) is skipped
    assert [warning for warning in result.warnings if warning.startswith("damping '")] == [
        f"damping '{name}': there is no record of this case" for name in MODELS
    ]
    assert result.tables[0].columns == ["Quantity", "Pantograph or line", CASE_DAMPING]
