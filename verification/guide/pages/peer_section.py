"""Section on the comparisons with packages of others."""

from typing import Any

from pantocheck.conformance.pages import document as doc
from verification.guide.pages.topic_section import build_value_table, list_tolerance_reasons

PEER_SCOPE = (
    "Packages of others solve parts of the same problems. A comparison runs where its package is installed; no stored "
    "value replaces it."
)

INSTALL_LINE = "pip install 'pantocheck[peers]'"


def build_peer_section(peers: list[dict[str, Any]]) -> doc.Section:
    """Section with one part per package."""
    return doc.Section("Peers", (doc.Paragraph(PEER_SCOPE), *map(_build_peer, peers)), anchor="peers")


def _build_peer(peer: dict[str, Any]) -> doc.Section:
    blocks: tuple[doc.Block, ...] = (doc.Paragraph(peer["setting"]),)
    if peer["version"] is None:
        reason = (f"Not run: {peer['package']} is not installed. Install it with ", doc.Code(INSTALL_LINE), ".")
        blocks = (*blocks, doc.Paragraph(reason))
    else:
        version = f"Installed version: {peer['package']} {peer['version']}."
        rows = peer["comparisons"]
        blocks = (*blocks, doc.Paragraph(version), build_value_table(rows), list_tolerance_reasons(rows))
    return doc.Section(peer["title"], blocks)
