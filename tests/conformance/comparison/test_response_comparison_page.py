"""Report on measured responses of a pantograph: headline, caveats, criteria, figure and table of each response."""

from typing import Any

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from helpers.criterion_fixtures import COMPARED
from helpers.page_blocks import find_blocks
from pantocheck.conformance.core.criterion import Criterion
from pantocheck.conformance.pages import document as doc
from pantocheck.conformance.pages.comparison_page import build_comparison
from pantocheck.conformance.pages.pantograph_pages import RESPONSE_PAGE, draw_response, select_drawn_rows
from pantocheck.conformance.results.comparison_format import RESPONSE_QUANTITIES, ComparedResponse, ResponseComparison

FREQUENCY = [1.0, 10.0, 40.0]

DEVIATIONS = (8.0, 4.0, 10.6, 8.0, 4.0)


def build_response(**changes: Any) -> dict[str, Any]:
    """Three rows, 8 % and 4 degrees off; no value between 5 and 20 Hz in the second band."""
    empty = {
        "rows": 0, "missing": "no value in row 2", "deviations": {}, "uncertainty": {}, "largest_modulus_at_Hz": None,
        "largest_phase_at_Hz": None, "beyond_uncertainty_pct": None,
    }  # fmt: skip
    full = {
        "rows": 1, "missing": None, "deviations": dict(zip(RESPONSE_QUANTITIES, DEVIATIONS, strict=True)),
        "uncertainty": dict.fromkeys(RESPONSE_QUANTITIES, 2.0), "largest_modulus_at_Hz": 1.0,
        "largest_phase_at_Hz": 1.0, "beyond_uncertainty_pct": 100.0,
    }  # fmt: skip
    return {
        "name": "at-70N.csv", "digest": "sha256:a", "kind": "apparent_mass", "unit": "kg", "static_force_N": 70.0,
        "height_m": 1.2, "excited_at": "head_centre", "measured_at": "head_centre", "is_graded": True,
        "source": "test 12", "note": None, "row": [1, 2, 3], "missing_rows": [],
        "measured": {"frequency_Hz": FREQUENCY, "modulus": [20.0, 6.0, 7.0], "phase_deg": [-40.0, -5.0, -1.0]},
        "modulus_uncertainty_pct": [2.0] * 3, "phase_uncertainty_deg": [1.0] * 3,
        "modulus_deviation_pct": [8.0] * 3, "phase_deviation_deg": [4.0] * 3,
        "model": {"frequency_Hz": FREQUENCY, "modulus": [21.6, 6.5, 7.6], "phase_deg": [-36.0, -1.0, 3.0]},
        "bands": [
            {"band_Hz": band, **part}
            for band, part in (([0.5, 5.0], full), ([5.0, 20.0], empty), ([20.0, 50.0], full))
        ],
        **changes,
    }  # fmt: skip


def build_results(**changes: Any) -> ResponseComparison:
    """One response, one limit that fails and one without a response."""
    common = COMPARED | {"quantity": "complex_deviation_pct", "unit": "%", "upper": 5.0, "source": "plan 3"}
    failed = {
        "where": {"band_Hz": [0.5, 5.0], "record": "at-70N.csv", "static_force_N": 70.0, "height_m": 1.2},
        "value": 10.6,
        "verdict": "fail", "reason": "5.6 % above the upper limit", "margin": -1.12,
        "limit_uncertainty": 2.0,
    }  # fmt: skip
    skipped = {
        "where": {"band_Hz": [0.5, 5.0], "static_force_N": 90.0}, "value": None,
        "verdict": "skip", "reason": "no response", "margin": None, "close": [],
    }  # fmt: skip
    content = {
        "suite": {"version": "1", "commit": None, "digest": "sha256:c"},
        "model": {"name": "My pantograph", "digest": "sha256:b"}, "record_state": "unconfirmed", "verdict": "fail",
        "responses": [build_response()], "criteria": [common | failed, common | skipped], "warnings": ["a caveat"],
        **changes,
    }  # fmt: skip
    return ResponseComparison.model_validate(content)


