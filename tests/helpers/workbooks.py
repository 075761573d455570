"""Workbooks as other programs write them: ODS from XLSX, stored results of formulas, and changed parts."""

import io
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any
from xml.sax.saxutils import escape, quoteattr

from openpyxl import Workbook, load_workbook

SPACES = " ".join(
    f'xmlns:{name}="urn:{base}:xmlns:{name}:1.0"'
    for base, names in {
        "oasis:names:tc:opendocument": ("office", "table", "text"),
        "org:documentfoundation:names:experimental:calc": ("calcext",),
    }.items()
    for name in names
)


def write_rows(path: Path, rows: list[list[Any]], title: str = "supports") -> Path:
    """Workbook of one sheet."""
    book = Workbook()
    book.active.title = title
    for row in rows:
        book.active.append(row)
    book.save(path)
    return path


def change_cells(path: Path, sheet: str, changes: dict[str, Any]) -> Path:
    """Write cells by their address, as a user does."""
    book = load_workbook(path)
    for address, value in changes.items():
        book[sheet][address] = value
    book.save(path)
    return path


def change_parts(path: Path, change: Callable[[str, bytes], bytes], **further: bytes) -> Path:
    """Change the parts of an archive, and add others."""
    with zipfile.ZipFile(path) as source:
        parts = {name: change(name, source.read(name)) for name in source.namelist()}
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as target:
        for name, content in (parts | further).items():
            target.writestr(name, content)
    return path


def store_results(path: Path, value: str) -> Path:
    """Give every formula of a workbook a stored result, as spreadsheet programs do."""
    return change_parts(path, lambda _, part: part.replace(b"</f><v></v>", f"</f><v>{value}</v>".encode()))


def write_ods(path: Path, body: str) -> Path:
    """ODS file with the content of its element `spreadsheet`."""
    text = f"<office:document-content {SPACES}><office:body><office:spreadsheet>{body}</office:spreadsheet>"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("mimetype", "application/vnd.oasis.opendocument.spreadsheet")
        archive.writestr("content.xml", f"{text}</office:body></office:document-content>")
    return path


def convert_to_ods(path: Path) -> Path:
    """ODS file with the cells of an XLSX file, and empty rows and columns to the end of the sheet."""
    tables = []
    for sheet in load_workbook(io.BytesIO(path.read_bytes())):
        rows = ["".join(map(_convert_cell, row)) for row in sheet.iter_rows(values_only=True)]
        rows = [f'{row}<table:table-cell table:number-columns-repeated="1000"/>' for row in rows]
        rows.append('<table:table-cell table:number-columns-repeated="1024"/>')
        repeats = [*[1] * (len(rows) - 1), 1_000_000]
        lines = (
            f'<table:table-row table:number-rows-repeated="{n}">{row}</table:table-row>'
            for n, row in zip(repeats, rows, strict=True)
        )
        tables.append(f"<table:table table:name={quoteattr(sheet.title)}>{''.join(lines)}</table:table>")
    return write_ods(path.with_suffix(".ods"), "".join(tables))


def _convert_cell(value: Any) -> str:
    if value is None:
        return "<table:table-cell/>"
    if isinstance(value, str):
        return f'<table:table-cell office:value-type="string"><text:p>{escape(value)}</text:p></table:table-cell>'
    shown = f"<text:p>{value:.1f}</text:p>"
    return f'<table:table-cell office:value-type="float" office:value="{value!r}">{shown}</table:table-cell>'
