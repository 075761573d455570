"""Self-test: every mutant on one case, and its page."""

from pathlib import Path

import pytest
from typer.testing import CliRunner

from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.command_line.app import app
from pantocheck.conformance.reports.formats.markdown import render_markdown
from pantocheck.conformance.self_test.bench import SelfTest, run_self_test
from pantocheck.conformance.self_test.mutants import MILD, MUTANTS
from pantocheck.conformance.self_test.self_test_page import build_self_test_page

DOCUMENT = Path(__file__).parents[2] / "docs" / "self-test.md"


@pytest.fixture(scope="module")
def done() -> SelfTest:
    return run_self_test(select_cases(["en50318-2002/300"]))


def test_self_test_passes_the_simulator_and_detects_every_mutant(done: SelfTest) -> None:
    assert done.right == {"en50318-2002/300": ("pass", "")}
    missed = [row.mutant.name for row in done.rows if not row.caught]
    assert missed == []
    assert done.passed
    assert len(done.rows) == len(MUTANTS) == 11
    assert {row.verdict for row in done.rows} <= {"fail", "error"}


def test_limits_alone_do_not_detect_shifts(done: SelfTest) -> None:
    """The reason for the checks of a record."""
    by_limits = {row.mutant.name: row.by_limits for row in done.rows}
    assert by_limits["time shift"] == by_limits["position shift"] == "pass"
    assert by_limits["no slackening"] == by_limits["gain 1.05"] == "fail"


def test_self_test_page_is_current(done: SelfTest) -> None:
    """The committed page has the mutants and verdicts of this run."""
    text = DOCUMENT.read_text(encoding="utf-8")
    assert len(done.mild) == len(MILD)
    assert render_markdown(build_self_test_page(done)).splitlines() == [
        row for row in text.splitlines() if "en50318-2002/250" not in row
    ]


def test_self_test_fails_if_a_mutant_is_not_detected(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """A mutant without a fault: the self-test itself must be able to fail."""
    from pantocheck.conformance.results.outcome import Delivered
    from pantocheck.conformance.self_test import bench
    from pantocheck.conformance.self_test.mutants import Mutant

    harmless = Mutant("harmless", "Nothing.", lambda case, record: Delivered(record), "limits")
    monkeypatch.setattr(bench, "MUTANTS", (harmless,))
    monkeypatch.setattr(bench, "MILD", ())
    done = CliRunner().invoke(app, ["self-test", "en50318-2002/250", "--markdown", str(tmp_path / "page.md")])
    assert done.exit_code == 1
    assert done.output.startswith("FAIL  0 of 1 mutants detected by the expected check")
    assert "NOT DETECTED, expected limits" in done.output
    assert "| harmless |" in (tmp_path / "page.md").read_text()
