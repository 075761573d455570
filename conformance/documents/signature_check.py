"""Signatures of a document: inside a PDF, which may have changed by signatures alone, or in a file beside it.

A PDF grows by revisions, which redefine objects and add new ones; each must add one signature and nothing else. A
revision that only signs redefines the catalog (its form is new), the page of the signature (its annotation is new) and
the form (its field is new). Every other change is reported: pages, metadata, attachments, actions. The rule is stricter
than that of viewers, which accept further changes of metadata and forms.
"""

from collections.abc import Iterator
from io import BytesIO
from pathlib import Path
from typing import Any

from pantocheck.conformance.core.extras import MissingPackage
from pantocheck.conformance.core.files import read_bytes
from pantocheck.conformance.documents.cms_check import SignatureFacts, SignatureReport, check_cms
from pantocheck.conformance.documents.document_reading import MAX_DOCUMENT_BYTES
from pantocheck.conformance.documents.key_files import (
    MAX_SIGNATURE_BYTES,
    MOST_SIGNATURES,
    TrustRoots,
    describe_failure,
    find_signature_file,
    parse_signatures,
    read_trust_roots,
    use_signature_package,
)
from pantocheck.conformance.documents.signature_writing import find_place

FIELD_KEYS = frozenset({"/Type", "/Subtype", "/FT", "/T", "/TU", "/V", "/F", "/Ff", "/Rect", "/P", "/AP"})
"""Keys of a field that signs and does nothing else: no actions, scripts, parents or locks."""

FORM_KEYS = frozenset({"/Fields", "/SigFlags"})
"""Keys of a form that contains signatures only."""

CHANGED_KEYS = {
    "catalog": frozenset({"/AcroForm", "/Extensions", "/Version"}),
    "page": frozenset({"/Annots"}),
    "form": FORM_KEYS,
}
"""Keys of a redefined object that may change, by the kind of the object."""


def find_changes(reader: Any) -> Iterator[str]:
    """Changes of a PDF (PdfFileReader of pyHanko) other than signatures, one line each."""
    for number in range(1, reader.xrefs.total_revisions):
        old, new = (reader.get_historical_resolver(revision) for revision in (number - 1, number))
        for problem in _find_problems(old, new):
            yield f"revision {number} of the document is more than a signature: {problem}"


def _find_problems(old: Any, new: Any) -> Iterator[str]:
    if new.refs_freed_in_revision():
        yield "objects are deleted"
    for key, name in (("/Root", "catalog"), ("/Info", "table of metadata")):
        if _freeze_entry(old.trailer_view, key) != _freeze_entry(new.trailer_view, key):
            yield f"the {name} is replaced"
    listed = sorted(new.explicit_refs_in_revision(), key=lambda reference: reference.idnum)
    redefined = [reference for reference in listed if not old.is_ref_unassignable(reference)]
    # The parser refuses references to objects that do not exist: a later revision could define them.
    old.collect_dependencies(old.trailer_view)
    form = _look_up(new.root, "/AcroForm", {})
    before, after = _list_items(_look_up(old.root, "/AcroForm", {}), "/Fields"), _list_items(form, "/Fields")
    if len(after) != len(before) + 1 or after[:-1] != before:
        yield "it does not add exactly one signature field"
        return
    if form.keys() - FORM_KEYS:
        yield f"the form has {_join(form.keys() - FORM_KEYS)}"
    yield from _check_field(form["/Fields"][-1].get_object())
    metadata = (_freeze_entry(old.trailer_view, "/Info"), _freeze_entry(old.root, "/Metadata"))
    for reference in redefined:
        if ("reference", reference.idnum, reference.generation) in metadata:
            yield "the metadata are changed"
        else:
            yield from _check_redefinition(old(reference), new(reference), after[-1])


def _check_field(field: Any) -> Iterator[str]:
    """A field must sign, and its box must not cover content of a page."""
    if field.get("/FT") != "/Sig" or field.keys() - FIELD_KEYS:
        yield f"the field has {_join(field.keys() - FIELD_KEYS) or 'another type'}"
    if not find_place(field):
        yield "the box of the signature is not at a place that reports leave free"


