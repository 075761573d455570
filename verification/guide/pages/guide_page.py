"""Verification and validation guide, from guide.json."""

from typing import Any

from pantocheck.conformance.pages import document as doc
from pantocheck.conformance.pages.words import clean_tree
from verification.guide.guide_format import INSIDE
from verification.guide.pages.confidence_sections import (
    build_limitations_section,
    build_performance_section,
    build_self_test_section,
    build_uncertainty_section,
    mark_code,
)
from verification.guide.pages.formulation_section import build_formulation_section
from verification.guide.pages.topic_section import build_peer_section, build_topic_section
from verification.guide.pages.validation_section import build_validation_section

GUIDE_SCOPE = (
    "All numbers of this guide were computed by the command `python -m verification.guide` with the version below. "
    "Verification asks whether the equations are solved correctly; validation asks whether the values are those of "
    "publications."
)


def build_guide_page(guide: dict[str, Any]) -> doc.Document:
    """The guide on the content of guide.json."""
    guide = clean_tree(guide)
    sections = (
        _build_verification(guide["verification"]),
        build_formulation_section(guide),
        build_peer_section(guide["peers"]),
        build_validation_section(guide["library"]),
        build_uncertainty_section(guide["library"]),
        *build_self_test_section(guide["self_test"]),
        *build_performance_section(guide["performance"]),
        build_limitations_section(guide["limitations"]),
    )
    header = doc.PlainHeader("Verification and validation guide", _build_headline(guide))
    blocks: tuple[doc.Block, ...] = (
        doc.Paragraph(mark_code(GUIDE_SCOPE)),
        doc.Facts(_list_facts(guide)),
        *_list_failures(guide["failed"]),
        *sections,
    )
    return doc.Document(header.heading, header, blocks)


def _build_headline(guide: dict[str, Any]) -> str:
    topics = guide["verification"].values()
    rows = [row for topic in topics for row in (*topic["comparisons"], *topic["convergence"])]
    published = [row for case in guide["library"] for row in case["published"]]
    return (
        f"{sum(row['agrees'] for row in rows)} of {len(rows)} comparisons with closed forms agree within their "
        f"tolerance; {sum(row['verdict'] in INSIDE for row in published)} of {len(published)} values lie inside their "
        "published range."
    )


def _build_verification(topics: dict[str, Any]) -> doc.Section:
    sections = tuple(build_topic_section(name, topic) for name, topic in topics.items())
    text = "Each topic has a closed form that shares no code with the simulator. Relative deviations have no unit."
    return doc.Section("Verification against closed forms", (doc.Paragraph(text), *sections), anchor="verification")


def _list_facts(guide: dict[str, Any]) -> tuple[tuple[str, str], ...]:
    suite, platform = guide["suite"], guide["platform"]
    software = ", ".join(f"{name} {platform[name]}" for name in ("numpy", "scipy", "core"))
    return (
        ("Suite", f"Pantocheck {suite['version']}"),
        ("Commit", suite["commit"] or "not known"),
        ("Digest of the suite", suite["digest"]),
        ("Python", platform["python"]),
        ("Libraries", software),
        ("Machine", f"{platform['system']}, {platform['machine']}"),
        ("Date", guide["created"]),
    )


def _list_failures(failed: list[dict[str, Any]]) -> tuple[doc.Block, ...]:
    """Warnings on parts that could not be computed."""
    if not failed:
        return ()
    return (doc.WarningBox(tuple(f"Not computed: {part['part']}: {part['reason']}" for part in failed)),)
