"""Shape of a line at rest for the drawing in a certificate."""

import json

import numpy as np
import pytest
from pydantic import ValidationError

from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.core.figure_data import DrawnCurve, LineShape
from pantocheck.conformance.line.catenary_model import discretise_line
from pantocheck.conformance.line.line_shape import THINNING_M, build_line_shape, find_deflection, thin_curve
from pantocheck.conformance.pages.line_figure import find_earlier_drawing, line_figures
from pantocheck.conformance.results.results_format import CaseResult, RunFacts

LARGEST_SHAPE = 15_000
"""Size budget of a shape in results.json [bytes]."""


@pytest.fixture(scope="module")
def shape_250() -> LineShape:
    [case] = select_cases(["en50318-2002/250"])
    return build_line_shape(case.line, case.analysed_spans, discretise_line(case.line, 0.5))


def test_shape_covers_the_section_and_one_span_on_either_side(shape_250: LineShape) -> None:
    """Spans 5 and 6 of 60 m are evaluated; each of four spans has nine droppers."""
    assert (shape_250.first_span, shape_250.last_span) == (4, 7)
    assert shape_250.supports_m == [180, 240, 300, 360, 420]
    assert shape_250.plan is None
    assert len(shape_250.side.droppers.x_m) == 36
    symbols = [point.symbol for point in shape_250.side.points]
    assert {symbol: symbols.count(symbol) for symbol in set(symbols)} == {"messenger support": 5, "steady arm": 5}


def test_thinned_wires_stay_close_to_the_wires(shape_250: LineShape) -> None:
    """The tolerance of four spans, and the rounding of both coordinates: 0.5 mm, and 5 mm at a slope of 0.1."""
    [case] = select_cases(["en50318-2002/250"])
    line = discretise_line(case.line, 0.5)
    x = np.linspace(180, 420, 481)
    for wire, curve in zip(line.catenary.wires, shape_250.side.curves, strict=True):
        drawn = np.interp(x, curve.x_m, curve.y_m)
        assert np.abs(drawn - find_deflection(line, wire.name, "z", x)).max() <= 4 * THINNING_M + 0.001
    assert len(shape_250.side.curves[1].x_m) < 120  # of 481 stations


@pytest.mark.parametrize("name", ["en50318-2018/ac-simple/320-twin", "en50318-2018/ac-stitched/275"])
def test_shape_of_twelve_spans_with_stagger_stays_small(name: str) -> None:
    *_, case = select_cases([name])
    line = discretise_line(case.line, case.file.discretisation.element_m)
    shape = build_line_shape(case.line, case.analysed_spans, line)
    assert shape.plan is not None
    assert shape.last_span - shape.first_span == 11
    assert len(json.dumps(shape.model_dump(mode="json"))) < LARGEST_SHAPE


def test_thinning_keeps_corners_and_drops_points_of_a_straight_line() -> None:
    x = np.arange(11.0)
    assert thin_curve(x, np.abs(x - 4), 1e-9).tolist() == [0, 4, 10]
    assert thin_curve(x, 2 * x, 1e-9).tolist() == [0, 10]


def test_lists_of_different_length_are_refused() -> None:
    with pytest.raises(ValidationError, match="lists of 2 and 1 numbers"):
        DrawnCurve(kind="contact_wire", x_m=[0, 1], y_m=[0])


def test_points_without_a_symbol_are_refused(shape_250: LineShape) -> None:
    """The pages draw the symbols that the results name; an element has its own."""
    stored = shape_250.model_dump()
    assert [symbol["name"] for symbol in stored["symbols"]] == ["messenger support", "steady arm"]
    with pytest.raises(ValidationError, match="points without a symbol: steady arm"):
        LineShape.model_validate(stored | {"symbols": stored["symbols"][:1]})


def test_equal_lines_are_drawn_once(shape_250: LineShape) -> None:
    def drawn_case(name: str, shape: LineShape | None, section: tuple[float, float] | None) -> CaseResult:
        return CaseResult.model_construct(id=name, line_shape=shape, run=RunFacts.model_construct(evaluated_m=section))

    case, second = (drawn_case(name, shape_250, (240.0, 360.0)) for name in ("first", "second"))
    [figure] = line_figures(case, ())
    assert figure.caption.startswith("Line at rest, spans 4 to 7: side view, heights enlarged.")
    assert line_figures(second, (case,)) == ()
    [text] = find_earlier_drawing(second, (case,))
    assert text.text == "Line: as drawn in first."
    side = shape_250.side
    points = [point.model_copy(update={"text": "12 kg"}) for point in side.points if point.symbol == "steady arm"]
    marked = shape_250.model_copy(update={"side": side.model_copy(update={"points": points})})
    [figure] = line_figures(drawn_case("marked", marked, None), ())
    assert figure.caption.endswith(f"enlarged. With texts: steady arm ({len(points)}).")
    foreign = drawn_case("third", None, None)
    assert line_figures(foreign, (case, foreign)) == ()
    assert find_earlier_drawing(foreign, (case, foreign)) == ()