def _check_redefinition(old: Any, new: Any, field: Any) -> Iterator[str]:
    """A redefined object must be the catalog, a page, the form or one of its lists, and grow by the field only."""
    if isinstance(old, list) and isinstance(new, list):
        if _freeze(new) != (*_freeze(old), field):
            yield "a list of the document is changed"
        return
    kind = _name_kind(old)
    if kind not in CHANGED_KEYS or not isinstance(new, dict):
        yield "an object of the document is replaced"
        return
    changed = {key for key in old.keys() | new.keys() if _freeze_entry(old, key) != _freeze_entry(new, key)}
    if changed - CHANGED_KEYS[kind]:
        yield f"{_join(changed - CHANGED_KEYS[kind])} of the {kind} changed"
    for key in changed & {"/Annots", "/Fields"}:
        if _list_items(new, key) != [*_list_items(old, key), field]:
            yield f"{key} of the {kind} has more than the signature"


def _name_kind(entries: Any) -> str:
    """Kind of a dictionary that a signature redefines; `other` for any other object."""
    from pyhanko.pdf_utils.generic import StreamObject

    if not isinstance(entries, dict) or isinstance(entries, StreamObject):
        return "other"
    if "/Fields" in entries:
        return "form"
    return {"/Catalog": "catalog", "/Page": "page"}.get(entries.get("/Type", ""), "other")


def _list_items(entries: Any, key: str) -> list[Any]:
    """Items of a list in a dictionary, comparable; empty without the key."""
    return list(_freeze(_look_up(entries, key, [])))


def _look_up(entries: Any, key: str, default: Any) -> Any:
    """Object under a key, references resolved; the method `get` of a dictionary would not resolve them."""
    try:
        return entries[key]
    except KeyError:
        return default


def _freeze_entry(entries: Any, key: str) -> Any:
    return _freeze(entries.raw_get(key)) if key in entries else None


def _freeze(value: Any) -> Any:
    """Object of a PDF as a value that can be compared across revisions: references by number, not by content."""
    from pyhanko.pdf_utils.generic import IndirectObject, StreamObject

    if isinstance(value, IndirectObject):
        return ("reference", value.idnum, value.generation)
    if isinstance(value, StreamObject):
        return ("stream", value.encoded_data, *((key, _freeze_entry(value, key)) for key in sorted(value)))
    if isinstance(value, dict):
        return ("dictionary", *((key, _freeze_entry(value, key)) for key in sorted(value)))
    if isinstance(value, list):
        return tuple(_freeze(item) for item in list.__iter__(value))
    return (type(value).__name__, getattr(value, "original_bytes", str(value)))


def _join(keys: Any) -> str:
    return ", ".join(sorted(keys))


# Signatures of a PDF of unknown origin.
SIGNATURE_KEY = b"/ByteRange"
"""Key that every signed PDF contains in plain text, because the signature is written into the finished file."""


def check_pdf(content: bytes, roots: TrustRoots | None) -> tuple[tuple[SignatureFacts, ...], tuple[str, ...]]:
    """Signatures of a signed PDF in the order of signing, and its other changes; roots as in `check_cms`."""
    from pyhanko.pdf_utils.reader import PdfFileReader

    try:
        reader = PdfFileReader(BytesIO(content), strict=True)
        embedded = sorted(reader.embedded_signatures, key=lambda signature: signature.byte_range[2])
        revisions = reader.xrefs.total_revisions
        changes = [*_check_number(len(embedded), revisions), *find_changes(reader)]
        for number, signature in enumerate(embedded, 1):
            end = len(content) if number == revisions - 1 else None
            changes += [
                f"signature {number}: {problem}" for problem in _check_coverage(content, signature, number, end)
            ]
        facts = [
            check_cms(_read_signed_bytes(content, signature), signature.signed_data, roots, _read_time(signature))
            for signature in embedded
        ]
    except RecursionError:
        return (), ("its signatures cannot be analysed (too deeply nested)",)
    except Exception as error:  # the exceptions of the parser have no common base
        reason = describe_failure(error)
        return (), (f"its signatures cannot be analysed ({reason})",)
    return tuple(facts), tuple(changes)


