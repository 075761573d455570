"""Kinds of forged PDF certificates: pages, metadata, attachments, actions and structure of the file."""

import io
import random
import re
from collections.abc import Callable
from typing import Any

from pypdf import PdfWriter, Transformation
from pypdf.annotations import FreeText
from pypdf.generic import (
    ArrayObject,
    DecodedStreamObject,
    DictionaryObject,
    FloatObject,
    NameObject,
    NumberObject,
    RectangleObject,
    TextStringObject,
)

NAME = "results.json"
COVER = b"\nq 1 1 1 rg 60 640 420 90 re f 0.1 0.37 0.23 rg 62 700 120 14 re f Q\n"
"""White rectangle over the heading, with a green one in place of the verdict."""

Forge = Callable[[bytes, random.Random], bytes]


def rewrite(change: Callable[[PdfWriter, random.Random], object]) -> Forge:
    """Forgery that reads the document, changes it and writes it again."""

    def forge(content: bytes, chance: random.Random) -> bytes:
        writer = PdfWriter(clone_from=io.BytesIO(content))
        change(writer, chance)
        buffer = io.BytesIO()
        writer.write(buffer)
        return buffer.getvalue()

    return forge


def update(change: Callable[[PdfWriter, random.Random], object]) -> Forge:
    """Forgery that appends its changes to the document, as an editor or a signing program does."""

    def forge(content: bytes, chance: random.Random) -> bytes:
        writer = PdfWriter(io.BytesIO(content), incremental=True)
        change(writer, chance)
        buffer = io.BytesIO()
        writer.write(buffer)
        return buffer.getvalue()

    return forge


def append_drawing(writer: PdfWriter, number: int, drawing: bytes) -> None:
    """Draw over a page."""
    page = writer.pages[number]
    stream = DecodedStreamObject()
    stream.set_data(page.get_contents().get_data() + drawing)
    page[NameObject("/Contents")] = writer._add_object(stream)


def paint_over(writer: PdfWriter, _: random.Random) -> None:
    """Cover the heading of the first page."""
    append_drawing(writer, 0, COVER)


def paint_curve(writer: PdfWriter, chance: random.Random) -> None:
    """Draw a line across a page with a figure."""
    append_drawing(writer, chance.randrange(1, len(writer.pages)), b"\nq 2 w 80 300 m 480 320 l S Q\n")


def change_number(writer: PdfWriter, _: random.Random) -> None:
    """Move the text of a page by changing an operand of its drawing."""
    page = writer.pages[0]
    data = page.get_contents().get_data()
    stream = DecodedStreamObject()
    stream.set_data(re.sub(rb"(\d+\.\d+) (\d+\.\d+) Td", rb"\1 999 Td", data, count=1) + b" ")
    page[NameObject("/Contents")] = writer._add_object(stream)


def remove_pages(writer: PdfWriter, _: random.Random) -> None:
    """Remove all pages but the first two."""
    while len(writer.pages) > 2:
        writer.remove_page(len(writer.pages) - 1)


def swap_pages(writer: PdfWriter, _: random.Random) -> None:
    """Exchange two pages."""
    kids = writer.root_object["/Pages"]["/Kids"]
    if len(kids) > 2:
        kids[1], kids[2] = kids[2], kids[1]


def repeat_page(writer: PdfWriter, chance: random.Random) -> None:
    """Insert a page a second time."""
    writer.insert_page(writer.pages[chance.randrange(len(writer.pages))], 1)


def set_metadata(**entries: str) -> Callable[[PdfWriter, random.Random], object]:
    """Change of the table of metadata."""
    return lambda writer, _: writer.add_metadata({f"/{key}": value for key, value in entries.items()})


def change_xmp(writer: PdfWriter, _: random.Random) -> None:
    """Change the metadata in XML."""
    stream = writer.root_object["/Metadata"].get_object()
    data = stream.get_data().replace(b"FAIL", b"PASS")
    other = DecodedStreamObject()
    other.set_data(data)
    other.update({NameObject("/Type"): NameObject("/Metadata"), NameObject("/Subtype"): NameObject("/XML")})
    writer.root_object[NameObject("/Metadata")] = writer._add_object(other)


