"""Pages as values: every report is composed once as a `Document`, which the HTML, PDF and Markdown writers render.

A new page element is a class here and one macro or function in each of `templates/elements.html`,
`templates/elements.typ` and `markdown.py`. The writers escape every text.
"""

import hashlib
import json
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, fields
from datetime import datetime
from typing import Any, Literal, TypeVar

from pantocheck.conformance.core.json_file import format_json
from pantocheck.conformance.core.reproducibility import read_source_date
from pantocheck.conformance.results.exploration_format import Exploration
from pantocheck.conformance.results.motion_format import LineScene
from pantocheck.conformance.results.report_files import Language
from pantocheck.conformance.results.results_format import Results

Row = TypeVar("Row")


@dataclass(frozen=True)
class Code:
    """A name or a value in typewriter letters."""

    text: str


@dataclass(frozen=True)
class Remark:
    """A remark below the text that it belongs to."""

    text: str


@dataclass(frozen=True)
class Muted:
    """A text in grey: a value that the model does not support."""

    text: str


@dataclass(frozen=True)
class Link:
    """A link to a place of the same page."""

    text: str
    anchor: str


@dataclass(frozen=True)
class PageLink:
    """A link to another page of the same site; the address is relative and made by this project."""

    text: str
    address: str


@dataclass(frozen=True)
class VerdictMark:
    """A verdict with its symbol."""

    verdict: str


@dataclass(frozen=True)
class TrustMark:
    """A level of trust with its symbol; empty: none."""

    trust: str


@dataclass(frozen=True)
class Drawing:
    """A small drawing in a line of text, made by this project from numbers alone."""

    svg: str
    alternative: str


Inline = str | Code | Remark | Muted | Link | PageLink | VerdictMark | TrustMark | Drawing
RichText = Inline | tuple[Inline, ...]


@dataclass(frozen=True)
class Paragraph:
    """A paragraph."""

    text: RichText


@dataclass(frozen=True)
class SmallPrint:
    """An explanation in small letters beside a table."""

    text: RichText


@dataclass(frozen=True)
class CodeBlock:
    """Lines of a file, to be copied; their line breaks are kept."""

    code: str


@dataclass(frozen=True)
class BulletList:
    """A list of sentences."""

    items: tuple[RichText, ...]


@dataclass(frozen=True)
class NumberedList:
    """A list that a table refers to: item n has the number [n] and the anchor `<anchor>-<n>`."""

    label: str
    items: tuple[str, ...]
    anchor: str


@dataclass(frozen=True)
class WarningBox:
    """Caveats for the reader, in a coloured box."""

    sentences: tuple[str, ...]


@dataclass(frozen=True)
class Facts:
    """Names and values. The PDF omits the times of the run, so that two runs of the same input give the same bytes."""

    pairs: tuple[tuple[str, str], ...]
    times: tuple[tuple[str, str], ...] = ()


TableLayout = Literal["text", "grid", "cards", "values"]
"""Rows with a heading cell; a dense grid of values; criteria with drawings; graded values, on paper one line each. On a
narrow screen, all but the grid become cards."""


@dataclass(frozen=True)
class Column:
    """A column of a table."""

    heading: str
    share: float = 0.0
    """Share of the remaining width on paper; 0: as wide as its content."""
    number: bool = False
    """Whether the column holds numbers, which are aligned to the right and never broken."""
    short: str = ""
    """Heading on paper where the column is narrow; empty: the same heading."""
    choice: Literal["", "value", "date"] = ""
    """Filter of the rows in HTML: by one of the values, or by a date in the period of a cell, such as `A to B`."""


@dataclass(frozen=True)
class Table:
    """Rows of cells below their headings."""

    columns: tuple[Column, ...]
    rows: tuple[tuple[RichText, ...], ...]
    caption: str = ""
    """Text above the table; empty if the heading of its section says enough."""
    layout: TableLayout = "text"


@dataclass(frozen=True)
class Curves:
    """Place of the curves of a figure in the results or scenes of a page, from which its script draws them again."""

    shown: Literal["force", "uplift", "measured", "passage"]
    case: int
    """Index of the case in `cases`, or of the scene."""
    owner: str = "0"
    """Key of the pantograph in `traces`; "0": the line."""
    supported_Hz: float | None = None
    """Frequency above which a spectrum is grey [Hz]; None: nowhere."""


@dataclass(frozen=True)
class Figure:
    """A figure as SVG, its alternative text and its caption; two that are not wide stand side by side."""

    svg: str
    alternative: str
    caption: str
    wide: bool = True
    anchor: str = ""
    """Name of the figure as the target of a link; empty: none."""
    curves: Curves | None = None
    """None: the figure has no curves in the results of the document."""


@dataclass(frozen=True)
class Figures:
    """Block of a document: figures, shown in this order."""

    figures: tuple[Figure, ...]


@dataclass(frozen=True)
class Section:
    """A heading and the blocks below it; a section with an anchor can be the target of a link."""

    heading: str
    blocks: "tuple[Block, ...]"
    anchor: str = ""
    ruled: bool = False
    """Whether a rule stands above the heading: the section of a case."""
    folded: bool = False
    """Whether the blocks are hidden on a screen until the reader opens the section; on paper they always stand."""


@dataclass(frozen=True)
class Answers:
    """Answers of page 1 in their order: their headings stand beside short blocks; figures and values take the width."""

    sections: tuple[Section, ...]


Block = (
    Answers
    | Paragraph
    | SmallPrint
    | CodeBlock
    | BulletList
    | NumberedList
    | WarningBox
    | Facts
    | Table
    | Figures
    | Section
)


