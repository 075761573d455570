"""Highest supported frequency: its rule, and grey values above it on every page."""

import io
import re
from typing import Any

import numpy as np
import pytest
from pypdf import PdfReader

from helpers.shown_page import print_certificate, shown_certificate, summarise
from pantocheck.conformance.comparison.compared_run import ComparedRun
from pantocheck.conformance.comparison.run_comparison import compare_subjects
from pantocheck.conformance.pages.case_figures import draw_spectrum
from pantocheck.conformance.pages.html import render_html
from pantocheck.conformance.pages.run_comparison_page import build_run_comparison
from pantocheck.conformance.pages.site_pages import build_case_page, order_results
from pantocheck.conformance.pages.words import format_value
from pantocheck.conformance.quantities.filters import Filter
from pantocheck.conformance.quantities.pantograph_signals import ForceChannel, PantographSignals
from pantocheck.conformance.results.results_format import CaseResult, Results
from pantocheck.conformance.results.supported_frequency import (
    SupportedFrequency,
    describe_supported,
    find_supported_Hz,
    is_supported,
)

BAND = "RMS, 20–50 Hz"
GREY_FILL = re.compile(rb"0\.4666\d* 0\.505\d* 0\.545\d* (?:rg|scn)")
"""Colour of a grey text in the PDF."""


def state(part: str, frequency: float | None, limits: bool = True) -> dict[str, Any]:
    return {"part": part, "frequency_Hz": frequency, "basis": "own test", "limits": limits}


def support(results: dict[str, Any], frequency: float | None) -> dict[str, Any]:
    """Results whose first case has a pantograph that is supported up to a frequency [Hz]."""
    results["cases"][0]["supported"] = [
        state("pantograph 1", frequency), state("elements", 119.0), state("torsion of the contact wire", 19.0, False)
    ]  # fmt: skip
    return results


def test_lowest_known_frequency_that_limits_is_the_rule() -> None:
    """Facts about the line alone, unknown parts and other pantographs limit nothing; the line has all pantographs."""
    rows = (("pantograph 1", 35.0), ("pantograph 2", None), ("time step", 55.0))
    parts = [SupportedFrequency(**state(*row)) for row in rows]
    parts.append(SupportedFrequency(**state("dropper spacing", 9.0, False)))
    assert [find_supported_Hz(parts, owner) for owner in "012"] == [35.0, 35.0, 55.0]
    assert [describe_supported(parts, owner) for owner in "012"] == ["not known", "35 Hz", "not known"]
    assert [is_supported(parts, owner, "rms_20_50_N") for owner in "012"] == [False, False, True]
    for name in ("std_force_N", "rms_5_20_N", "max_uplift_at_support_mm", "mean_force_N"):
        assert is_supported(parts, "1", name)
    for name in ("std_force_50_N", "cov_50", "change_rms_20_50_pct", "contact_loss_pct"):
        assert not is_supported(parts, "1", name)
    assert find_supported_Hz([], "1") is None
    assert is_supported([SupportedFrequency(**state("pantograph 1", 50.0))], "1", "rms_20_50_N")


def list_muted(page: str) -> list[str]:
    """First cells of the rows of a page whose text is grey."""
    rows = re.findall(r'<th role="rowheader" scope="row">(.*?)</th>', page)
    return [re.sub("<[^>]*>", "", row).strip() for row in rows if 'class="muted"' in row]


@pytest.mark.parametrize(("frequency", "grey"), [(35.0, True), (50.0, False), (None, False)])
def test_html_greys_the_band_above_the_frequency(passing: dict[str, Any], frequency: float, grey: bool) -> None:
    page = shown_certificate(support(passing, frequency))
    muted = list_muted(page)
    assert any(text.startswith(BAND) for text in muted) == grey
    assert not any(text.startswith(("RMS, 5–20 Hz", "Mean", "Standard deviation, 0–20")) for text in muted)
    assert ("Grey: above 35 Hz, not supported." in page) == grey
    words = "not known" if frequency is None else f"{frequency:g} Hz"
    assert f"Highest supported frequency: pantograph 1 {words}." in page
    assert ('data-supported="35.0"' in page) == grey


