"""A document as Markdown, for the page of a CI job and for the documentation; every text is escaped."""

import re
from collections.abc import Iterable, Iterator

from pantocheck.conformance.pages import document as doc
from pantocheck.conformance.pages.words import name_verdict

# Everything with a meaning in the Markdown of GitHub or GitLab, mentions (@) and references (#, !) included.
SPECIAL = re.compile(r"([\\`*_{}\[\]()#+!|~$@])")


def render_markdown(document: doc.Document) -> str:
    """Markdown text of a document; figures are replaced by their alternative texts."""
    header = document.header
    if isinstance(header, doc.VerdictHeader):
        parts = [
            f"# {name_verdict(header.verdict)}: {escape_markdown(header.headline)}",
            escape_markdown(f"{header.subject} This is a {header.statement}.".lstrip()),
        ]
    else:
        parts = [f"# {escape_markdown(header.heading)}", escape_markdown(header.headline)]
    for block in document.blocks:
        parts += _render(block, level=2)
    return "\n\n".join(filter(None, parts)) + "\n"


def escape_markdown(text: str) -> str:
    """Text that Markdown shows unchanged, in a table as well."""
    text = text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")
    text = SPECIAL.sub(r"\\\1", text)
    # Bare addresses and the start of a list would still be taken as markup.
    return re.sub(r"(?i)(https?|ftp)://", r"\1:&#8203;//", text).replace("www.", "www&#8203;.")


def _render(block: doc.Block, level: int) -> Iterator[str]:
    """Paragraphs of one block."""
    match block:
        case doc.Section():
            yield f"{'#' * level} {escape_markdown(block.heading)}"
            for part in block.blocks:
                yield from _render(part, level + 1)
        case doc.Answers():
            for section in block.sections:
                yield from _render(section, level)
        case doc.Paragraph() | doc.SmallPrint():
            yield _text(block.text)
        case doc.CodeBlock():
            yield "\n".join(f"    {line}" for line in block.code.splitlines())
        case doc.BulletList():
            yield _bullets(map(_text, block.items))
        case doc.NumberedList():
            yield "\n".join(f"{number}. {_text(item)}" for number, item in enumerate(block.items, start=1))
        case doc.WarningBox():
            yield _bullets(f"Warning: {_text(sentence)}" for sentence in block.sentences)
        case doc.Facts():
            yield _bullets(f"{_text(name)}: {_text(value)}" for name, value in block.pairs + block.times)
        case doc.Table():
            yield _table(block)
        case doc.Figures():
            yield _bullets(_text(figure.alternative) for figure in block.figures)


def _table(table: doc.Table) -> str:
    rules = (":--" if not column.number else "--:" for column in table.columns)
    rows = [[_text(column.heading) for column in table.columns], rules, *(map(_text, row) for row in table.rows)]
    caption = f"{_text(table.caption)}\n\n" if table.caption else ""
    return caption + "\n".join(f"| {' | '.join(row)} |" for row in rows)


def _bullets(items: Iterable[str]) -> str:
    return "\n".join(f"* {item}" for item in items)


def _text(text: doc.RichText) -> str:
    return "".join(map(_inline, text)) if isinstance(text, tuple) else _inline(text)


def _inline(element: doc.Inline) -> str:
    match element:
        case str():
            return escape_markdown(element)
        case doc.Code() if not re.search(r"[`|\\]", element.text):
            return f"`{element.text}`"
        case doc.PageLink():
            return f"[{escape_markdown(element.text)}]({element.address})"
        case doc.VerdictMark():
            return name_verdict(element.verdict)
        case doc.TrustMark():
            return escape_markdown(element.trust or "–")
        case doc.Drawing():
            return escape_markdown(element.alternative)
        case _:
            return escape_markdown(element.text)
