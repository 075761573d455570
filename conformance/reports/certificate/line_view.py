"""Drawing of the line of a case; a drawing that an earlier case has is named only."""

from pantocheck.conformance.counted_noun import count_noun
from pantocheck.conformance.reports.document import Figure, SmallPrint
from pantocheck.conformance.reports.figures.line_figure import draw_line_shape
from pantocheck.conformance.results.results_format import CaseResult


def line_figures(case: CaseResult, earlier: tuple[CaseResult, ...]) -> tuple[Figure, ...]:
    """Drawing of the line at rest; none without its shape, or if an earlier case has the same drawing.

    Args:
        case: The case.
        earlier: Cases that stand before it in the report.
    """
    shape = case.line_shape
    if shape is None or _find_equal(case, earlier) is not None:
        return ()
    views = "side view" if shape.plan is None else "side view and plan view"
    masses = sum(point.symbol == "mass" for point in shape.side.points)
    parts = f" {count_noun(masses, 'point mass', 'point masses')}." if masses else ""
    section = case.run.evaluated_m
    ground = "" if section is None else " Grey ground: analysis section."
    caption = f"Line at rest, spans {shape.first_span} to {shape.last_span}: {views}, heights enlarged.{parts}{ground}"
    return (Figure(draw_line_shape(shape, section), caption, caption),)


def line_reference(case: CaseResult, earlier: tuple[CaseResult, ...]) -> tuple[SmallPrint, ...]:
    """Name of the earlier case that has the drawing of this one; parameters as in `line_figures`."""
    other = _find_equal(case, earlier)
    return () if other is None else (SmallPrint(f"Line: as drawn in {other}."),)


def _find_equal(case: CaseResult, earlier: tuple[CaseResult, ...]) -> str | None:
    """Id of the first earlier case with the same line and analysis section."""
    if case.line_shape is None:
        return None
    drawn = (case.line_shape, case.run.evaluated_m)
    return next((other.id for other in earlier if (other.line_shape, other.run.evaluated_m) == drawn), None)