def _check_number(signatures: int, revisions: int) -> Iterator[str]:
    if signatures > MOST_SIGNATURES:
        raise ValueError(f"{signatures} signatures; at most {MOST_SIGNATURES} are checked")
    if revisions != signatures + 1:
        yield f"{revisions - 1} revisions were added to the document, {signatures} of them by a signature"


def _check_coverage(content: bytes, signature: Any, number: int, end: int | None) -> Iterator[str]:
    """A signature must cover its whole revision but itself, and be the one that made the revision."""
    from pyhanko.sign.validation.status import SignatureCoverageLevel

    start, length, after, rest = signature.byte_range
    gap = content[length:after]
    if start != 0 or gap[:1] != b"<" or gap[-1:] != b">" or signature.pkcs7_content.hex() != gap[1:-1].decode().lower():
        yield "it does not cover everything but itself"
    elif signature.evaluate_signature_coverage() < SignatureCoverageLevel.ENTIRE_REVISION:
        yield "it does not cover its whole revision"
    if signature.signed_revision != number:
        yield f"it belongs to revision {signature.signed_revision}, expected {number}"
    if end is not None and after + rest != end:
        yield f"{end - after - rest} bytes follow the last signature"
    if signature.sig_object_type != "/Sig":
        yield "it is a time stamp of the document, which is not checked"


def _read_signed_bytes(content: bytes, signature: Any) -> bytes:
    start, length, after, rest = signature.byte_range
    return content[start : start + length] + content[after : after + rest]


def _read_time(signature: Any) -> Any:
    """Time of the signature by the clock of the signer; None if the document does not state it."""
    try:
        return signature.self_reported_timestamp
    except (ValueError, KeyError, TypeError):
        return None


# Check of all signatures of a document: inside a PDF, or in a signature file beside any document.
def check_signatures(path: Path, trust_roots: Path | None) -> SignatureReport:
    """Check the signatures of a document.

    Args:
        path: PDF, or any other file with a signature file beside it (`results.json.p7s`).
        trust_roots: PEM file of trust roots, and of their lists of revoked certificates.

    Raises:
        InputError: A file cannot be read or is damaged, or trust roots are given and the package for signatures is
            missing.
    """
    content = read_bytes(path, str(path), MAX_DOCUMENT_BYTES)
    detached = find_signature_file(path)
    given = trust_roots is not None
    if not (is_signed_pdf(content) or detached.exists()):
        return SignatureReport((), (), given)
    try:
        with use_signature_package():
            roots = None if trust_roots is None else read_trust_roots(trust_roots)
            return _check(content, detached, roots)
    except MissingPackage as error:
        if given:
            raise
        return SignatureReport((), (), given, f"signatures were not checked: the check {error.found}. {error.hint}")


def _check(content: bytes, detached: Path, roots: TrustRoots | None) -> SignatureReport:
    signatures: tuple[SignatureFacts, ...] = ()
    changes: tuple[str, ...] = ()
    if is_signed_pdf(content):
        signatures, changes = check_pdf(content, roots)
    if detached.exists():
        where = f"signature '{detached.name}'"
        parts = parse_signatures(read_bytes(detached, where, MAX_SIGNATURE_BYTES), where)
        signatures += tuple(check_cms(content, part, roots, None) for part in parts)
    lists = roots is not None and bool(roots.revocation_lists)
    return SignatureReport(signatures, changes, roots is not None, lists_given=lists)


def is_signed_pdf(content: bytes) -> bool:
    """Whether the content is a PDF with a signature."""
    return content.startswith(b"%PDF-") and SIGNATURE_KEY in content
