"""Sections of a case on the events of its record: places of the line, and contact losses."""

from collections.abc import Mapping, Sequence

from pantocheck.conformance.reports import document as doc
from pantocheck.conformance.reports.page_text import replace_minus
from pantocheck.conformance.reports.words import name_pantograph
from pantocheck.conformance.results.case_facts_format import ContactLossFacts, EventFacts
from pantocheck.conformance.results.results_format import CaseResult

LISTED_LOSSES = 40
"""Largest number of contact losses in the table of a page; results.json lists more."""


def event_blocks(case: CaseResult) -> tuple[doc.Block, ...]:
    """Blocks on the events of a record; empty if it has none."""
    return (*_build_place_section(case.events or []), *_build_loss_section(case.contact_losses or {}))


def _build_loss_section(losses: Mapping[str, Sequence[ContactLossFacts]]) -> tuple[doc.Block, ...]:
    """Table of the longest contact losses."""
    rows = [(name_pantograph(key), loss) for key, found in losses.items() for loss in found]
    if not rows:
        return ()
    longest = sorted(rows, key=lambda row: -row[1].duration_s)[:LISTED_LOSSES]
    columns = (
        doc.Column("Pantograph", share=1),
        *(doc.Column(name, number=True) for name in ("Place [m]", "Time [s]", "Duration [ms]", "Lowest force [N]")),
    )
    cells = tuple(
        (
            name,
            f"{loss.position_m:.1f}",
            f"{loss.time_s:.3f}",
            f"{1000 * loss.duration_s:.4g}",
            replace_minus(f"{loss.lowest_force_N:.3g}"),
        )
        for name, loss in longest
    )
    text = (
        f"{len(rows)} contact losses in the unfiltered force, the longest first; a duration is a multiple of a sample."
    )
    blocks: list[doc.Block] = [doc.Paragraph(text), doc.Table(columns, cells)]
    if len(rows) > len(longest):
        blocks.append(doc.Paragraph("results.json lists up to 200 losses of each pantograph."))
    return (doc.Section("Contact losses", tuple(blocks)),)


def _build_place_section(events: Sequence[EventFacts]) -> tuple[doc.Block, ...]:
    """Table of the places of the line."""
    if not events:
        return ()
    columns = (
        doc.Column("Place", share=1),
        doc.Column("From [m]", number=True),
        doc.Column("To [m]", number=True),
        doc.Column("Evaluation", share=2),
    )
    rows = tuple(
        (
            " ".join(filter(None, (event.kind.replace("_", " "), event.name))),
            f"{event.start_m:.1f}",
            f"{event.end_m:.1f}",
            f"left out: {event.remark}" if event.excluded else event.remark or "evaluated",
        )
        for event in events
    )
    return (doc.Section("Events of the line", (doc.Table(columns, rows),)),)