@dataclass(frozen=True)
class PlainHeader:
    """Head of a report that judges nothing: its heading and its result in one sentence."""

    heading: str
    headline: str


@dataclass(frozen=True)
class VerdictHeader:
    """Head of a report with a verdict."""

    heading: str
    verdict: str
    statement: str
    """Nature of the report, printed on every page."""
    headline: str
    """The verdict in one sentence."""
    subject: str
    """System, suite and trust in sentences."""
    footer: str
    """Suite and system, printed at the foot of every page."""


@dataclass(frozen=True)
class Document:
    """A whole report: warnings and sections below a header."""

    title: str
    """Title in the metadata of the file."""
    header: PlainHeader | VerdictHeader
    blocks: tuple[Block, ...]
    results: Results | None = None
    """Results to be embedded in the HTML and in the PDF, which then bear the date; None: neither."""
    date: int = 0
    """Date of the document [s since 1970]; 0: not known."""
    language: Language = "en"
    """Language of its pages; its texts are English until a writer translates them."""
    scenes: tuple[LineScene, ...] = ()
    """Moving pictures of a document without results, to be embedded in the HTML."""
    exploration: Exploration | None = None
    """Sliders of an explorer, to be embedded in the HTML."""


def to_plain(value: Any) -> Any:
    """The parts of a document as dictionaries and lists for a template; `kind` names the class of each part."""
    if isinstance(value, tuple):
        return [to_plain(item) for item in value]
    if hasattr(value, "__dataclass_fields__"):
        parts = {field.name: to_plain(getattr(value, field.name)) for field in fields(value)}
        return {"kind": type(value).__name__} | parts
    return value


def make_table(
    records: Iterable[Row],
    cells: Mapping[Column, Callable[[Row], RichText]],
    caption: str = "",
    layout: TableLayout = "text",
) -> Table:
    """A table with one row per record, and the content of each column."""
    rows = tuple(tuple(cell(record) for cell in cells.values()) for record in records)
    return Table(tuple(cells), rows, caption, layout)


def make_grid(caption: str, records: Iterable[Row], cells: Mapping[str, Callable[[Row], str]]) -> Table:
    """A dense table of values: one row per record, one column per heading; the last takes the remaining width."""
    last = len(cells) - 1
    columns = {Column(heading, share=int(n == last)): cell for n, (heading, cell) in enumerate(cells.items())}
    return make_table(records, columns, caption, "grid")


def warn(sentences: Iterable[str]) -> tuple[WarningBox, ...]:
    """Box of caveats; nothing without sentences."""
    listed = tuple(sentences)
    return (WarningBox(listed),) if listed else ()


def select_facts(facts: Mapping[str, str | None]) -> Facts:
    """Facts that have a text."""
    return Facts(tuple((name, text) for name, text in facts.items() if text))


def build_plain_document(heading: str, headline: str, blocks: Iterable[Block]) -> Document:
    """Report that judges nothing, with its heading as the title of the file."""
    return Document(heading, PlainHeader(heading, headline), tuple(blocks))


# Results inside a certificate, from which it can be made again: one home for their selection and encoding.
#
# The PDF has an attachment, the HTML page a data block. Both keep the order of the results, which is that of the rows
# of the pages. The PDF omits the times of the run, so that two runs of the same input give the same bytes. The HTML
# page prints these times, so its data block keeps them.
SCENES_ID = "pantocheck-scenes"
"""Identity of the data block of the moving pictures of a page without results."""

ESCAPES = str.maketrans({character: f"\\u{ord(character):04x}" for character in "<>&"})
"""Escapes of JSON for the characters that could end the data block or begin a comment in it."""


def strip_times(results: Results) -> Results:
    """Results whose times are null, so that two runs of the same input give the same certificate."""
    cases = [case.model_copy(update={"run": case.run.model_copy(update={"wall_s": None})}) for case in results.cases]
    return results.model_copy(update={"started": None, "cases": cases})


def encode_attachment(results: Results) -> bytes:
    """Attachment of the PDF: results without times as JSON text in ASCII; equal results give equal bytes."""
    return (format_json(strip_times(results).to_dict()) + "\n").encode("ascii")


def digest_results(results: Results) -> str:
    """SHA-256 of the attachment of the PDF; both formats of a certificate state it."""
    return f"sha256:{hashlib.sha256(encode_attachment(results)).hexdigest()}"


def encode_data_block(results: Results) -> str:
    """Content of the data block of the HTML page: results as JSON text in ASCII without `<`, `>` and `&`."""
    return _encode(results.to_dict())


def encode_exploration(exploration: Exploration) -> str:
    """Content of the data block of an explorer."""
    return _encode(exploration.model_dump(mode="json"))


def encode_scenes(scenes: Iterable[LineScene]) -> str:
    """Content of the data block of moving pictures, in the form of the cases of results."""
    return _encode({"cases": [scene.model_dump(mode="json") for scene in scenes]})


def _encode(tree: object) -> str:
    return json.dumps(tree, separators=(",", ":"), allow_nan=False).translate(ESCAPES)


def find_date(results: Results) -> int:
    """Date of a document [s since 1970]: `SOURCE_DATE_EPOCH`, else the start of the run, else 0.

    Raises:
        InputError: `SOURCE_DATE_EPOCH` is not a number of seconds.
    """
    date = read_source_date()
    if date is not None:
        return date
    started = results.started
    return int(datetime.fromisoformat(started).timestamp()) if started else 0
