"""Writing of signatures in CMS (RFC 5652): signer with role, detached signatures of files, signatures in PDF."""

from collections.abc import Collection, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import UTC, datetime
from io import BytesIO
from typing import Any
from urllib.parse import quote

from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.documents.key_files import (
    SigningKey,
    describe_failure,
    format_moment,
    parse_signatures,
    run_in_own_thread,
)

ROLE_PREFIX = "urn:pantocheck:role:"
"""Beginning of the name of a role in a signature; roles are names of the kind URI (RFC 5755, section 4.4.5)."""

LONGEST_ROLE = 60
"""Largest number of characters of a role: it is printed on one line of a signature box."""


@dataclass(frozen=True)
class Signer:
    """Signer of a document: key, role, and time-stamp client or None."""

    key: SigningKey
    role: str
    timestamp_client: Any


def check_role(role: str) -> str:
    """Role of a signer without surrounding blanks.

    Raises:
        InputError: It is empty, too long, or has characters that cannot be printed.
    """
    text = role.strip()
    if not (text and text.isprintable() and len(text) <= LONGEST_ROLE):
        hint = f"Give 1 to {LONGEST_ROLE} printable characters, such as author or assessor."
        raise InputError("option --role", f"{role!r} is not the name of a role", hint)
    return text


def build_signer(key: SigningKey) -> Any:
    """Signer of pyHanko from a key and its certificates."""
    from asn1crypto import keys
    from cryptography.hazmat.primitives.serialization import Encoding, NoEncryption, PrivateFormat
    from pyhanko.sign.signers import SimpleSigner
    from pyhanko_certvalidator.registry import SimpleCertificateStore

    store = SimpleCertificateStore()
    store.register_multiple((key.certificate, *key.chain))
    private = key.key.private_bytes(Encoding.DER, PrivateFormat.PKCS8, NoEncryption())
    return SimpleSigner(key.certificate, keys.PrivateKeyInfo.load(private), store)


def build_role_attributes(role: str) -> Any:
    """Signed attributes (CAdES) that state the role of the signer."""
    from asn1crypto import cms, x509
    from pyhanko.sign.ades.api import CAdESSignedAttrSpec, SignerAttrSpec

    name = x509.GeneralName("uniform_resource_identifier", ROLE_PREFIX + quote(role))
    attribute = cms.AttCertAttribute({"type": "role", "values": [cms.RoleSyntax({"role_name": name})]})
    return CAdESSignedAttrSpec(signer_attributes=SignerAttrSpec([attribute], []))


def select_digest(key: SigningKey) -> str:
    """Digest algorithm whose strength fits the key."""
    from pyhanko.sign.signers.pdf_cms import select_suitable_signing_md

    return str(select_suitable_signing_md(key.certificate.public_key))


def sign_detached(content: bytes, signer: Signer, earlier: bytes | None, where: str) -> bytes:
    """Detached signature of a file, added to earlier signatures of the same file.

    Args:
        content: Content of the file.
        signer: The signer.
        earlier: Content of a signature file, to which the signature is added; None for a new one.
        where: Name of the signature file in messages.

    Returns:
        Signature file in DER.

    Raises:
        InputError: The earlier signature file is damaged, or the time-stamp server gave no time stamp.
    """
    import asyncio

    from pyhanko.sign.signers.pdf_cms import PdfCMSSignedAttributes

    attributes = PdfCMSSignedAttributes(
        signing_time=datetime.now(UTC).replace(microsecond=0), cades_signed_attrs=build_role_attributes(signer.role)
    )

    def compute_signature() -> Any:
        return asyncio.run(
            build_signer(signer.key).async_sign_general_data(
                content,
                select_digest(signer.key),
                use_cades=True,
                timestamper=signer.timestamp_client,
                signed_attr_settings=attributes,
            )
        )

    added = run_in_own_thread(compute_signature)
    parts = [] if earlier is None else parse_signatures(earlier, where)
    return join_signatures([*parts, added["content"]])


def join_signatures(parts: Iterable[Any]) -> bytes:
    """One signature file in DER from several signatures of the same content."""
    from asn1crypto import cms

    parts = list(parts)
    joined: dict[str, dict[bytes, Any]] = {"digest_algorithms": {}, "certificates": {}, "signer_infos": {}}
    for part in parts:
        for key, items in joined.items():
            items.update((item.dump(), item) for item in part[key])
    version = max((part["version"].native for part in parts), key=lambda name: int(name[1:]))
    lists = {key: list(items.values()) for key, items in joined.items()}
    content = {"version": version, "encap_content_info": parts[0]["encap_content_info"]} | lists
    return bytes(cms.ContentInfo({"content_type": "signed_data", "content": cms.SignedData(content)}).dump())


