"""Contents of an artefact that are compared: values by place, or a sequence of words, lines or drawn elements."""

import hashlib
import json
import re
from collections.abc import Callable, Iterator
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from pypdf import PdfReader

Contents = dict[str, dict[str, str] | list[str]]
"""Values by place, or a sequence, by the name of their part of the file."""

Text = Callable[[str], str]
"""Replacement of a text by one with placeholders."""

INLINE = {"a", "abbr", "b", "cite", "code", "em", "i", "mark", "small", "span", "strong", "sub", "sup", "time", "wbr"}
"""Elements of a page that do not separate words."""

REFERENCE = re.compile(r"^(?:xlink:)?href=#.*|url\(#[^)]*\)")
"""Names of other elements of a page, which carry no meaning."""


def read_contents(path: Path, text: Text) -> Contents:
    """Contents of a file, by the ending of its name; lines of text for any other ending."""
    match path.suffix:
        case ".json":
            return {"": dict(flatten(json.loads(path.read_text()), text))}
        case ".h5":
            return {"": _read_hdf5(path, text)}
        case ".pdf":
            return _read_pdf(path, text)
        case ".html" | ".svg":
            page = _Page(text)
            page.feed(path.read_text())
            return page.contents()
        case ".txt" | ".md":
            # Words, since the width of a column or a longer path breaks the lines elsewhere.
            return {"text": text(" ".join(path.read_text().split())).split()}
        case ".uff":
            # Lines are filled up to 80 columns.
            return {"line": [line.rstrip() for line in text(path.read_text()).splitlines()]}
        case _:
            return {"line": text(path.read_text()).splitlines()}


def flatten(value: Any, text: Text, place: str = "") -> Iterator[tuple[str, str]]:
    """JSON pointer and exact representation of every value; a number differs from the same number of another type."""
    if isinstance(value, dict) and value:
        for key, item in value.items():
            yield from flatten(item, text, f"{place}/{key}")
    elif isinstance(value, list) and value:
        for number, item in enumerate(value):
            yield from flatten(item, text, f"{place}/{number}")
    else:
        yield place, repr(text(value) if isinstance(value, str) else value)


def _read_hdf5(path: Path, text: Text) -> dict[str, str]:
    values: dict[str, str] = {}

    def visit(name: str, item: Any) -> None:
        for key, value in item.attrs.items():
            values[f"/{name}@{key}"] = _array(np.asarray(value), text)
        if isinstance(item, h5py.Dataset):
            values[f"/{name}"] = _array(np.asarray(item[()]), text)

    with h5py.File(path) as file:
        visit("", file)
        file.visititems(visit)
    return values


def _array(array: np.ndarray, text: Text) -> str:
    if array.dtype.kind in "OSU":
        return repr([text(item.decode() if isinstance(item, bytes) else str(item)) for item in array.ravel().tolist()])
    digest = hashlib.sha256(array.tobytes()).hexdigest()
    return f"{array.dtype} {array.shape} {digest[:16]}, begins {array.ravel()[:3].tolist()}"


def _read_pdf(path: Path, text: Text) -> Contents:
    contents: Contents = {}
    for number, page in enumerate(PdfReader(path).pages, 1):
        # Long words are broken at zero-width spaces, and paths after a slash.
        extracted = re.sub("\u200b\n?|(?<=[a-z]/)\n(?=[a-z])", "", page.extract_text())
        contents[f"page {number}"] = text(" ".join(extracted.split())).split()
    return contents


class _Page(HTMLParser):
    """Visible words, drawn elements of the figures, and embedded JSON of a page."""

    def __init__(self, text: Text) -> None:
        super().__init__()
        self._text = text
        self._words: list[str] = []
        self._figures: list[list[str]] = []
        self._scripts: dict[str, str] = {}
        self._hidden: str | None = None
        """Element `script`, `style` or `head` that is open, or id of the JSON in it."""
        self._depth = 0
        """Open elements `svg`."""

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        values = dict(attrs)
        if tag in ("script", "style"):
            self._hidden = (values.get("id") or "json") if values.get("type") == "application/json" else tag
        elif tag == "svg" or self._depth:
            self._draw(tag, values)
        else:
            if tag not in INLINE:
                self._words.append(" ")
            if (source := values.get("src") or "").startswith("data:"):
                self._words.append(f" [image {hashlib.sha256(source.encode()).hexdigest()[:8]}] ")

    def _draw(self, tag: str, values: dict[str, str | None]) -> None:
        if tag == "svg":
            if not self._depth:
                self._figures.append([])
            self._depth += 1
        attributes = [REFERENCE.sub("<reference>", f"{key}={values[key]}") for key in sorted(values) if key != "id"]
        self._figures[-1].append(self._text(" ".join([f"<{tag}>", *attributes])))

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.handle_starttag(tag, attrs)
        if tag == "svg":
            self._depth -= 1

    def handle_endtag(self, tag: str) -> None:
        if tag in ("script", "style"):
            self._hidden = None
        elif tag == "svg":
            self._depth -= 1
        elif tag not in INLINE and not self._depth:
            self._words.append(" ")

    def handle_data(self, data: str) -> None:
        if self._hidden in ("script", "style"):
            return
        if self._hidden:
            self._scripts[self._hidden] = self._scripts.get(self._hidden, "") + data
        elif self._depth:
            self._figures[-1].extend([self._text(data.strip())] if data.strip() else [])
        else:
            self._words.append(data)

    def contents(self) -> Contents:
        """Parts of the page after it was read."""
        contents: Contents = {"text": self._text(" ".join("".join(self._words).split())).split()}
        contents |= {f"figure {number}": figure for number, figure in enumerate(self._figures, 1)}
        return contents | {
            name: dict(flatten(json.loads(script), self._text)) for name, script in self._scripts.items()
        }