def add_layer(writer: PdfWriter, _: random.Random) -> None:
    """Add a layer that can be hidden."""
    group = writer._add_object(
        DictionaryObject({NameObject("/Type"): NameObject("/OCG"), NameObject("/Name"): TextStringObject("verdict")})
    )
    order = DictionaryObject({NameObject("/OFF"): ArrayObject([group])})
    entry = DictionaryObject({NameObject("/OCGs"): ArrayObject([group]), NameObject("/D"): order})
    writer.root_object[NameObject("/OCProperties")] = entry


def add_action(kind: str) -> Callable[[PdfWriter, random.Random], object]:
    """Action of a kind when the document is opened."""

    def change(writer: PdfWriter, _: random.Random) -> None:
        action = DictionaryObject({NameObject("/S"): NameObject(kind)})
        action[NameObject("/URI" if kind == "/URI" else "/F")] = TextStringObject("https://example.org/")
        writer.root_object[NameObject("/OpenAction")] = action

    return change


def add_link(writer: PdfWriter, _: random.Random) -> None:
    """Add a link that opens an address."""
    action = DictionaryObject(
        {NameObject("/S"): NameObject("/URI"), NameObject("/URI"): TextStringObject("https://a.b/")}
    )
    link = DictionaryObject(
        {
            NameObject("/Type"): NameObject("/Annot"),
            NameObject("/Subtype"): NameObject("/Link"),
            NameObject("/Rect"): RectangleObject((60, 60, 200, 80)),
            NameObject("/A"): action,
        }
    )
    add_annotation(writer, link)


def add_annotation(writer: PdfWriter, annotation: DictionaryObject) -> None:
    """Add an annotation to the first page."""
    writer.pages[0][NameObject("/Annots")] = ArrayObject([writer._add_object(annotation)])


def add_note(writer: PdfWriter, _: random.Random) -> None:
    """Write PASS over the first page as an annotation."""
    writer.add_annotation(0, FreeText(text="PASS", rect=(60, 640, 480, 730), background_color="ffffff"))


def add_field(writer: PdfWriter, _: random.Random) -> None:
    """Add a form with a text field that shows PASS."""
    field = DictionaryObject(
        {
            NameObject("/Type"): NameObject("/Annot"),
            NameObject("/Subtype"): NameObject("/Widget"),
            NameObject("/FT"): NameObject("/Tx"),
            NameObject("/T"): TextStringObject("verdict"),
            NameObject("/V"): TextStringObject("PASS"),
            NameObject("/Rect"): RectangleObject((60, 640, 480, 730)),
        }
    )
    add_annotation(writer, field)
    writer.root_object[NameObject("/AcroForm")] = DictionaryObject(
        {NameObject("/Fields"): writer.pages[0]["/Annots"], NameObject("/NeedAppearances"): NumberObject(1)}
    )


def crop_page(writer: PdfWriter, _: random.Random) -> None:
    """Show the lower half of the first page only."""
    writer.pages[0][NameObject("/CropBox")] = RectangleObject((0, 0, 595, 400))


def rotate_page(writer: PdfWriter, _: random.Random) -> None:
    """Turn the first page."""
    writer.pages[0].rotate(180)


def scale_page(writer: PdfWriter, _: random.Random) -> None:
    """Move the content of the first page out of sight."""
    writer.pages[0].add_transformation(Transformation().translate(0, 2000))


def exchange_fonts(writer: PdfWriter, _: random.Random) -> None:
    """Exchange two fonts, so that letters look like others."""
    fonts = writer.pages[0]["/Resources"]["/Font"].get_object()
    names = sorted(fonts)
    if len(names) > 1:
        first, second = fonts.raw_get(names[0]), fonts.raw_get(names[1])
        fonts[NameObject(names[0])], fonts[NameObject(names[1])] = second, first


def change_alternative(writer: PdfWriter, _: random.Random) -> None:
    """Change the text that a screen reader speaks in place of a figure."""
    for item in writer._objects:
        if isinstance(item, DictionaryObject) and "/Alt" in item:
            item[NameObject("/Alt")] = TextStringObject("PASS")
            return


def change_outline(writer: PdfWriter, _: random.Random) -> None:
    """Change an entry of the list of bookmarks."""
    for item in writer._objects:
        if isinstance(item, DictionaryObject) and "/Dest" in item and "/Title" in item:
            item[NameObject("/Title")] = TextStringObject("PASS")
            return


