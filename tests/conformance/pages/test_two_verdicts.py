"""Two verdicts on the pages: side by side, each with its part, and nothing that does not decide counts."""

import copy
from typing import Any
from xml.etree import ElementTree

import pytest

from helpers.shown_page import certify, shown_certificate, summarise
from pantocheck.conformance.app.commands.command_output import print_output
from pantocheck.conformance.app.commands.results_output import build_results_output
from pantocheck.conformance.documents.recomputation import find_discrepancies
from pantocheck.conformance.grading.case_verdict import Participation
from pantocheck.conformance.pages.certificate_page import build_certificate, build_summary
from pantocheck.conformance.pages.ci_reports import render_junit
from pantocheck.conformance.pages.document import Answers, Section, Table, VerdictMark
from pantocheck.conformance.pages.markdown import render_markdown
from pantocheck.conformance.pages.two_verdicts import summarise_verdict, verification_blocks
from pantocheck.conformance.pages.verdict_reasons import build_headline, list_reasons
from pantocheck.conformance.results.results_format import CaseResult, Results, VerdictName

BOTH: tuple[VerdictName, ...] = ("criteria", "verification")
BAND = "rms_20_50_N"


def add_verification(results: dict[str, Any], upper: float) -> Results:
    """Results whose only case is verified by one limit of the extended band."""
    case = copy.deepcopy(results["cases"][0])
    value = case["quantities"]["1"][BAND]
    inside = value <= upper
    half = (upper - 1) / 2
    row = case["criteria"][0] | {
        "quantity": BAND, "value": value, "unit": "N", "lower": 1.0, "upper": upper, "trust": "computed",
        "source": "converged solution", "verdict": "pass" if inside else "fail", "close": [],
        "reason": None if inside else f"{value - upper:.3g} N above the upper limit",
        "margin": min(value - 1, upper - value) / half,
        "discretisation_error": None, "spread": None, "uncertainty": 0.0015 * value,
        "components": {"discretisation": 0.0015 * value},
    }  # fmt: skip
    case |= {
        "criteria_verdict": case["verdict"],
        "verification": {
            "verdict": row["verdict"], "reason": None, "confirmed_by": "finite differences", "digest": "sha256:0",
            "omitted": ["min_force_N of pantograph 1: the formulations differ"], "criteria": [row],
        },
    }  # fmt: skip
    return Results.model_validate(results | {"cases": [case]})


def decide(results: Results, *requested: VerdictName) -> dict[str, Any]:
    return Participation(requested=requested).decide_run(results).to_dict()


@pytest.fixture
def failing(passing: dict[str, Any]) -> Results:
    """The criteria pass, the extended band fails."""
    return add_verification(passing, 2.0)


def test_headline_states_both_verdicts_and_their_part(failing: Results) -> None:
    shown = build_headline(Results.model_validate(decide(failing, "criteria")))
    assert "All 16 values with a limit that counts in 1 case lie inside the limits of" in shown
    assert "EN 50318 criteria: PASS; Verification up to 50 Hz: FAIL (for information)." in shown
    decided = build_headline(Results.model_validate(decide(failing, *BOTH)))
    assert "0 of 1 case passes, 1 fails (1 of 17 values outside limits that count)." in decided
    assert "EN 50318 criteria: PASS; Verification up to 50 Hz: FAIL." in decided
    alone = build_headline(Results.model_validate(decide(failing, "verification")))
    assert "(1 of 1 values outside limits that count)" in alone
    assert "EN 50318 criteria: PASS (for information); Verification up to 50 Hz: FAIL." in alone
    assert summarise_verdict(Results.model_validate(decide(failing, "criteria"))) == "pass 16/16"
    assert summarise_verdict(Results.model_validate(decide(failing, *BOTH))) == "fail 16/17"
    assert summarise_verdict(Results.model_validate(decide(failing, "verification"))) == "fail 0/1"
    # A verified value is shown as its deviation from the middle of its limits.
    result = CaseResult.model_validate(decide(failing)["cases"][0])
    [section] = verification_blocks(result, "case-1")
    assert isinstance(section, Section)
    assert result.verification is not None
    [table] = [block for block in section.blocks if isinstance(block, Table)]
    assert [column.heading for column in table.columns][2:5:2] == ["Deviation", "Tolerance"]
    value = result.verification.criteria[0].value
    assert float(str(table.rows[0][2]).split()[0]) == pytest.approx((value or 0.0) - (1.0 + 2.0) / 2, rel=1e-3)
    assert str(table.rows[0][4]).startswith("± ")


def test_page_1_names_a_criterion_that_needs_the_stated_start(passing: dict[str, Any]) -> None:
    results = decide(add_verification(passing, 60.0), *BOTH)
    remark = "1 N above the upper limit without the stated start, which is not checked"
    results["cases"][0]["verification"]["criteria"][0]["reason"] = remark
    sections = {section.heading: section for section in list_reasons(Results.model_validate(results))}
    page = render_markdown(certify(results))
    assert "Inside the limits only with the stated start" in sections
    assert page.count(remark) == 2  # page 1 and the table of the case
    (found,) = find_discrepancies(Results.model_validate(results))
    assert "'None' follows" in found  # the record states no other start than the case


