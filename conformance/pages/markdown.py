"""A document as Markdown, for the page of a CI job and for the documentation; every text is escaped."""

import re
from collections.abc import Callable, Iterable, Iterator

from pantocheck.conformance.pages import document as doc
from pantocheck.conformance.pages.translation import translate, translate_document
from pantocheck.conformance.pages.words import name_verdict

Say = Callable[[str], str]
"""A text of this file in the language of the document."""

# Everything with a meaning in the Markdown of GitHub or GitLab, mentions (@) and references (#, !) included.
SPECIAL = re.compile(r"([\\`*_{}\[\]()#+!|~$@])")


def render_markdown(document: doc.Document) -> str:
    """Markdown text of a document; figures are replaced by their alternative texts."""

    def say(text: str) -> str:
        return translate(text, document.language).text

    closing = "" if isinstance(document.header, doc.PlainHeader) else say(f"This is a {document.header.statement}.")
    document = translate_document(document)
    header = document.header
    if isinstance(header, doc.VerdictHeader):
        parts = [
            f"# {say(name_verdict(header.verdict))}: {escape_markdown(header.headline)}",
            escape_markdown(f"{header.subject} {closing}".lstrip()),
        ]
    else:
        parts = [f"# {escape_markdown(header.heading)}", escape_markdown(header.headline)]
    for block in document.blocks:
        parts += _render(block, 2, say)
    return "\n\n".join(filter(None, parts)) + "\n"


def escape_markdown(text: str) -> str:
    """Text that Markdown shows unchanged, in a table as well."""
    text = text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")
    text = SPECIAL.sub(r"\\\1", text)
    # Bare addresses and the start of a list would still be taken as markup.
    return re.sub(r"(?i)(https?|ftp)://", r"\1:&#8203;//", text).replace("www.", "www&#8203;.")


def _render(block: doc.Block, level: int, say: Say) -> Iterator[str]:
    """Paragraphs of one block."""
    match block:
        case doc.Section():
            yield f"{'#' * level} {escape_markdown(block.heading)}"
            for part in block.blocks:
                yield from _render(part, level + 1, say)
        case doc.Answers():
            for section in block.sections:
                yield from _render(section, level, say)
        case doc.Paragraph() | doc.SmallPrint():
            yield _text(block.text, say)
        case doc.CodeBlock():
            yield "\n".join(f"    {line}" for line in block.code.splitlines())
        case doc.BulletList():
            yield _bullets(_text(item, say) for item in block.items)
        case doc.NumberedList():
            yield "\n".join(f"{number}. {_text(item, say)}" for number, item in enumerate(block.items, start=1))
        case doc.WarningBox():
            yield _bullets(f"{say('Warning:')} {_text(sentence, say)}" for sentence in block.sentences)
        case doc.Facts():
            yield _bullets(f"{_text(name, say)}: {_text(value, say)}" for name, value in block.pairs + block.times)
        case doc.Table():
            yield _table(block, say)
        case doc.Figures():
            yield _bullets(_text(figure.alternative, say) for figure in block.figures)


def _table(table: doc.Table, say: Say) -> str:
    rules = (":--" if not column.number else "--:" for column in table.columns)
    cells = ([_text(cell, say) for cell in row] for row in table.rows)
    rows = [[_text(column.heading, say) for column in table.columns], rules, *cells]
    caption = f"{_text(table.caption, say)}\n\n" if table.caption else ""
    return caption + "\n".join(f"| {' | '.join(row)} |" for row in rows)


def _bullets(items: Iterable[str]) -> str:
    return "\n".join(f"* {item}" for item in items)


def _text(text: doc.RichText, say: Say) -> str:
    return "".join(_inline(part, say) for part in text) if isinstance(text, tuple) else _inline(text, say)


def _inline(element: doc.Inline, say: Say) -> str:
    match element:
        case str():
            return escape_markdown(element)
        case doc.Code() if not re.search(r"[`|\\]", element.text):
            return f"`{element.text}`"
        case doc.PageLink():
            return f"[{escape_markdown(element.text)}]({element.address})"
        case doc.VerdictMark():
            return say(name_verdict(element.verdict))
        case doc.TrustMark():
            return escape_markdown(say(element.trust) or "–")
        case doc.Drawing():
            return escape_markdown(element.alternative)
        case _:
            return escape_markdown(element.text)
