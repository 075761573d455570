"""Changes of a signed PDF: each manipulation is reported, and signatures in sequence are accepted."""

from pathlib import Path
from typing import Any

import pytest

from helpers.pdf_updates import HIDDEN, UPDATES, sign_with
from helpers.signed_files import sign
from helpers.signer_fixtures import Signers
from pantocheck.conformance.documents import signature_writing
from pantocheck.conformance.documents.signature_check import check_signatures


def write_pdf(path: Path, contents: str = "4 0 R") -> Path:
    """One page of A4 with a word, metadata and a list of attachments, written by hand."""
    objects = [
        "<< /Type /Catalog /Pages 2 0 R /Metadata 7 0 R /Names << /EmbeddedFiles << /Names [] >> >> >>",
        "<< /Type /Pages /Kids [3 0 R] /Count 1 >>",
        f"<< /Type /Page /Parent 2 0 R /MediaBox [0 0 595.28 841.89] /Resources << /Font << /F 5 0 R >> >> "
        f"/Contents {contents} >>",
        "<< /Length 37 >>\nstream\nBT /F 20 Tf 100 500 Td (FAIL) Tj ET  \nendstream",
        "<< /Type /Font /Subtype /Type1 /BaseFont /Helvetica >>",
        "<< /Title (FAIL) >>",
        "<< /Type /Metadata /Subtype /XML /Length 7 >>\nstream\n<x></x>\nendstream",
    ]
    body = "%PDF-1.7\n"
    offsets = []
    for number, content in enumerate(objects, 1):
        offsets.append(len(body))
        body += f"{number} 0 obj\n{content}\nendobj\n"
    table = "".join(f"{offset:010d} 00000 n \n" for offset in offsets)
    size = len(objects) + 1
    end = f"trailer\n<< /Size {size} /Root 1 0 R /Info 6 0 R >>\nstartxref\n{len(body)}\n%%EOF\n"
    path.write_text(f"{body}xref\n0 {size}\n0000000000 65535 f \n{table}{end}", encoding="ascii")
    return path


@pytest.fixture
def document(tmp_path: Path, signers: Signers) -> Path:
    assert signers
    return write_pdf(tmp_path / "report.pdf")


def test_update_after_signing(document: Path, signers: Signers, roots_file: Path) -> None:
    """Every update after a signature is reported, because no signature covers it."""
    signed = sign(document, signers.author)
    content = signed.read_bytes()
    for name, (update, _) in UPDATES.items():
        writer = signature_writing._open_writer(content, "report")
        update(writer)
        with signed.open("wb") as file:
            writer.write(file)
        report = check_signatures(signed, roots_file)
        assert not report.authentic, name
        assert report.changes[0] == "2 revisions were added to the document, 1 of them by a signature", name


