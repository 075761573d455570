"""Section on the sources of a record: their clocks, and the uplift drawn over the passages."""

from collections.abc import Sequence

from pantocheck.conformance.pages import document as doc
from pantocheck.conformance.pages.study_chart import draw_chart
from pantocheck.conformance.pages.words import format_value
from pantocheck.conformance.results.case_facts_format import SourceFacts

EXPLANATION = (
    "Time of the record: time of the source, plus the offset and the drift. The uncertainty is the half-width of the "
    "95 % interval; its effect is the component 'alignment' of the values."
)


def build_source_section(sources: Sequence[SourceFacts]) -> tuple[doc.Block, ...]:
    """Table and charts of the further sources of a record; nothing without them."""
    if not sources:
        return ()
    table = doc.make_table(
        sources,
        {
            doc.Column("Source", share=1): lambda source: doc.Code(source.name),
            doc.Column("Join"): lambda source: source.join,
            doc.Column("Rate [Hz]", number=True): lambda source: format_value(source.rate_Hz, 4),
            doc.Column("Offset [s]", number=True): lambda source: format_value(source.offset_s, 6),
            doc.Column("Uncertainty [s]", number=True): lambda source: format_value(source.uncertainty_s, 2),
            doc.Column("Drift [ppm]", number=True): lambda source: format_value(source.drift_ppm, 3),
            doc.Column("Check", share=2): lambda source: f"{source.state}: {source.finding}",
        },
    )
    charts = [source.chart for source in sources if source.chart is not None]
    figures = [doc.Figure(draw_chart(chart), chart.alternative, chart.caption, chart.wide) for chart in charts]
    drawn = (doc.Figures(tuple(figures)),) if figures else ()
    return (doc.Section("Sources of the record", (doc.Paragraph(EXPLANATION), table, *drawn)),)
