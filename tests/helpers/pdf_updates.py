"""Changes of a PDF as updates: beside a signature, and in the revision that signs."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from helpers.signed_files import sign
from helpers.signer_fixtures import Signers
from pantocheck.conformance.documents import signature_writing


def add_content(writer: Any) -> None:
    """Paint over the page."""
    from pyhanko.pdf_utils.generic import StreamObject

    content = StreamObject(stream_data=b"BT /F 20 Tf 100 500 Td (PASS) Tj ET")
    writer.add_stream_to_page(0, writer.add_object(content))


def replace_content(writer: Any) -> None:
    """Redefine the content of the page."""
    stream = writer.root["/Pages"]["/Kids"][0]["/Contents"]
    stream._data = b"BT /F 20 Tf 100 500 Td (PASS) Tj ET"
    stream._encoded_data = None
    writer.update_container(stream)


def add_attachment(writer: Any) -> None:
    from pyhanko.pdf_utils.embed import EmbeddedFileObject, FileSpec, embed_file

    content = EmbeddedFileObject.from_file_data(writer, data=b"{}", mime_type="application/json")
    embed_file(writer, FileSpec(file_spec_string="results.json", embedded_data=content))


def add_open_action(writer: Any) -> None:
    from pyhanko.pdf_utils import generic

    script = {"/S": generic.NameObject("/JavaScript"), "/JS": generic.TextStringObject("app.alert(1)")}
    writer.root["/OpenAction"] = generic.DictionaryObject({generic.NameObject(k): v for k, v in script.items()})
    writer.update_root()


def change_title(writer: Any) -> None:
    from pyhanko.pdf_utils import generic

    info = writer.trailer["/Info"]
    info["/Title"] = generic.TextStringObject("PASS")
    writer.update_container(info)


def add_note(writer: Any) -> None:
    """Add an annotation to the page."""
    from pyhanko.pdf_utils import generic

    note = {"/Type": "/Annot", "/Subtype": "/Square"}
    entries = generic.DictionaryObject({generic.NameObject(k): generic.NameObject(v) for k, v in note.items()})
    entries["/Rect"] = generic.ArrayObject(map(generic.NumberObject, (0, 0, 500, 800)))
    writer.register_annotation(writer.root["/Pages"]["/Kids"].raw_get(0), writer.add_object(entries))


def add_field(writer: Any) -> None:
    """Add a signature field that nobody signs."""
    from pyhanko.sign.fields import SigFieldSpec, append_signature_field

    append_signature_field(writer, SigFieldSpec("empty"))


def add_form(writer: Any) -> None:
    """Give the signatures a form of another kind (XFA), whose pages replace those of the document."""
    from pyhanko.pdf_utils import generic

    writer.root["/AcroForm"]["/XFA"] = generic.TextStringObject("<form/>")


def add_script_to_field(writer: Any) -> None:
    from pyhanko.pdf_utils import generic

    writer.root["/AcroForm"]["/Fields"][0]["/AA"] = generic.DictionaryObject()


UPDATES = {
    "content added": (add_content, "/Contents"),
    "content replaced": (replace_content, "an object of the document is replaced"),
    "attachment added": (add_attachment, "/Names"),
    "action when opened": (add_open_action, "/OpenAction of the catalog changed"),
    "title": (change_title, "the metadata are changed"),
    "annotation": (add_note, "/Annots of the page has more than the signature"),
    "empty signature field": (add_field, "it does not add exactly one signature field"),
}

HIDDEN = {
    "form of another kind": (add_form, "the form has /XFA"),
    "script of the field": (add_script_to_field, "the field has /AA"),
}
"""Changes of the signature itself: they are possible in the revision that signs only."""


def sign_with(change: Callable[[Any], None], document: Path, signers: Signers, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Sign a document with a change in the same revision, without the check of the result."""
    from pantocheck.conformance.documents import signing

    open_writer = signature_writing._open_writer

    def open_and_change(content: bytes, where: str) -> Any:
        writer = open_writer(content, where)
        write = writer.write
        writer.write = lambda stream: (change(writer), write(stream))
        return writer

    with monkeypatch.context() as patch:
        patch.setattr(signature_writing, "_open_writer", open_and_change)
        patch.setattr(
            signing,
            "_sign_pdf",
            lambda content, signer, place, _: signature_writing.sign_pdf(content, signer, place, "report"),
        )
        return sign(document, signers.author)