@pytest.mark.parametrize("name", [*UPDATES, *HIDDEN])
def test_update_while_signing(
    document: Path, signers: Signers, roots_file: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    """A signature that covers a changed document is valid in itself; the change is reported all the same."""
    change, expected = (UPDATES | HIDDEN)[name]
    path = sign_with(change, document, signers, monkeypatch)
    report = check_signatures(path, roots_file)
    assert report.signatures[0].trusted
    assert not report.authentic
    assert any(expected in text for text in report.changes), report.changes


def test_box_over_the_page(document: Path, signers: Signers, roots_file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A box of a signature could show any text; it must lie where the page is empty."""
    with monkeypatch.context() as patch:
        patch.setitem(signature_writing.BOXES, "centre", (100, 400, 400, 600))
        signed = sign(document, signers.author, place="centre")
    (change,) = check_signatures(signed, roots_file).changes
    assert change.endswith("the box of the signature is not at a place that reports leave free")


def test_object_that_the_first_revision_left_open(
    tmp_path: Path, signers: Signers, roots_file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The page refers to an object that does not exist; the signature defines it, so that the page changes."""

    def define(writer: Any) -> None:
        from pyhanko.pdf_utils.generic import StreamObject

        content = StreamObject(stream_data=b"BT /F 20 Tf 100 500 Td (PASS) Tj ET")
        assert writer.add_object(content).idnum == 12

    document = write_pdf(tmp_path / "report.pdf", "[4 0 R 12 0 R]")
    report = check_signatures(sign_with(define, document, signers, monkeypatch), roots_file)
    (change,) = report.changes
    assert "cannot be analysed (Object addressed by Reference(idnum=12" in change


def test_two_signatures_in_sequence(document: Path, signers: Signers, roots_file: Path) -> None:
    unsigned = document.read_bytes()
    first = sign(document, signers.author, role="author")
    once = first.read_bytes()
    second = sign(first, signers.assessor, role="assessor")
    assert second == first  # the signed copy grows, the unsigned document stays
    twice = second.read_bytes()
    assert document.read_bytes() == unsigned
    assert twice.startswith(once)
    assert once.startswith(unsigned)
    report = check_signatures(second, roots_file)
    assert report.authentic
    roles = [(facts.signer, facts.role) for facts in report.signatures]
    assert roles == [("Ada Author", "author"), ("Ben Assessor", "assessor")]


def test_same_role_twice(document: Path, signers: Signers, roots_file: Path) -> None:
    signed = sign(sign(document, signers.author, role="a.b"), signers.assessor, role="a.b")
    assert [facts.role for facts in check_signatures(signed, roots_file).signatures] == ["a.b", "a.b"]


@pytest.mark.parametrize("number", [0, 1])
def test_changed_byte(document: Path, signers: Signers, roots_file: Path, number: int) -> None:
    """A byte of the first page damages both signatures; a byte after the first signature damages the second only."""
    signed = sign(document, signers.author)
    first_end = len(signed.read_bytes())
    sign(signed, signers.assessor)
    content = bytearray(signed.read_bytes())
    place = content.index(b"(FAIL)") + 1 if number == 0 else content.index(b"/Reason", first_end) + 10
    content[place] ^= 1
    signed.write_bytes(content)
    damages = [facts.damage for facts in check_signatures(signed, roots_file).signatures]
    assert damages[1] == "the content was changed after signing"
    assert bool(damages[0]) == (number == 0)


def test_bytes_after_the_signature(document: Path, signers: Signers, roots_file: Path) -> None:
    signed = sign(document, signers.author)
    signed.write_bytes(signed.read_bytes() + b"% PASS\n")
    assert not check_signatures(signed, roots_file).authentic
    assert check_signatures(signed, None).contradictions


def test_removed_signatures(document: Path, signers: Signers, roots_file: Path) -> None:
    """The document without its last revision is genuine as well, with fewer signatures; without any, it is unsigned."""
    signed = sign(document, signers.author)
    once = signed.read_bytes()
    sign(signed, signers.assessor)
    signed.write_bytes(once)
    assert len(check_signatures(signed, roots_file).signatures) == 1
    signed.write_bytes(document.read_bytes())
    report = check_signatures(signed, roots_file)
    assert (report.contradictions, report.authentic) == ((), False)


def test_signature_of_another_document(document: Path, signers: Signers, roots_file: Path) -> None:
    """A signature copied into another document of the same length does not hold."""
    signed = sign(document, signers.author)
    signed.write_bytes(signed.read_bytes().replace(b"(FAIL)", b"(PASS)"))
    report = check_signatures(signed, roots_file)
    assert "signature 1 (Ada Author): the content was changed after signing" in report.contradictions


def test_untrusted_second_signature(document: Path, signers: Signers, roots_file: Path) -> None:
    """Anyone can add a signature: all of them must lead to a trust root."""
    from helpers.authorities import issue, request

    signed = sign(sign(document, signers.author), issue(request("Mallory")))
    report = check_signatures(signed, roots_file)
    assert [facts.trusted for facts in report.signatures] == [True, False]
    assert (report.contradictions, report.authentic) == ((), False)
