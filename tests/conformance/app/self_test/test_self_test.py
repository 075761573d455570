"""Self-test: every mutant on one case, and its tables."""

import csv
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from helpers.command_line import pantocheck
from helpers.wave_system import Wave
from pantocheck.conformance.app.self_test import mutants
from pantocheck.conformance.app.self_test.mutants import MILD, MUTANTS, Mutant, SelfTest, run_self_test
from pantocheck.conformance.app.self_test.numerical_faults import FAULTS, run_numerical_faults
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.runs.system import Delivered
from verification.tables import self_test_tables

TABLES = Path(__file__).parents[4] / "docs" / "tables"


@pytest.fixture(scope="module")
def self_test() -> SelfTest:
    cases = select_cases(["en50318-2002/300"])
    return replace(run_self_test(cases, lambda _: None), numerical=run_numerical_faults(cases, lambda _: None))


def test_self_test_passes_the_simulator_and_detects_every_mutant(self_test: SelfTest) -> None:
    assert self_test.reference == {"en50318-2002/300": ("pass", "")}
    missed = [row.mutant.name for row in self_test.severe if not row.detected]
    assert missed == []
    assert self_test.passed
    assert len(self_test.severe) == len(MUTANTS) == 11
    assert {row.verdict for row in self_test.severe} <= {"fail", "error"}
    # The reason for the checks of a record.
    by_limits = {row.mutant.name: row.by_limits for row in self_test.severe}
    assert by_limits["time shift"] == by_limits["position shift"] == "pass"
    assert by_limits["no slackening"] == by_limits["gain 1.05"] == "fail"


def test_faults_have_the_size_of_their_name(two_pantograph_case: Case) -> None:
    record = Wave().record(two_pantograph_case)
    for name, factor in (("units x1000", 1000.0), ("gain 1.05", 1.05), ("gain 1.02", 1.02)):
        (mutant,) = (mutant for mutant in (*MUTANTS, *MILD) if mutant.name == name)
        outcome = mutant.run(two_pantograph_case, record)
        assert isinstance(outcome, Delivered)
        assert outcome.record is not None
        np.testing.assert_allclose(outcome.record.force, factor * record.force)


def test_forces_of_two_strips_take_the_fault_of_their_sum(two_pantograph_case: Case) -> None:
    """A record whose strips do not add up to the force is refused, so that the fault itself must change them."""
    record = Wave().record(two_pantograph_case)
    strips = replace(record, front_strip=0.4 * record.force, rear_strip=0.6 * record.force)
    names = {"gain 1.05", "units x1000", "filter order 2", "time shift", "truncated record", "filter at 10 Hz"}
    faults = [mutant for mutant in (*MUTANTS, *MILD) if mutant.name in names]
    assert len(faults) == len(names)
    for mutant in faults:
        outcome = mutant.run(two_pantograph_case, strips)
        assert isinstance(outcome, Delivered)
        assert outcome.record is not None
        # The faults are linear; a filter of order 12 rounds at 1e-9.
        np.testing.assert_allclose(outcome.record.front_strip, 0.4 * outcome.record.force, rtol=1e-6, atol=1e-6)


def test_numerical_faults_are_detected_by_the_verification(self_test: SelfTest) -> None:
    """Only droppers that push change the force below 20 Hz enough to leave the limits of EN 50318:2002."""
    rows = {row.fault.name: row for row in self_test.numerical}
    assert len(rows) == len(FAULTS) == 8
    severe = [row for row in rows.values() if row.fault.must_be_detected]
    assert {row.verification for row in severe} == {"fail"}
    assert all("rms_20_50_N" in row.outside for row in severe)
    assert {name for name, row in rows.items() if row.criteria == "fail"} == {"no slackening"}
    missed = replace(self_test.numerical[0], verification="pass")
    assert not replace(self_test, numerical=(missed,)).passed
    optional = replace(missed, fault=replace(missed.fault, must_be_detected=False))
    assert replace(self_test, numerical=(optional,)).passed


def test_tables_of_the_page_are_those_of_this_run(self_test: SelfTest) -> None:
    assert len(self_test.mild) == len(MILD)
    for name, rows in (
        ("mutants", self_test_tables.list_severe(self_test.severe)),
        ("numerical", self_test_tables.list_numerical(self_test.numerical)),
        ("mild", self_test_tables.list_mild(self_test.mild)),
    ):
        text = (TABLES / f"self-test-{name}.csv").read_text("utf-8")
        heading, *written = (tuple(row) for row in csv.reader(text.splitlines()))
        assert [heading, *(row for row in written if "`en50318-2002/300`" in row)] == rows


def test_self_test_names_every_undetected_mutant(monkeypatch: pytest.MonkeyPatch) -> None:
    """A mutant without a fault: the self-test itself must be able to fail, also on a narrow terminal."""
    harmless = Mutant("harmless", "Nothing.", lambda case, record: Delivered(record), "limits")
    monkeypatch.setattr(mutants, "MUTANTS", (harmless,))
    monkeypatch.setattr(mutants, "MILD", ())
    result = pantocheck("system", "self-test", "en50318-2002/250", COLUMNS="80")
    assert result.exit_code == 1
    assert result.output.startswith("FAIL 0 of 1 mutants detected by the expected check")
    assert "NOT DETECTED: harmless on en50318-2002/250, expected check: limits\n" in result.output
