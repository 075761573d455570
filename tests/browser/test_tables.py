"""Sorting and filtering of tables."""

import re
from typing import Any

import pytest

from helpers.example_results import example

pytestmark = pytest.mark.thorough

CRITERIA = "table:is(.values, .cards)"
"""Graded values: those of the first case stand on page 1, those of the second in its section."""
ROWS = "tbody tr:not(.filtered)"


def read_column(page: Any, heading: str, table: str = CRITERIA) -> list[str]:
    """Visible cells of a column of the first table."""
    cells = page.locator(table).first.locator(f"{ROWS} td[data-label='{heading}']")
    return [text.strip().replace("−", "-") for text in cells.all_inner_texts()]


def press_heading(page: Any, heading: str) -> None:
    page.locator(CRITERIA).first.get_by_role("button", name=heading, exact=True).click()


def test_headings_sort_up_down_and_restore_the_order(open_page: Any) -> None:
    page = open_page("certificate")
    original = read_column(page, "Value")
    numbers = sorted(float(text.split()[0]) for text in original)
    for expected, direction in ((numbers, "ascending"), (numbers[::-1], "descending")):
        press_heading(page, "Value")
        assert [float(text.split()[0]) for text in read_column(page, "Value")] == expected
        assert page.locator(f"{CRITERIA} th[aria-sort={direction}]").count() == 1
    press_heading(page, "Value")
    assert read_column(page, "Value") == original


def test_verdicts_are_sorted_by_rank_and_dashes_stay_last(open_page: Any) -> None:
    page = open_page("certificate")
    table = page.locator(CRITERIA).nth(1)
    button = table.get_by_role("button", name="Verdict", exact=True)
    button.focus()
    page.keyboard.press("Enter")
    marks = table.locator("td[data-label=Verdict] .verdict")
    classes = [str(mark.get_attribute("class")).split()[-1] for mark in marks.all()]
    verdicts = [row["verdict"] for row in example()["cases"][1]["criteria"]]
    assert classes == sorted(verdicts, key=["fail", "skip", "info", "pass"].index)
    margin = table.get_by_role("button", name="Margin", exact=True)
    for _ in range(2):
        margin.click()
        assert table.locator("td[data-label=Margin]").last.inner_text().strip() == "–"


def test_filter_leaves_the_rows_with_all_words(open_page: Any) -> None:
    page = open_page("certificate")
    field = page.get_by_role("searchbox").first
    field.fill("max_force 173")
    shown = page.locator(CRITERIA).first.locator(ROWS)
    assert [row.locator("code").inner_text() for row in shown.all()] == ["max_force_N"]
    assert page.get_by_role("status").filter(has_text="1 of 16 rows").count() == 1
    field.fill("")
    assert shown.count() == len(example()["cases"][0]["criteria"])


def test_selection_of_a_verdict_leaves_its_rows(open_page: Any) -> None:
    page = open_page("certificate")
    page.get_by_role("combobox").first.select_option("fail")
    rows = page.locator(f"{CRITERIA} {ROWS}:has(.verdict.fail)")
    failed = [row for row in example()["cases"][1]["criteria"] if row["verdict"] == "fail"]
    assert rows.count() == len(failed)
    assert page.locator(CRITERIA).nth(1).locator(ROWS).count() == len(failed)


def test_matrix_of_a_site_is_filtered_by_every_verdict_in_a_row(open_page: Any) -> None:
    """Every row has a pass of the first system; a third of the rows has a failure of the second."""
    page = open_page("site")
    rows = page.locator("table").first.locator(ROWS)
    for verdict, count in (("fail", 4), ("pass", 12), ("skip", 4)):
        page.get_by_role("combobox").first.select_option(verdict)
        assert rows.count() == count


def test_long_table_of_another_report_is_sorted_by_number(open_page: Any) -> None:
    page = open_page("plain")
    page.get_by_role("button", name="f [Hz]").click()
    assert [float(text) for text in read_column(page, "f [Hz]", "table.grid")[:4]] == [-1.0, 3.5, 20.0, 30.0]


def test_phone_has_the_headings_as_buttons_above_the_cards(open_page: Any) -> None:
    page = open_page("certificate", 390)
    press_heading(page, "Margin")
    # A margin beside a limit of zero has a unit.
    numbers = [re.findall(r"[+-]?\d+\.?\d*", text) for text in read_column(page, "Margin")]
    margins = [float(found[-1]) for found in numbers if found]
    assert len(margins) > 3
    assert margins == sorted(margins)