def test_page_states_verdict_caveats_criteria_and_bands() -> None:
    document = build_comparison(build_results())
    assert isinstance(document.header, doc.VerdictHeader)
    assert (document.header.verdict, document.header.headline) == ("fail", RESPONSE_PAGE.headlines["fail"])
    (warnings,) = find_blocks(document.blocks, doc.WarningBox)
    name = "RMS complex deviation, 0.5 to 5 Hz, 70 N, 1.2 m [%]"
    assert warnings.sentences == ("a caveat", f"{name} lies near")
    criteria, bands = find_blocks(document.blocks, doc.Table)
    assert criteria.rows[0] == (
        name, "10.60", "≤ 5", "2.0", doc.VerdictMark("fail"), "plan 3", "5.6 % above the upper limit"
    )  # fmt: skip
    assert criteria.rows[1][:4] == ("RMS complex deviation, 0.5 to 5 Hz, 90 N [%]", "–", "≤ 5", "not stated")
    assert bands.rows[0] == (
        "0.5 to 5", "1", "8.00 ± 2.0", "4.00 ± 2.0", "10.6 ± 2.0", "8.00 at 1.00 Hz", "4.00 at 1.00 Hz", "100", "–"
    )  # fmt: skip
    assert bands.rows[1] == ("5 to 20", "0", "–", "–", "–", "–", "–", "–", "no value in row 2")
    response = build_response(is_graded=False, height_m=None, excited_at="left_strip")
    document = build_comparison(build_results(responses=[response], criteria=[], warnings=[]))
    assert find_blocks(document.blocks, doc.WarningBox) == []
    headings = [block.heading for block in document.blocks if isinstance(block, doc.Section)]
    assert headings == ["at-70N.csv: 70 N (informative)"]
    facts = dict(pair for block in find_blocks(document.blocks, doc.Facts) for pair in block.pairs)
    assert facts["Force and motion"] == "left strip and head centre"


def paint(content: dict[str, Any], limits: tuple[Criterion, ...]) -> list[Axes]:
    response = ComparedResponse.model_validate(content)
    figure = draw_response.__wrapped__(response, list(limits))  # type: ignore[attr-defined]
    assert isinstance(figure, Figure)
    return list(figure.axes)


def test_figure_shows_error_bars_curve_bands_and_limits() -> None:
    modulus, phase, deviation = paint(build_response(), build_results().criteria[:1])
    for axes, key, half in ((modulus, "modulus", 0.4), (phase, "phase_deg", 1.0)):
        curve, points = axes.lines[0], axes.containers[0]
        assert list(curve.get_ydata()) == build_response()["model"][key]
        first = build_response()["measured"][key][0]
        segment = points[2][0].get_segments()[0]
        assert sorted(segment[:, 1]) == pytest.approx(sorted((first - half, first + half)))
    steps = [line for line in deviation.lines if len(line.get_xdata()) == 2 and line.get_ydata()[0] in {10.6, 5.0}]
    assert [list(line.get_xdata()) for line in steps] == [[0.5, 5.0], [20.0, 50.0], [0.5, 5.0]]
    modulus, _, _ = paint(build_response(modulus_uncertainty_pct=[], phase_uncertainty_deg=[]), ())
    assert modulus.containers[0].has_yerr is False
    # 20,000 linear rows: at most one of each 400 parts of the logarithmic axis, the first row included.
    frequency = np.arange(0.5, 50, 0.0025)
    rows = select_drawn_rows(list(frequency))
    assert (rows[0], len(rows) <= 401) == (0, True)
    assert np.diff(np.log(frequency[rows])).max() < 0.024
    assert select_drawn_rows([1.0, 10.0, 40.0]) == [0, 1, 2]
    assert select_drawn_rows([2.0]) == [0]
