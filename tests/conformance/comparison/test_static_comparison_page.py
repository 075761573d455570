"""Report on measured static values: headline, caveats, criteria, figures of ten spans, and a table of all spans."""

from typing import Any

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from helpers.criterion_fixtures import COMPARED
from helpers.page_blocks import find_blocks
from pantocheck.conformance.pages import document as doc
from pantocheck.conformance.pages.comparison_page import build_comparison
from pantocheck.conformance.pages.static_sections import STATIC_PAGE, draw_static_values
from pantocheck.conformance.results.comparison_format import StaticComparison

SPAN = 60.0


def build_results(spans: int = 12, **changes: Any) -> StaticComparison:
    """Elasticities of 0.5 mm/N at the middle of every span but the third; span 5 differs by 0.2 mm/N."""
    numbers = [n for n in range(1, spans + 1) if n != 3]
    model = [0.5 if n != 5 else 0.7 for n in numbers]
    positions = [SPAN * (n - 0.5) for n in numbers]
    parts = [
        {
            "number": n, "start_m": SPAN * (n - 1), "end_m": SPAN * n, "values": int(n != 3),
            "measured": None if n == 3 else [0.5, 0.5], "model": None if n == 3 else [0.5, 0.5],
            "mean_difference": None if n == 3 else 0.0, "largest_difference": None if n == 3 else 0.0,
        }
        for n in range(1, spans + 1)
    ]  # fmt: skip
    values = {
        "name": "elasticity", "unit": "mm/N", "row": list(range(1, len(numbers) + 1)), "position_m": positions,
        "measured": [0.5] * len(numbers), "model": model, "difference": [value - 0.5 for value in model],
        "missing_rows": [12], "outlier_rows": [4], "mean_difference": 0.02, "rms_difference": 0.06, "spans": parts,
        "curve_position_m": positions, "curve": model,
    }  # fmt: skip
    criterion = {
        **COMPARED, "quantity": "elasticity_difference_mm_N", "unit": "mm/N", "value": 0.2, "upper": 0.1,
        "verdict": "fail", "reason": "0.1 mm/N above the upper limit, at 270 m", "margin": -1.0, "uncertainty": 1e-4,
    }  # fmt: skip
    content = {
        "suite": {"version": "1", "commit": None, "digest": "sha256:c"},
        "model": {"name": "My line", "digest": "sha256:a"},
        "record": {"name": "measured.csv", "digest": "sha256:b"}, "record_state": "unconfirmed", "verdict": "fail",
        "element_m": 0.5, "force_N": [60.0, 120.0], "evaluated_spans": [2, 11], "evaluated_m": [60.0, 660.0],
        "largest_distance_m": None, "values": [values], "criteria": [criterion], "note": None,
        "warnings": ["elasticity: no value in row 12"], **changes,
    }  # fmt: skip
    return StaticComparison.model_validate(content)


def test_page_states_verdict_caveats_and_every_span() -> None:
    document = build_comparison(build_results())
    assert isinstance(document.header, doc.VerdictHeader)
    assert (document.header.verdict, document.header.headline) == ("fail", STATIC_PAGE.headlines["fail"])
    (warnings,) = find_blocks(document.blocks, doc.WarningBox)
    assert warnings.sentences == (
        "elasticity: no value in row 12",
        "Largest difference of the elasticity [mm/N] lies near",
    )
    criteria, spans = find_blocks(document.blocks, doc.Table)
    assert criteria.rows[0][1:] == (
        "0.2000", "≤ 0.1", "0.00010", "not stated", doc.VerdictMark("fail"), "0.1 mm/N above the upper limit, at 270 m"
    )  # fmt: skip
    assert len(spans.rows) == 12
    assert spans.rows[2][3:] == ("0", "–", "–", "–", "–")
    (facts,) = find_blocks(document.blocks, doc.Facts)
    assert ("Static force of the elasticity", "60 N and 120 N") in facts.pairs
    assert ("Largest distance of measured positions", "not stated") in facts.pairs


@pytest.mark.parametrize(("spans", "figures"), [(4, 1), (10, 1), (12, 2), (21, 3)])
def test_ten_spans_stand_in_a_figure(spans: int, figures: int) -> None:
    results = build_results(spans, evaluated_m=[60.0, 180.0], evaluated_spans=[2, 3])
    (block,) = find_blocks(build_comparison(results).blocks, doc.Figures)
    assert len(block.figures) == figures


def paint(first: int, last: int, tolerance: float | None) -> list[Axes]:
    values = build_results().values[0]
    spans = values.spans[first - 1 : last]
    figure = draw_static_values.__wrapped__(values, spans, tolerance, (60.0, 660.0))  # type: ignore[attr-defined]
    assert isinstance(figure, Figure)
    return list(figure.axes)


def test_figure_shows_values_outliers_supports_tolerance_and_the_rest_of_the_line() -> None:
    """Spans 1 to 10, of which the third has no value: nine points, and a ring around row 4."""
    upper, lower = paint(1, 10, 0.1)
    for axes, level in ((upper, 0.5), (lower, 0.2)):
        points, ring = (line for line in axes.lines if line.get_marker() == "o")
        assert len(points.get_xdata()) == 9
        assert (ring.get_xdata()[0], ring.get_ydata()[0]) == (270.0, pytest.approx(level))
        supports = [line.get_xdata()[0] for line in axes.lines if line.get_linestyle() == ":"]
        assert supports == [SPAN * n for n in range(10)]
    assert upper.get_xlim() == (0.0, 600.0)
    # Spans 1 to 10 begin before the evaluated section, spans 11 and 12 end behind it.
    for spans, grey in (((1, 10), (0.0, 60.0)), ((11, 12), (660.0, 720.0))):
        for tolerance, bands in ((0.1, 1), (None, 0)):
            _, lower = paint(*spans, tolerance)
            boxes = [np.asarray(patch.get_extents().transformed(lower.transData.inverted())) for patch in lower.patches]
            sides = [tuple(np.round(box[:, 0], 6)) for box in boxes]
            assert grey in sides
            assert len(boxes) == 1 + bands
