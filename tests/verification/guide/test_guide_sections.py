"""Pages and sections of the guide on given numbers: counts, largest differences, words for a part that was not run."""

import re
from typing import Any

import pytest

from pantocheck.conformance.core.figure_data import Chart
from pantocheck.conformance.pages import study_chart
from pantocheck.conformance.pages.html import render_html
from pantocheck.conformance.pages.markdown import render_markdown
from verification.guide.guide_building import list_deviations
from verification.guide.guide_format import Guide
from verification.guide.guide_values import count_results, list_guide_values
from verification.guide.pages import validation_section
from verification.guide.pages.guide_page import build_guide_page


def _converged(quantity: str, value: float, discretisation: float, pantograph: int = 1) -> dict[str, Any]:
    return {
        "quantity": quantity, "pantograph": pantograph, "value": value, "discretisation": discretisation, "first": 20.0,
        "second": 20.0, "half_width": 0.1, "lower": 19.0, "upper": 21.0, "inside": 19.0 <= value <= 21.0,
    }  # fmt: skip


def _published(value: float | None, role: str | None = None) -> dict[str, Any]:
    verdict = "skip" if value is None else "pass" if 10.0 <= value <= 30.0 else "fail"
    texts = {"section": "4", "sentence": "a sentence", "tolerance": "as printed", "outcome": "not_evaluated"}
    return {
        "quantity": "std_force_N", "pantograph": 1, "item": None, "unit": "N", "trust": "primary", "source": "a book",
        "lower": 10.0, "upper": 30.0, "value": value, "uncertainty": 0.5, "verdict": verdict, "reason": None,
        "margin": None, "discretisation_error": None, "finding": None if role is None else texts | {"role": role},
    }  # fmt: skip


def _fault(name: str, detected: bool, required: bool = True) -> dict[str, Any]:
    verdict = "fail" if detected else "pass"
    parts = {"verdict": verdict, "detected_by": "content" if detected else "", "must_be_detected": required}
    return {"name": name, "case": "a/b", "detected": detected, **parts}


@pytest.fixture
def data(guide: Guide) -> dict[str, Any]:
    """A guide with two pantographs, a part of every section and known numbers."""
    content = guide.model_dump(mode="json", by_alias=True)
    content["library"] = [
        {
            "case": "own/twin", "title": "Two pantographs", "edition": None, "superseded_by": None,
            "input_digest": "sha256:0", "quantities": {"1": {"std_force_N": 20.3}, "2": {"std_force_N": 18.0}},
            "published": [_published(20.3), _published(31.0), _published(None, "held_out")],
            "converged": [_converged("std_force_N", 20.3, 0.4), _converged("std_force_N", 18.0, 0.5, 2)],
            "simulated_s": 10.0, "wall_s": 1.0,
        },
    ]  # fmt: skip
    content["peers"] = [
        {"package": "exudyn", "version": None, "title": "Exudyn", "setting": "A line.", "comparisons": []}
    ]
    content["self_test"] = {
        "reference": {"a/b": "pass"},
        "records": [_fault("gain", True), _fault("delay", False), _fault("small gain", False, required=False)],
        "numerical": [_fault("coarse mesh", True)],
    }
    timing = {"case": "own/twin", "pantographs": 2, "simulated_s": 10.0, "process_s": 0.5, "ratio": 0.05}
    content["performance"] = {"processor": "Some processor", "cores": 2, "timings": [timing]}
    return content


def test_page_states_the_numbers_of_every_section(data: dict[str, Any]) -> None:
    """Differences of 1.5 % and 10 % from the second formulation; 1 of 2 within its half-width."""
    text = render_markdown(build_guide_page(data)).replace("\\", "")
    for sentence in (
        "1 of 2 values lie inside the limits of the verification",
        "differ from the second formulation by at most 10 %",
        "1 of 2 differences lie within their half-width (50.0 %; target 95 %)",
        "1 of 3 values lie inside their published range",
        "1 of 2 faults of records and 1 of 1 numerical faults that must be detected are detected",
        "Not run: exudyn is not installed. Install it with `pip install 'pantocheck[peers]'`",
        "Machine: Some processor, 2 cores.",
        "Records of other systems",
        "Digest of the inputs: sha256:0.",
    ):
        assert sentence in text, sentence
    assert "| own/twin | 2 | 10.0 | 0.500 | 0.050 |" in text


