"""Section of a case on the events of its record."""

from typing import Any

from pantocheck.conformance.reports import document as doc


def event_blocks(case: dict[str, Any]) -> tuple[doc.Block, ...]:
    """Blocks on the events of a record; empty if it states none."""
    events = case.get("events") or []
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
            " ".join(filter(None, (event["kind"].replace("_", " "), event["name"]))),
            f"{event['start_m']:.1f}",
            f"{event['end_m']:.1f}",
            f"left out: {event['remark']}" if event["excluded"] else event["remark"] or "evaluated",
        )
        for event in events
    )
    return (doc.Section("Events of the line", (doc.Table(columns, rows),)),)
