"""What a certificate says, before any format: every text ready to be printed, every figure drawn.

HTML and PDF are two settings of the same `Page`, so that they cannot differ in what they say.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class CriterionRow:
    """A row of the table of criteria; `source` counts from 1 in the case's `sources`."""

    quantity: str
    label: str
    pantograph: str
    value: str
    error: str
    unit: str
    limits: str
    margin: str
    bar: str
    bar_text: str
    verdict: str
    trust: str
    source: int | None
    remarks: tuple[str, ...]


@dataclass(frozen=True)
class QuantityTable:
    """A plain table: names of the columns, rows of (label, name of the quantity, unit, cells)."""

    columns: tuple[str, ...]
    rows: tuple[tuple[str, str, str, tuple[str, ...]], ...]


@dataclass(frozen=True)
class PlainTable:
    """A table of a study: names of the columns, rows of texts."""

    caption: str
    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


@dataclass(frozen=True)
class Figure:
    """A drawn figure, the sentence under it, and what it shows to who cannot see it."""

    svg: str
    alternative: str
    caption: str
    wide: bool


@dataclass(frozen=True)
class InputRow:
    """Where a group of inputs comes from."""

    group: str
    trust: str
    source: str


@dataclass(frozen=True)
class CaseSection:
    """One case of a certificate."""

    anchor: str
    id: str
    title: str
    verdict: str
    sentence: str
    criteria: tuple[CriterionRow, ...]
    error_name: str
    sources: tuple[str, ...]
    bands: QuantityTable
    quantities: QuantityTable
    skipped: tuple[tuple[str, str, str], ...]
    tables: tuple[PlainTable, ...]
    figures: tuple[Figure, ...]
    inputs: tuple[InputRow, ...]
    notes: tuple[str, ...]
    warnings: tuple[str, ...]
    facts: tuple[tuple[str, str], ...]


@dataclass(frozen=True)
class Reasons:
    """A heading and the sentences that explain a verdict."""

    heading: str
    sentences: tuple[str, ...]


@dataclass(frozen=True)
class Page:
    """A whole certificate."""

    title: str
    statement: str
    verdict: str
    headline: str
    trust: str
    trust_sentence: str
    system: str
    suite: str
    reasons: tuple[Reasons, ...]
    cases: tuple[CaseSection, ...]
    facts: tuple[tuple[str, str], ...]