def test_pdf_greys_the_band_above_the_frequency(passing: dict[str, Any]) -> None:
    """The band stands in grey letters; without a known frequency no letter is grey."""
    for frequency, grey in ((35.0, True), (None, False)):
        reader = PdfReader(io.BytesIO(print_certificate(support(passing, frequency))))
        found = any(GREY_FILL.search(page.get_contents().get_data()) for page in reader.pages)
        assert found == grey


def test_site_and_summary_state_the_frequency(passing: dict[str, Any]) -> None:
    for frequency, grey in ((35.0, True), (None, False)):
        results = Results.model_validate(support(passing, frequency))
        page = build_case_page(results.cases[0].id, order_results([(results, ())]))
        text = render_html(page).replace("\N{NO-BREAK SPACE}", " ")
        value = results.cases[0].quantities["1"]["rms_20_50_N"]
        assert (f'<span class="muted">{format_value(value)}</span>' in text) == grey
        assert "Highest supported frequency: pantograph 1" in text
        assert "Highest supported frequency: pantograph 1" in summarise(passing)


def test_spectrum_is_grey_above_the_frequency_alone(passing: dict[str, Any]) -> None:
    case = CaseResult.model_validate(passing["cases"][0])
    for frequency, patches in ((35.0, 1), (None, 0), (60.0, 0)):
        axes = draw_spectrum.__wrapped__(case.traces["1"], case.quantities["1"], frequency).axes[0]
        above = [area for area in axes.areas if area.x[0] == frequency]
        assert len(above) == patches
        assert all(max(area.x) == 50 for area in above)


def test_comparison_greys_the_values_of_the_subject_that_does_not_support_them() -> None:
    """The first subject is supported to 35 Hz, the second to 60 Hz, a record states nothing."""
    parts = tuple(SupportedFrequency(**state("pantograph 1", f)) for f in (35.0, 60.0))
    values = {"std_force_N": 25.0, "rms_20_50_N": 12.5}
    time = np.arange(0, 10, 0.002)
    force = ForceChannel(120 + sum(20 * np.sin(2 * np.pi * f * time) for f in (1, 12, 37)), 500.0, Filter(), None)
    signals = {1: PantographSignals(60 * time, force, (100.0, 500.0))}
    runs = [
        ComparedRun("record", name, "", "", "", None, {1: values}, {}, signals, supported=supported)
        for name, supported in (("low", parts[:1]), ("high", parts[1:]), ("record", ()))
    ]
    comparison = compare_subjects([[run] for run in runs], None)
    page = render_html(build_run_comparison(comparison)).replace("\N{NO-BREAK SPACE}", " ")
    rows = {
        re.sub("<[^>]+>|\N{WORD JOINER}", "", cells[0]): cells[1:]
        for cells in (re.findall(r"<t[hd][^>]*>(.*?)</t[hd]>", row) for row in page.split("<tr"))
        if cells
    }
    muted = {name: ['class="muted"' in cell for cell in cells] for name, cells in rows.items()}
    assert muted["RMS, 20–50 Hz ‡ [N]"] == [True, False, False]
    assert not any(muted["Standard deviation, 0–20 Hz [N]"])
    grey = [row.count('class="muted"') for row in page.split("<tr") if "20 to 50<" in row]
    assert grey == [6, 6]  # every cell of both subjects beside the first one
    assert not any('class="muted"' in row for row in page.split("<tr") if "5 to 20" in row)
    assert "Highest supported frequency: low 35 Hz; high 60 Hz. Grey: not supported." in page
    charts = {chart.caption[:9]: chart.marks for chart in comparison.cases[0].owners[0].charts}
    bands = [(mark.label, mark.low, mark.high) for mark in charts["Amplitude"]]
    assert bands == [("low: not supported", 35.0, 50.0)]
    assert bands[0] in [(mark.label, mark.low, mark.high) for mark in charts["Coherence"]]
    plain = compare_subjects([[runs[2]], [runs[2]]], None)
    assert 'class="muted"' not in render_html(build_run_comparison(plain)).partition("<body")[2]
