"""Highest frequency that the models of a case support: sentence, table, and grey rows of the values above it."""

from collections.abc import Sequence

from pantocheck.conformance.pages import document as doc
from pantocheck.conformance.pages.words import format_value
from pantocheck.conformance.quantities.bands import EXTENDED_BAND
from pantocheck.conformance.results.results_format import CaseResult
from pantocheck.conformance.results.supported_frequency import (
    UNKNOWN_FREQUENCY,
    SupportedFrequency,
    describe_supported,
    find_supported_Hz,
    is_supported,
)


def frequency_blocks(case: CaseResult) -> tuple[doc.Block, ...]:
    """Sentence on the highest supported frequency of every pantograph of a case; empty for a case without a model."""
    owners = [part.part.removeprefix("pantograph ") for part in case.supported if part.part.startswith("pantograph ")]
    texts = [f"pantograph {owner} {describe_supported(case.supported, owner)}" for owner in owners]
    lowest = find_supported_Hz(case.supported, "0")
    grey = "" if lowest is None or lowest >= EXTENDED_BAND.high else f" Grey: above {lowest:.3g} Hz, not supported."
    return (doc.SmallPrint(f"Highest supported frequency: {'; '.join(texts)}.{grey}"),) if texts else ()


def build_frequency_section(parts: Sequence[SupportedFrequency]) -> tuple[doc.Section, ...]:
    """Table of the highest supported frequency of every part of the model."""
    if not parts:
        return ()
    table = doc.make_table(
        parts,
        {
            doc.Column("Part of the model", share=1.5): lambda part: part.part,
            doc.Column("Supported up to [Hz]", number=True): lambda part: (
                UNKNOWN_FREQUENCY if part.frequency_Hz is None else format_value(part.frequency_Hz, 3)
            ),
            doc.Column("Follows from", share=4): lambda part: part.basis,
            doc.Column("Limits the values"): lambda part: "yes" if part.limits else "no",
        },
    )
    return (doc.Section("Supported frequencies", (table,), folded=True),)


def mute_row(
    parts: Sequence[SupportedFrequency], owner: str, row: tuple[doc.RichText, ...]
) -> tuple[doc.RichText, ...]:
    """Row of a table, grey if the quantity that its first cell names has content above the supported frequency."""
    named = row[0] if isinstance(row[0], tuple) else (row[0],)
    names = [part.text for part in named if isinstance(part, doc.Code)]
    return row if all(is_supported(parts, owner, name) for name in names) else tuple(map(mute_cell, row))


def mute_cell(cell: doc.RichText) -> doc.RichText:
    """Cell whose texts are grey."""
    if isinstance(cell, tuple):
        return tuple(doc.Muted(part) if isinstance(part, str) else part for part in cell)
    return doc.Muted(cell) if isinstance(cell, str) else cell
