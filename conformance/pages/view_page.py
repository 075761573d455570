"""Page of `pantocheck view`: the passages of results, as moving pictures where their wires are known."""

from pantocheck.conformance.pages import document as doc
from pantocheck.conformance.pages.case_figures import draw_case_figures
from pantocheck.conformance.pages.document_facts import name_system
from pantocheck.conformance.pages.passage_figure import ILLUSTRATION, draw_passage
from pantocheck.conformance.results.results_format import Results


def build_view(results: Results) -> doc.Document:
    """Page with the moving pictures of the cases; a case without one has the figures of its signals."""
    sections = []
    for number, case in enumerate(results.cases):
        anchor = f"case-{number + 1}"
        figures = tuple(draw_passage(case, number, anchor)) or tuple(draw_case_figures(case, number, anchor))
        if figures:
            blocks = (doc.Paragraph((doc.Code(case.id),)), doc.Figures(figures))
            sections.append(doc.Section(case.title, blocks, anchor=anchor))
    header = doc.PlainHeader("Passage", f"{name_system(results)}. {ILLUSTRATION}")
    return doc.Document("Passage", header, tuple(sections), results, doc.find_date(results))