# Signatures in PDF (PAdES, ETSI EN 319 142-1): an incremental update, so that earlier bytes stay as they are.
def sign_pdf(content: bytes, signer: Signer, place: str | None, where: str) -> bytes:
    """Add a signature to a PDF.

    Args:
        content: The PDF.
        signer: The signer.
        place: Place of a visible signature on page 1, one of `BOXES`; None for an invisible one.
        where: Name of the file in messages.

    Returns:
        The PDF, unchanged at its beginning, with the signature as an incremental update.

    Raises:
        InputError: The PDF is damaged or encrypted, the place is occupied, or the time-stamp server gave no time stamp.
    """
    from pyhanko.sign.fields import SigFieldSpec, SigSeedSubFilter, enumerate_sig_fields
    from pyhanko.sign.signers import PdfSignatureMetadata, PdfSigner

    with _convert_damage(where):
        writer = _open_writer(content, where)
        fields = {str(name): field for name, _, field in enumerate_sig_fields(writer.prev)}
        name = _choose_field_name(signer.role, fields)
        if place is not None and place in map(find_place, fields.values()):
            raise InputError(where, f"a signature is already at {place}", f"Choose another place: {', '.join(BOXES)}.")
        box = {} if place is None else {"box": BOXES[place]}
        metadata = PdfSignatureMetadata(
            field_name=name,
            md_algorithm=select_digest(signer.key),
            reason=signer.role,
            subfilter=SigSeedSubFilter.PADES,
            cades_signed_attr_spec=build_role_attributes(signer.role),
        )
        pdf_signer = PdfSigner(
            metadata,
            build_signer(signer.key),
            timestamper=signer.timestamp_client,
            stamp_style=None if place is None else _build_stamp(signer, BOXES[place]),
            new_field_spec=SigFieldSpec(name, readable_field_name=f"Signature of the {signer.role}", **box),
        )
        return bytes(run_in_own_thread(lambda: pdf_signer.sign_pdf(writer)).getvalue())


def _open_writer(content: bytes, where: str) -> Any:
    """Writer of an update that keeps metadata and version: PDF/A-3 is PDF 1.7 and identifies itself in its metadata."""
    from pyhanko.pdf_utils.incremental_writer import IncrementalPdfFileWriter

    class Writer(IncrementalPdfFileWriter):  # type: ignore[misc]  # the base class is known only when installed
        """Writer of an incremental update."""

        def _update_meta(self) -> None:
            pass

        def ensure_output_version(self, version: Any) -> None:
            """Keep the version; pyHanko would raise it to 2.0 for elliptic curves."""

        def register_extension(self, extension: Any) -> None:
            """Declare no extension of the version: readers know the algorithms from the signature."""

    writer = Writer(BytesIO(content))
    if writer.prev.encrypted:
        raise InputError(where, "is encrypted", "Sign the PDF before it is encrypted; PDF/A has no encryption.")
    return writer


def _choose_field_name(role: str, taken: Collection[str]) -> str:
    """Name of a new field: the role, without full stops, which would name a child; a number if the name is taken."""
    name = role.replace(".", "-")
    names = (name, *(f"{name} {number}" for number in range(2, len(taken) + 2)))
    return next(text for text in names if text not in taken)


def _build_stamp(signer: Signer, edges: tuple[int, int, int, int]) -> Any:
    """Appearance of a visible signature: a page that brings its fonts, as PDF/A requires."""
    from pyhanko.pdf_utils.content import PdfContent
    from pyhanko.pdf_utils.layout import AxisAlignment, BoxConstraints, Margins, SimpleBoxLayoutRule
    from pyhanko.pdf_utils.reader import PdfFileReader
    from pyhanko.stamp import StaticStampStyle

    from pantocheck.conformance.pages.pdf import render_signature_box

    lines = (
        f"Signed by {signer.key.holder} as {signer.role}",
        f"{format_moment(datetime.now(UTC))}. To check: pantocheck verify",
    )
    width, height = edges[2] - edges[0], edges[3] - edges[1]
    page = PdfFileReader(BytesIO(render_signature_box(lines, width, height)))

    class Box(PdfContent):  # type: ignore[misc]  # the base class is known only when installed
        """Page of another document as a drawing."""

        def render(self) -> bytes:
            """Commands that draw the page."""
            self.box = BoxConstraints(width=width, height=height)
            self.resources.xobject["/SignatureBox"] = self.writer.import_page_as_xobject(page)
            return b"/SignatureBox Do"

    middle = SimpleBoxLayoutRule(AxisAlignment.ALIGN_MID, AxisAlignment.ALIGN_MID, Margins.uniform(0))
    return StaticStampStyle(border_width=0, background=Box(), background_layout=middle, background_opacity=1.0)


@contextmanager
def _convert_damage(where: str) -> Iterator[None]:
    """Convert failures on a damaged PDF, whose exceptions have no common base, into `InputError`."""
    try:
        yield
    except (InputError, ModuleNotFoundError):
        raise
    except Exception as error:
        reason = describe_failure(error)
        raise InputError(where, f"cannot be signed ({reason})", "Sign a PDF that 'pantocheck run' wrote.") from None


# Places of visible signatures: boxes in the top margin of page 1, where a report prints nothing.
BOXES = {
    "top-left": (51, 812, 209, 834),
    "top-centre": (218, 812, 376, 834),
    "top-right": (386, 812, 544, 834),
}
"""Left, bottom, right and top edge of each box [points from the lower left corner of an A4 page]."""

INVISIBLE = "invisible"
"""Place of a signature without a box."""


def find_place(field: Any) -> str:
    """Place of the box of a field (dictionary of pyHanko): a key of `BOXES`, `INVISIBLE`, or empty for another."""
    rectangle = [float(edge) for edge in field.get_object()["/Rect"]]
    left, bottom, right, top = rectangle
    if left == right and bottom == top:
        return INVISIBLE
    return next((name for name, box in BOXES.items() if rectangle == [float(edge) for edge in box]), "")
