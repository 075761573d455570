"""Printed results: every criterion with its errors and limits, and the lines of a case."""

from typing import Any

import pytest

from pantocheck.conformance.app.commands.command_output import print_output
from pantocheck.conformance.app.commands.output_settings import OutputSettings, use_settings
from pantocheck.conformance.app.commands.results_output import LEGEND, build_results_output
from pantocheck.conformance.results.results_format import Results


def printed(results: dict[str, Any], capsys: pytest.CaptureFixture[str]) -> str:
    """Tables of the criteria."""
    with use_settings(OutputSettings(detail="verbose")):
        print_output(build_results_output(Results.model_validate(results), [], 0), "run")
    return capsys.readouterr().out.partition("All values of")[0]


def rows(text: str, name: str) -> list[list[str]]:
    """Cells of the rows of a criterion; columns are separated by one space."""
    return [line.split() for line in text.splitlines() if line.startswith(name) and not line.startswith(f"{name}:")]


@pytest.fixture(autouse=True)
def wide_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    """No line of these tests wraps."""
    monkeypatch.setenv("COLUMNS", "140")


@pytest.fixture
def rear(passing: dict[str, Any]) -> dict[str, Any]:
    """Criterion on the standard deviation of pantograph 2."""
    criterion: dict[str, Any] = passing["cases"][0]["criteria"][9]
    assert (criterion["quantity"], criterion["pantograph"]) == ("std_force_N", 2)
    criterion |= {"value": 28.1234, "margin": 0.64, "close": [], "lower": 22.0, "upper": 31.0}
    passing["cases"][0]["criteria"][0]["spread"] = 0.1  # so that the table has a column of shifts
    return criterion


def test_error_is_the_uncertainty_where_it_is_known(
    passing: dict[str, Any], rear: dict[str, Any], capsys: pytest.CaptureFixture[str]
) -> None:
    """Four digits of the value, two of its errors. A component that is not known is named once."""
    rear |= {"discretisation_error": 0.01234, "spread": 0.5678, "uncertainty": None}
    expected = [
        "std_force_N,", "pantograph", "2", "28.12", "0.012", *("22", "to", "31"), "+0.64", "PASS",
    ]  # fmt: skip
    assert rows(printed(passing, capsys), "std_force_N, pantograph 2") == [expected]
    rear |= {"uncertainty": 0.98765, "spread": None}
    expected[4] = "0.99"
    text = printed(passing, capsys)
    assert rows(text, "std_force_N, pantograph 2") == [expected]
    lacking = "Uncertainties of the passage without section and length, which are not known: they are too small."
    assert " ".join(text.split()).count(lacking) == 1
    rear |= {"uncertainty": 0.0}
    expected[4:5] = ["not", "known"]
    assert rows(printed(passing, capsys), "std_force_N, pantograph 2") == [expected]
    for case in passing["cases"]:
        case["uncertainty_basis"] = dict.fromkeys(case["uncertainty_basis"], "known")
    expected[4:6] = ["0"]
    text = printed(passing, capsys)
    assert rows(text, "std_force_N, pantograph 2") == [expected]
    assert "Uncertainties of the passage" not in text


def test_computed_limits_are_printed_with_four_digits(
    passing: dict[str, Any], rear: dict[str, Any], capsys: pytest.CaptureFixture[str]
) -> None:
    rear |= {"margin": None, "spread": None, "uncertainty": None, "discretisation_error": None}
    for lower, upper, cells in (
        (22.0, 31.0, "22 to 31"), (22.0, None, ">= 22"), (None, 31.0, "<= 31"), (0.0, 0.0, "= 0"), (None, None, "none"),
        (22.12641234, 31.12641234, "22.13 to 31.13"), (22.12641234, None, ">= 22.13"), (None, 31.12641234, "<= 31.13"),
    ):  # fmt: skip
        rear |= {"lower": lower, "upper": upper}
        (row,) = rows(printed(passing, capsys), "std_force_N, pantograph 2")
        assert row[3:] == ["28.12", "-", *cells.split(), "-", "PASS"]


def test_value_outside_a_limit_is_not_printed_on_it(
    passing: dict[str, Any], rear: dict[str, Any], capsys: pytest.CaptureFixture[str]
) -> None:
    """31.0004 N above 31 N fails with a margin of -0.0001, which four digits and two decimals would hide."""
    rear |= {"value": 31.0004, "verdict": "fail", "margin": -8.9e-5}
    (row,) = rows(printed(passing, capsys), "std_force_N, pantograph 2")
    assert (row[3], row[5:8], row[8]) == ("31.0004", ["22", "to", "31"], "-0.0001")


