"""Pages of the guide: their numbers are those of guide.json, and a number outside its range is shown."""

import re
from typing import Any

import pytest

from pantocheck.conformance.pages.html import render_html
from pantocheck.conformance.pages.markdown import render_markdown
from verification.guide.guide_building import list_deviations
from verification.guide.guide_format import Guide
from verification.guide.pages.guide_page import build_guide_page


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
