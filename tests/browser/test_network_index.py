"""Index page of 5,000 km in a browser: filters by date, speed, verdict and line, drill-down, traces, both widths."""

from collections.abc import Callable
from typing import Any

import pytest

from helpers.example_network import FAILING, LENGTH_KM, LINES, SKIPPED

pytestmark = pytest.mark.thorough

SECTIONS = "Filter by a date, speed, kilometre or verdict; the run is that of the worst passage"
PATIENCE_MS = 120_000
"""Ten thousand rows are laid out at once."""


@pytest.fixture
def network(open_page: Any) -> Callable[..., Any]:
    def open_patiently(width: int) -> Any:
        return open_page("network", width, timeout_ms=PATIENCE_MS)

    return open_patiently


def count_rows(page: Any) -> int:
    return int(page.get_by_role("table", name=SECTIONS).locator("tbody tr:not(.filtered)").count())


def test_sections_are_filtered_by_date_speed_verdict_and_line(network: Callable[..., Any]) -> None:
    """Every 50th kilometre fails in the higher class of speed, which was measured from the 1st to the 9th of June."""
    page = network(1280)
    assert count_rows(page) == 2 * LINES * LENGTH_KM
    verdict, date, speed, line = (
        page.get_by_label(f"{name}, {SECTIONS}", exact=True) for name in ("Verdict", "Dates", "Speed [km/h]", "Line")
    )
    for day, measured in (("2026-06-05", True), ("2026-05-20", False), ("2026-05-09", True)):
        date.fill(day)
        assert count_rows(page) == measured * LINES * (LENGTH_KM - SKIPPED)
    date.fill("")
    verdict.select_option("fail")
    failed = LINES * (LENGTH_KM // FAILING - 1)
    assert count_rows(page) == failed
    speed.select_option("250 to 260")
    assert count_rows(page) == 0
    speed.select_option("270 to 280")
    line.select_option("3")
    assert count_rows(page) == failed / LINES
    link = page.get_by_role("table", name=SECTIONS).locator("tbody tr:not(.filtered) a").first
    assert link.get_attribute("href") == "runs/3-6.html"


def test_worst_places_have_traces_and_a_run(network: Callable[..., Any]) -> None:
    page = network(1280)
    page.locator("summary", has_text="Force at the worst places").click()
    traces = page.locator("figure svg polyline")
    assert traces.count() == 100
    assert traces.first.is_visible()
    page.get_by_label("Explained, Deviation", exact=False).select_option("no")
    places = page.get_by_role("table", name="Deviation of the filtered force", exact=False)
    assert places.locator("tbody tr:not(.filtered)").count() == 50
    assert places.locator("a").first.get_attribute("href") == "runs/0-6.html"
    assert page.get_by_role("heading", name="Map").count() == 1


def test_page_fits_a_phone(network: Callable[..., Any]) -> None:
    page = network(390)
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
