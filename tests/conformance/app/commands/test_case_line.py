"""Lines of a graded case: numbers of its values, reasons against a pass, and the force on a terminal."""

import io
from typing import Any

import pytest
from rich.console import Console

from pantocheck.conformance.app.commands.case_line import BLOCKS, ForceLine, draw_blocks, write_case_line
from pantocheck.conformance.app.commands.command_output import print_output
from pantocheck.conformance.app.commands.results_output import build_results_output
from pantocheck.conformance.results.results_format import Results


def printed(results: dict[str, Any], capsys: pytest.CaptureFixture[str]) -> list[str]:
    print_output(build_results_output(Results.model_validate(results), [], 0), "run")
    return capsys.readouterr().out.splitlines()


def test_line_counts_the_values_inside_and_those_close(passing: dict[str, Any]) -> None:
    results = Results.model_validate(passing)
    case = results.cases[0]
    inside = sum(row.verdict == "pass" for row in case.criteria)
    close = sum(bool(row.close) for row in case.criteria)
    text = write_case_line(results, case).plain
    assert f"{case.id}  {inside} of {inside} values inside" in text
    assert (f"{close} close" in text) == bool(close)
    row = case.criteria[0].model_copy(update={"close": ["lies 1 N from a limit"], "uncertainty": 2.0})
    marked = case.model_copy(update={"criteria": [row, *case.criteria[1:]]})
    assert f"{close + (not case.criteria[0].close)} close" in write_case_line(results, marked).plain


def test_answer_stands_below_the_cases(passing: dict[str, Any], capsys: pytest.CaptureFixture[str]) -> None:
    """No table and no path of a file: the last lines are the verdict."""
    lines = printed(passing, capsys)
    assert not [line for line in lines if line.startswith("criterion")]
    (place,) = [
        i for i, line in enumerate(lines) if line.startswith("PASS All ") or line.startswith("PASS, CLOSE All ")
    ]
    assert all(any(case["id"] in line for line in lines[:place]) for case in passing["cases"])
    assert lines[-1].rstrip().endswith(passing["system"]["version"])


def test_at_most_three_failed_values_stand_below_a_case(
    passing: dict[str, Any], capsys: pytest.CaptureFixture[str]
) -> None:
    rows = passing["cases"][0]["criteria"][:5]
    for row in rows:
        row |= {"verdict": "fail", "reason": None, "close": []}
    lines = printed(passing, capsys)
    assert [line.split(":")[0].strip() for line in lines if line.startswith("  FAIL ")] == [
        f"FAIL {row['quantity']}" for row in rows[:3]
    ]
    assert "  2 more with -v" in lines


@pytest.mark.parametrize(
    ("values", "width", "heights"),
    [
        ([0, 1, 2, 3, 4, 5, 6, 7], 8, [0, 1, 2, 3, 4, 5, 6, 7]),  # 8 (x - 0) / 7, rounded down, at most the full block
        ([0, 0, 8, 8], 2, [0, 7]),
        ([5, 5, 5], 9, [0, 0, 0]),
        ([0, 8, 0, 8], 1, [4]),
    ],
)
def test_blocks_follow_the_means_of_the_parts(values: list[float], width: int, heights: list[int]) -> None:
    assert [BLOCKS.index(block) for block in draw_blocks(values, width)] == heights


@pytest.mark.parametrize(("terminal", "lines"), [(True, 1), (False, 0)])
def test_force_is_drawn_on_a_terminal_only(terminal: bool, lines: int) -> None:
    file = io.TextIOWrapper(io.BytesIO(), encoding="utf-8")
    console = Console(file=file, force_terminal=terminal, width=60, color_system=None)
    with console.capture() as capture:
        console.print(ForceLine("force of pantograph 2", [100.0 + i % 7 for i in range(500)]))
    found = capture.get().splitlines()
    assert len([line for line in found if line]) == lines
    assert all(len(line) <= 60 for line in found)
    if terminal:
        assert found[0].startswith("  force of pantograph 2 ")
        assert found[0].endswith(" 100 to 106 N")