def test_headline_without_converged_values_is_unchanged(passing: dict[str, Any]) -> None:
    assert "Verification" not in build_headline(Results.model_validate(passing))
    # Trust `computed` in the list of the EN 50318 criteria is a forgery.
    forged = copy.deepcopy(passing)
    forged["cases"][0]["criteria"][0]["trust"] = "computed"
    assert any("'info' follows" in text for text in find_discrepancies(Results.model_validate(forged)))


@pytest.mark.parametrize("build", [build_certificate, build_summary])
def test_page_has_both_verdicts_and_the_confirmation(failing: Results, build: Any) -> None:
    text = render_markdown(build(Results.model_validate(decide(failing, "criteria"))))
    assert ("## Two verdicts" if build is build_summary else "## Result") in text
    assert "| EN 50318 criteria | PASS | decides the verdict | 1 of 1 case passes." in text
    assert "| Verification up to 50 Hz | FAIL | for information |" in text
    assert "Confirmed by finite differences." in text
    assert "computed" in text


def test_criteria_without_a_limit_that_counts_are_no_failure(failing: Results) -> None:
    """A case that only the verification judges has not failed the criteria."""
    results = decide(failing, *BOTH)
    results["criteria_verdict"] = results["cases"][0]["criteria_verdict"] = "info"
    text = summarise(results)
    assert "| EN 50318 criteria | INFO | decides the verdict | No case has a limit that counts." in text
    assert "0 of 1 case passes." in text  # the verification fails


def test_certificate_lists_what_is_not_confirmed_and_failures_that_decide(failing: Results) -> None:
    text = shown_certificate(decide(failing, *BOTH))
    assert "min_force_N of pantograph 1: the formulations differ" in text
    assert "Without a confirmed value" in text
    shown, decided = (summarise(decide(failing, *names)) for names in (("criteria",), BOTH))
    assert "## Failed" in decided
    assert ", verification: " in decided
    assert "## Failed" not in shown


@pytest.mark.parametrize(
    ("requested", "failures", "skipped"), [(("criteria",), 0, 1), (BOTH, 1, 0), (("verification",), 1, 16)]
)
def test_junit_skips_the_verdict_that_does_not_decide(
    failing: Results, requested: tuple[VerdictName, ...], failures: int, skipped: int
) -> None:
    """The example has 16 criteria, a consistent record, and one criterion of the verification."""
    root = ElementTree.fromstring(render_junit(Results.model_validate(decide(failing, *requested))))
    assert (int(root.get("failures", "")), int(root.get("skipped", ""))) == (failures, skipped)
    assert any(test.get("name", "").startswith(f"verification: {BAND}") for test in root.iter("testcase"))


@pytest.mark.parametrize("requested", [("criteria",), BOTH, ("verification",)])
@pytest.mark.parametrize("upper", [2.0, 1000.0])
def test_decided_results_are_consistent(
    passing: dict[str, Any], upper: float, requested: tuple[VerdictName, ...]
) -> None:
    assert find_discrepancies(Results.model_validate(decide(add_verification(passing, upper), *requested))) == []


def test_changed_verification_is_found(failing: Results) -> None:
    """Every way to hide the failure: its verdict, its criterion, the verdicts of the case and of the run."""
    results = decide(failing, *BOTH)
    for change in ("verification", "criterion", "empty", "limit", "case", "run", "verification of the run"):
        forged = copy.deepcopy(results)
        case = forged["cases"][0]
        match change:
            case "verification":
                case["verification"]["verdict"] = "pass"
            case "criterion":
                case["verification"]["criteria"][0] |= {"verdict": "pass", "reason": None}
            case "empty":
                case["verification"] |= {"criteria": [], "verdict": "pass"}
            case "limit":
                case["verification"]["criteria"][0]["trust"] = "secondary"
            case "case":
                case["verdict"] = "pass"
            case "run":
                forged["verdict"] = "pass"
            case "verification of the run":
                forged["verification_verdict"] = "pass"
        assert find_discrepancies(Results.model_validate(forged)), change


@pytest.mark.parametrize(("close", "mark"), [([], "PASS"), (["0.1 N from a limit"], "PASS, CLOSE")])
def test_pass_with_a_close_value_is_amber_in_every_table_and_in_the_terminal(
    passing: dict[str, Any], close: list[str], mark: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """A green mark of a case would hide the value that another start reverses."""
    passing["cases"][0]["criteria"][0] |= {"close": close, "uncertainty": 2.0}
    [answers] = [block for block in certify(passing).blocks if isinstance(block, Answers)]
    tables = [block for section in answers.sections for block in section.blocks if isinstance(block, Table)]
    name = "close" if close else "pass"
    assert tables[0].rows[0][2] == VerdictMark(name)  # row of the case
    assert tables[-1].rows[0][-1 if len(tables[-1].columns) == 8 else -2] == VerdictMark(name)  # row of the value
    assert tables[-1].rows[1][-1 if len(tables[-1].columns) == 8 else -2] == VerdictMark("pass")
    [case] = [block for block in certify(passing).blocks if isinstance(block, Section) and block.anchor == "case-1"]
    assert case.blocks[0].text[0] == VerdictMark(name)  # type: ignore[union-attr, index]
    print_output(build_results_output(Results.model_validate(passing), [], 0), "run")
    lines = [line for line in capsys.readouterr().out.splitlines() if " en50318-2002/250  " in line]
    assert [line.split(" en50318")[0] for line in lines] == [mark]
