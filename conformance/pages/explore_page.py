"""Page of `pantocheck explore`: headings whose parts a script fills from the answers of the simulator."""

from pantocheck.conformance.pages import document as doc
from pantocheck.conformance.results.exploration_format import Exploration

NO_CERTIFICATE = (
    "Nothing on this page is a certificate, a report or a verdict. It shows single simulations of one mesh, without "
    "their uncertainty, beside limits that hold for the inputs of the case alone."
)

EXPLORER_PARTS = {
    "inputs": "Inputs",
    "values": "Values",
    "bands": "Force by frequency band",
    "force": "Contact force",
    "picture": "Moving picture",
    "save": "Save",
}
"""Headings by the anchors that the script knows."""


def build_explorer(exploration: Exploration) -> doc.Document:
    """Page of an explored case."""
    waiting = doc.Paragraph(("This part needs the scripts of the page.",))
    sections = tuple(doc.Section(heading, (waiting,), anchor=anchor) for anchor, heading in EXPLORER_PARTS.items())
    header = doc.PlainHeader("Explore", exploration.title)
    caveat, name = doc.WarningBox((NO_CERTIFICATE,)), doc.Paragraph((doc.Code(exploration.id),))
    return doc.Document("Explore", header, (caveat, name, *sections), exploration=exploration)
