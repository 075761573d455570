"""The suite fails what it must: every mutant on one case, and the page that says so."""

from pathlib import Path

import pytest
from typer.testing import CliRunner

from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.command_line.app import app
from pantocheck.conformance.self_test.bench import run_self_test
from pantocheck.conformance.self_test.mutants import MILD, MUTANTS
from pantocheck.conformance.self_test.self_test_page import build_self_test_page

DOCUMENT = Path(__file__).parents[2] / "docs" / "self-test.md"


@pytest.fixture(scope="module")
def done():
    return run_self_test(select_cases(["en50318-2002/300"]))


def test_right_system_passes_and_every_mutant_is_caught_for_its_reason(done):
    assert done.right == {"en50318-2002/300": ("pass", "")}
    missed = [row.mutant.name for row in done.rows if not row.caught]
    assert missed == []
    assert done.passed
    assert len(done.rows) == len(MUTANTS) == 11
    assert {row.verdict for row in done.rows} <= {"fail", "error"}


def test_limits_alone_let_shifts_through(done):
    """Why the checks of a record exist."""
    by_limits = {row.mutant.name: row.by_limits for row in done.rows}
    assert by_limits["time shift"] == by_limits["position shift"] == "pass"
    assert by_limits["no slackening"] == by_limits["gain 1.05"] == "fail"


def test_document_is_of_these_mutants(done):
    """Numbers are left out, so that the page only changes with what it tells."""
    text = DOCUMENT.read_text(encoding="utf-8")
    assert len(done.mild) == len(MILD)
    assert build_self_test_page(done).splitlines() == [
        row for row in text.splitlines() if "en50318-2002/250" not in row
    ]


def test_missed_mutant_is_a_failed_self_test(monkeypatch, tmp_path):
    """A mutant that is not one: the self-test must be able to fail as well."""
    from pantocheck.conformance.results.outcome import Delivered
    from pantocheck.conformance.self_test import bench
    from pantocheck.conformance.self_test.mutants import Mutant

    harmless = Mutant("harmless", "Nothing.", lambda case, record: Delivered(record), "limits")
    monkeypatch.setattr(bench, "MUTANTS", (harmless,))
    monkeypatch.setattr(bench, "MILD", ())
    done = CliRunner().invoke(app, ["self-test", "en50318-2002/250", "--markdown", str(tmp_path / "page.md")])
    assert done.exit_code == 1
    assert done.output.startswith("FAIL  0 of 1 mutants caught")
    assert "MISSED, expected limits" in done.output
    assert "| harmless |" in (tmp_path / "page.md").read_text()