def test_first_pantograph_and_line_are_not_named(passing: dict[str, Any], capsys: pytest.CaptureFixture[str]) -> None:
    """So that the table of a common case fits into 80 columns; there is no empty line below the headings."""
    lines = printed(passing, capsys).splitlines()
    heading = next(i for i, line in enumerate(lines) if line.startswith("criterion"))
    assert lines[heading].rstrip().endswith("margin verdict")
    assert lines[heading + 1].startswith("mean_force_N ")
    criteria = passing["cases"][0]["criteria"]
    criteria[0] |= {"quantity": "dropper_length_m", "pantograph": 0, "item": 3}
    text = printed(passing, capsys)
    assert len(rows(text, "dropper_length_m[3] ")) == 1
    assert len(rows(text, "mean_force_N, pantograph 2")) == 1
    assert len(rows(text, "std_force_N ")) == 1


def test_remark_of_every_case_is_printed_once(passing: dict[str, Any], capsys: pytest.CaptureFixture[str]) -> None:
    """A remark of one case is a warning of it; a common one, and the caveat of the band, are footnotes."""
    band = "20-50 Hz: lumped models of pantographs are validated up to 20 Hz only"
    first, second = passing["cases"][0], dict(passing["cases"][0], id="another/300")
    first["warnings"], second["warnings"] = ["a common remark", "a rare remark"], ["a common remark", band]
    passing["cases"] = [first, second]
    lines = printed(passing, capsys).splitlines()
    assert [line.strip() for line in lines if "remark" in line or "20-50 Hz" in line] == [
        "warning: a rare remark",
        "[1] a common remark",
        f"[2] {band}",
    ]
    assert [line.split()[-2:] for line in lines if line.startswith("PASS another/300")] == [["[1]", "[2]"]]


def test_lines_of_a_case_stand_above_its_table(passing: dict[str, Any], capsys: pytest.CaptureFixture[str]) -> None:
    """State of the record, changes of limits and warnings above; reasons and close limits below."""
    case = passing["cases"][0]
    case["limit_changes"] = ["std_force_N: the limit 26 to 31 is removed", "cov_20: the limit <= 0.3 is removed"]
    case["criteria"][0] |= {"reason": "2 N above the upper limit", "close": ["lies 1 N from a limit"]}
    lines = printed(passing, capsys).splitlines()
    heading = next(i for i, line in enumerate(lines) if line.startswith("criterion"))
    above, below = lines[:heading], lines[heading:]
    changes = "limits file: std_force_N: the limit 26 to 31 is removed; cov_20: the limit <= 0.3 is removed"
    assert f"  {changes}" in above
    assert any(line.startswith("  warning: The contact force is sampled at 1000 Hz") for line in above)
    assert any("every consistency check that applies confirms the record" in line for line in above)
    assert "  mean_force_N: 2 N above the upper limit" in below
    close = "Closer to a limit than the uncertainty (mostly start): mean_force_N. Another start or run-in could"
    assert close in " ".join(" ".join(below).split())
    assert "  Trust of the limits: secondary." in below
    assert LEGEND in " ".join(line.strip() for line in below)


def test_case_without_changes_or_criteria_has_no_line_for_them(
    results: dict[str, Any], capsys: pytest.CaptureFixture[str]
) -> None:
    text = printed(results | {"verdict": "skip", "cases": results["cases"][2:]}, capsys)
    assert "  the static case en50318-2018/ac-simple/static did not pass" in text.splitlines()
    assert "limits file" not in text
    assert "criterion" not in text.splitlines()[3:]
    assert LEGEND[:20] not in text


def test_values_of_a_case_without_limits_are_printed(
    passing: dict[str, Any], capsys: pytest.CaptureFixture[str]
) -> None:
    """A case with limits prints its criteria, one without limits the main values with their uncertainty."""
    passing["cases"] = passing["cases"][:1]
    case = passing["cases"][0]
    case["quantities"] = {"1": {"mean_force_N": 118.76543}, "2": {"mean_force_N": 119.0, "rms_0_5_N": 20.0}}
    case["uncertainty"] = {"1": {"mean_force_N": 0.123}}
    assert rows(printed(passing, capsys), "mean_force_N, pantograph 2")[0][3] != "119"
    case["criteria"] = []
    text = printed(passing, capsys)
    assert rows(text, "mean_force_N") == [
        ["mean_force_N", "118.8", "0.12", "N"],
        ["mean_force_N,", "pantograph", "2", "119", "-", "N"],
    ]
    assert "rms_0_5_N" not in text