def test_values_counts_and_deviations_are_those_of_the_sections(data: dict[str, Any]) -> None:
    assert list_deviations(Guide.model_validate(data)) == ["library/own/twin/2/std_force_N", "self-test/delay/a/b"]
    guide = Guide.model_validate(data)
    counts = count_results(guide)
    expected = {"published_agreeing": 1, "published": 3, "contained_agreeing": 1, "contained": 2, "faults_records": 2}
    assert {name: counts[name] for name in expected} == expected
    values = list_guide_values(guide)
    assert values["library/own/twin/2/std_force_N/value"] == 18.0
    assert values["library/own/twin/2/std_force_N/discretisation"] == 0.5
    assert values["library/own/twin/1/std_force_N/uncertainty"] == 0.5
    assert values["counts/faults_records_agreeing"] == 1.0
    assert not [name for name in values if "performance" in name or "wall" in name]


def test_guide_without_self_test_and_timings_is_complete(data: dict[str, Any]) -> None:
    """Both parts may have failed; the failure stands on the page."""
    failed = [{"part": "self-test/all", "reason": "RuntimeError: no record"}]
    changed = {**data, "self_test": None, "performance": None, "failed": failed}
    text = render_markdown(build_guide_page(changed)).replace("\\", "")
    assert "Not computed: self-test/all: RuntimeError: no record" in text
    assert "## Self-test" not in text
    assert "self-test/all" in list_deviations(Guide.model_validate(changed))


def test_scatter_plot_marks_and_names_the_values_outside_their_range(
    data: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Three ranges of 10 N to 30 N: only the value of 31 N lies outside."""
    data["library"][0]["published"] = [_published(20.3), _published(31.0), _published(25.0)]
    charts: list[Chart] = []

    def keep_chart(chart: Chart, y_range: tuple[float, float]) -> str:
        charts.append(chart)
        return study_chart.draw_chart(chart, y_range)

    monkeypatch.setattr(validation_section, "draw_chart", keep_chart)
    text = render_markdown(build_guide_page(data)).replace("\\", "")
    [crosses] = [series for series in charts[-1].series if series.style == "crosses"]
    assert (crosses.x, crosses.y) == ([31.0], [20.0])
    assert "Outside their range: own/twin: " in text


# Pages of the guide: their numbers are those of guide.json, and a number outside its range is shown.
def _dump(guide: Guide) -> dict[str, Any]:
    return guide.model_dump(mode="json", by_alias=True)


def test_static_case_of_the_guide_reproduces_its_published_lengths(guide: Guide) -> None:
    """All nine dropper lengths within 1 mm, and the elasticity of both formulations within 0.1 %."""
    (case,) = guide.library
    assert [row.verdict for row in case.published] == ["pass"] * 9
    assert {row.quantity for row in case.published} == {"dropper_length_m"}
    elasticity = next(row for row in case.converged if row.quantity == "elasticity_mm_N")
    assert elasticity.value == pytest.approx(elasticity.second, rel=1e-3)
    assert elasticity.inside
    assert list_deviations(guide) == []


def test_page_prints_the_numbers_of_the_guide(guide: Guide) -> None:
    text = render_markdown(build_guide_page(_dump(guide)))
    assert "11 of 11 comparisons" not in text
    topics = guide.verification.values()
    count = sum(len(topic.comparisons) + len(topic.convergence) for topic in topics)
    assert f"{count} of {count} comparisons with closed forms agree" in text
    assert "9 of 9 values lie inside their published range" in text
    assert "1.01431" in text  # first frequency of the wire, sqrt(T k^2 + EI k^4) / m
    assert guide.suite.digest is not None
    assert guide.suite.digest in text.replace("\\", "")
    page = render_html(build_guide_page(_dump(guide)))
    figures = re.findall(r'<svg role="img" aria-label="([^"]*)"', page)
    studies = sum(len(topic.convergence) + len(topic.charts) for topic in guide.verification.values())
    assert len(figures) == studies + 1  # the scatter plot of dropper lengths
    assert all(len(text) > 40 for text in figures)


def test_wrong_number_turns_its_row_and_the_result(guide: Guide) -> None:
    data = _dump(guide)
    row = data["verification"]["wire-frequencies"]["comparisons"][0]
    row.update(computed=1.1 * row["computed"], agrees=False)
    data["library"][0]["published"][0].update(value=2.0, verdict="fail")
    data["failed"] = [{"part": "verification/waves", "reason": "ValueError: no value"}]
    changed = Guide.model_validate(data)
    assert list_deviations(changed) == ["verification/wire-frequencies/mode-1", "verification/waves"]
    text = render_markdown(build_guide_page(data))
    assert "8 of 9 values lie inside" in text
    assert text.count("| NO |") == 1
    assert "Not computed: verification/waves: ValueError: no value" in text.replace("\\", "")