def change_language(writer: PdfWriter, _: random.Random) -> None:
    """Change the language of the document."""
    writer.root_object[NameObject("/Lang")] = TextStringObject("de")


def shrink_letters(writer: PdfWriter, chance: random.Random) -> None:
    """Change the size of every letter of a page."""
    page = writer.pages[chance.randrange(len(writer.pages))]
    page[NameObject("/UserUnit")] = FloatObject(0.1)


def attach(name: str, content: bytes) -> Callable[[PdfWriter, random.Random], object]:
    """Add an attachment."""
    return lambda writer, _: writer.add_attachment(name, content)


def encrypt(writer: PdfWriter, _: random.Random) -> None:
    """Encrypt with an empty password, so that every viewer opens the file."""
    writer.encrypt("", algorithm="RC4-128")


def run_script(writer: PdfWriter, _: random.Random) -> None:
    """Add a script."""
    script = DictionaryObject({NameObject("/S"): NameObject("/JavaScript")})
    script[NameObject("/JS")] = TextStringObject("app.alert('PASS')")
    writer.root_object[NameObject("/OpenAction")] = script


def keep(writer: PdfWriter, _: random.Random) -> None:
    """Write the same content again."""
    del writer


def flip_byte(content: bytes, chance: random.Random) -> bytes:
    """Change one byte inside the drawings."""
    place = chance.randrange(len(content) // 4, len(content) // 2)
    return content[:place] + bytes([content[place] ^ 1]) + content[place + 1 :]


PDF_FORGERIES: dict[str, Forge] = {
    "heading painted over": rewrite(paint_over),
    "heading painted over, as update": update(paint_over),
    "curve painted into a page": rewrite(paint_curve),
    "number of a drawing": rewrite(change_number),
    "pages removed": rewrite(remove_pages),
    "pages exchanged": rewrite(swap_pages),
    "page repeated": rewrite(repeat_page),
    "page cropped": rewrite(crop_page),
    "page turned": rewrite(rotate_page),
    "page moved out of sight": rewrite(scale_page),
    "size of a page": rewrite(shrink_letters),
    "fonts exchanged": rewrite(exchange_fonts),
    "title in the metadata": rewrite(set_metadata(Title="PASS – Conformance report")),
    "author in the metadata": rewrite(set_metadata(Author="Notified body")),
    "title as update": update(set_metadata(Title="PASS – Conformance report")),
    "metadata in XML": rewrite(change_xmp),
    "alternative text of a figure": rewrite(change_alternative),
    "bookmark": rewrite(change_outline),
    "language": rewrite(change_language),
    "further attachment": rewrite(attach("readme.txt", b"PASS")),
    "second attachment of the name": rewrite(attach(NAME, b"{}")),
    "attachment removed": rewrite(lambda writer, _: writer.root_object["/Names"].pop("/EmbeddedFiles")),
    "script": rewrite(run_script),
    "address opened": rewrite(add_action("/URI")),
    "program started": rewrite(add_action("/Launch")),
    "link to an address": rewrite(add_link),
    "note over the heading": rewrite(add_note),
    "note over the heading, as update": update(add_note),
    "form field": rewrite(add_field),
    "layer": rewrite(add_layer),
    "encryption": rewrite(encrypt),
    "bytes behind the end": lambda content, _: content + b"%appended\n",
    "bytes before the header": lambda content, _: b"x\n" + content,
    "one byte of the file": flip_byte,
    "last kilobyte removed": lambda content, _: content[:-1024],
    "written again": rewrite(keep),
}
"""Kinds of forged PDFs by name."""


def replace_attachment(content: bytes, attachment: bytes) -> bytes:
    """PDF with other results attached and the same pages."""

    def change(writer: PdfWriter, _: Any) -> None:
        for item in writer._objects:
            if isinstance(item, DictionaryObject) and item.get("/Type") == "/EmbeddedFile":
                stream = DecodedStreamObject()
                stream.set_data(attachment)
                stream.update({key: value for key, value in item.items() if key not in ("/Length", "/Filter")})
                writer._objects[item.indirect_reference.idnum - 1] = stream

    return rewrite(change)(content, random.Random())
