"""Signatures in the verifier for a browser, by PKI.js: it says what `pantocheck verify` says by pyHanko."""

import random
from collections.abc import Callable, Iterator
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any, NamedTuple

import pytest

from helpers.pdf_updates import HIDDEN, UPDATES, sign_with
from helpers.signed_files import sign
from helpers.signer_fixtures import Signers
from helpers.verifier_page import Report, Verify
from pantocheck.conformance.documents import key_files, signature_writing
from pantocheck.conformance.documents.cms_check import SignatureReport, describe_signatures
from pantocheck.conformance.documents.signature_check import check_signatures
from pantocheck.conformance.documents.verification import check_origin
from verification.attacks.forged_pdfs import PDF_FORGERIES
from verification.attacks.forgeries import SEED, Genuine

pytestmark = pytest.mark.thorough

ORIGINS = ("Every signer leads", "The origin of the document")
BROKEN = ("The file was changed after signing", "The signatures cannot be read", "A signature does not hold")
HOLDING = ("The signature holds", "Every signature holds")


KINDS = [
    *(name for name in PDF_FORGERIES if name.endswith("as update")),
    *("attachment removed", "encryption", "bytes behind the end", "bytes before the header"),
    *("one byte of the file", "last kilobyte removed", "written again"),
]
"""Kinds of forged PDFs; the others write the whole file again, and lose the signature in the same way."""


class Bench(NamedTuple):
    """Documents, signers, trusted authorities, the verifier, and a folder."""

    genuine: Genuine
    signers: Signers
    roots_file: Path
    verify: Verify
    tmp_path: Path


@pytest.fixture
def bench(genuine: Genuine, signers: Signers, roots_file: Path, verify: Verify, tmp_path: Path) -> Bench:
    return Bench(genuine, signers, roots_file, verify, tmp_path)


@pytest.fixture
def any_key(monkeypatch: pytest.MonkeyPatch) -> None:
    """Sign with keys that `sign` refuses, as other programs do."""
    monkeypatch.setattr(key_files, "_check_usable", lambda *_: None)


def list_details(report: Report, *beginnings: str) -> list[str]:
    checks = [check for check in report["checks"] if check["statement"].startswith(beginnings)]
    return [line.strip() for check in checks for line in check["details"]]


def compare(verify: Verify, document: Path, roots: Path | None) -> tuple[Report, SignatureReport]:
    """Both verifiers on a document with its signature file: the same words, contradictions and conclusion."""
    beside = document.with_name(f"{document.name}.p7s")
    signature = beside.read_bytes() if beside.exists() else None
    report = verify(document.read_bytes(), document.name, signature, None if roots is None else roots.read_bytes())
    expected = check_signatures(document, roots)
    assert list_details(report, *BROKEN) == list(expected.contradictions)
    assert list_details(report, *ORIGINS) == [line.strip() for line in describe_signatures(expected)]
    stated = [(check["outcome"], check["statement"]) for check in report["checks"]]
    origin = [pair for pair in stated if pair[1].startswith((*BROKEN, *HOLDING, *ORIGINS))]
    assert origin == [(check.outcome, check.statement) for check in check_origin(expected)]
    assert report["conclusion"].startswith("authentic: ") == (expected.authentic and not list_details(report, *BROKEN))
    return report, expected


def write(folder: Path, name: str, content: bytes) -> Path:
    folder.mkdir(exist_ok=True)
    (folder / name).write_bytes(content)
    return folder / name


Sign = Callable[[Path], object]


def list_holders(signers: Signers) -> Iterator[tuple[str, Sign]]:
    """Ways to sign a file, by the reason of trust or distrust that `verify` prints."""
    from cryptography.hazmat.primitives.asymmetric import rsa
    from cryptography.x509.oid import ExtendedKeyUsageOID

    from helpers.authorities import issue, request, serve_time_stamps

    def stamp(clock: Any, holder: Any, hours: float) -> Sign:
        def call(path: Path) -> None:
            with serve_time_stamps(clock, datetime.now(UTC).replace(microsecond=0) - timedelta(hours=hours)) as url:
                sign(path, holder, timestamp_url=url)

        return call

    def by(holder: Any, **options: Any) -> Sign:
        return lambda path: sign(path, holder, **options)

    def large() -> Any:
        return rsa.generate_private_key(public_exponent=65537, key_size=2048)

    authority = {"authority": True, "usages": ("key_cert_sign",)}
    old = signers.issue("Old authority", (-9, -1), **authority)
    deep = issue(request("Deep authority", **authority), signers.issue("Middle authority", **authority))
    former = signers.issue("Former Signer", (-9, -0.25))
    purpose = ExtendedKeyUsageOID.TIME_STAMPING
    yield "trusted: its chain leads to Test root", by(signers.author)
    yield "signed by Ada Author as Prüfer (EBA) 1", by(signers.author, role="Prüfer (EBA) 1")
    yield "trusted: its chain leads to Test root", by(signers.assessor, encoding="pem")
    yield "trusted: its chain leads to Test root", by(issue(request("Rita RSA"), signers.root, large()))
    yield "does not lead to a given trust root", by(replace(signers.author, authority=None))
    yield "does not lead to a given trust root", by(issue(request("Mallory")))
    namesake = issue(request("Test root", **authority))
    yield "does not lead to a given trust root", by(issue(request("Ada Author"), namesake))
    yield "does not lead to a given trust root", by(issue(request("Ada Author"), deep))  # its authority is not sent
    yield "the signing certificate expired on ", by(signers.issue("Late Signer", (-9, -1)))
    yield "the signing certificate is not valid before ", by(signers.issue("Early Signer", (1, 9)))
    yield "lacks the key usage", by(signers.issue("No Signer", usages=("key_encipherment",)))
    yield "for other purposes (server auth)", by(signers.issue("Server", purpose=ExtendedKeyUsageOID.SERVER_AUTH))
    yield "the authority Old authority expired on ", by(issue(request("Ada Author"), old))
    yield "validity was checked at this time", stamp(signers.clock, former, 12)
    own = issue(request("Own clock", purpose=purpose), None, large())
    yield "its authority Own clock is not trusted", stamp(own, former, 12)
    yield "its authority No clock is not trusted", stamp(issue(request("No clock"), signers.root, large()), former, 12)


@pytest.mark.usefixtures("any_key")
def test_signature_files(bench: Bench) -> None:
    """Trusted and distrusted signers, with and without a trust root: the words of both verifiers are equal."""
    genuine, signers, roots_file, verify, tmp_path = bench
    html = genuine.html.encode()
    for number, (reason, sign_file) in enumerate(list_holders(signers)):
        document = write(tmp_path / f"{number}", "certificate.html", html)
        if not number:
            compare(verify, document, roots_file)  # unsigned, with a trust root
        sign_file(document)
        report, _ = compare(verify, document, roots_file)
        assert reason in "\n".join(list_details(report, *ORIGINS)), reason
        unasked, _ = compare(verify, document, None)
        for unknown in (unasked, *([] if report["authentic"] else [report])):
            assert unknown["conclusion"].startswith("NOT TRUSTED: the document claims to be signed by ")
            assert unknown["state"] == "consistent"


@pytest.mark.usefixtures("any_key")
def test_keys_and_chains_at_their_bounds(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    """Strength of keys and digests, length of a path, an authority that is none, and a root that signs itself."""
    genuine, signers, roots_file, verify, tmp_path = bench
    from asn1crypto import cms, x509
    from cryptography.hazmat.primitives.asymmetric import ec, ed25519, rsa
    from cryptography.hazmat.primitives.serialization import Encoding

    from helpers.authorities import issue, request

    authority = {"authority": True, "usages": ("key_cert_sign",)}
    short = signers.issue("Short authority", path_length=0, **authority)
    own = issue(request("Own root"))
    weak = rsa.generate_private_key(public_exponent=65537, key_size=1024)
    further = issue(request("Further authority", **authority), short)
    below = issue(request("Below a further one"), further)
    for number, (holder, digest, trusted) in enumerate(
        (
            (issue(request("P-521"), signers.root, ec.generate_private_key(ec.SECP521R1())), "sha512", True),
            (issue(request("Below"), short), "sha256", True),
            (below, "sha256", False),
            (issue(request("Weak"), signers.root, weak), "sha256", False),
            (issue(request("Mallory"), signers.assessor), "sha256", False),
            (own, "sha256", True),
        )
    ):
        monkeypatch.setattr(signature_writing, "select_digest", lambda _, name=digest: name)
        document = write(tmp_path / f"{number}", "certificate.html", genuine.html.encode())
        signature = sign(document, holder)
        if holder is below:  # the key file holds one authority
            message = cms.ContentInfo.load(signature.read_bytes())
            added = x509.Certificate.load(short.certificate.public_bytes(Encoding.DER))
            message["content"]["certificates"].append(cms.CertificateChoices("certificate", added))
            signature.write_bytes(message.dump(force=True))
        report, _ = compare(
            verify, document, own.write_certificate(tmp_path / "own.pem") if holder is own else roots_file
        )
        assert report["authentic"] == trusted, holder.certificate.subject
    curve = issue(request("Other curve"), signers.root, ec.generate_private_key(ec.BrainpoolP256R1()))
    edwards = issue(request("Ed25519"), signers.root, ed25519.Ed25519PrivateKey.generate())
    for holder, digest, reason in (
        (edwards, "sha512", "the algorithm of a signature is weak or not known here"),
        (curve, "sha256", "the algorithm of a key is not known here"),
        (signers.assessor, "sha1", "the algorithm of a signature is weak or not known here"),
    ):
        monkeypatch.setattr(signature_writing, "select_digest", lambda _, name=digest: name)
        signature = sign(write(tmp_path / digest, "results.json", b"{}"), holder).read_bytes()
        report = verify(genuine.html.encode(), "certificate.html", signature, None)
        assert report["state"] == "incomplete"
        assert list_details(report, *ORIGINS) == [f"signatures were not checked: {reason}."]


@pytest.mark.usefixtures("any_key")
def test_signatures_of_other_content(bench: Bench) -> None:
    """A changed document, and signed data that bring their own content, which the library would check instead."""
    genuine, signers, roots_file, verify, tmp_path = bench
    from asn1crypto import cms

    document = write(tmp_path / "a", "certificate.html", genuine.html.encode())
    other = write(tmp_path / "b", "certificate.html", b"other")
    signature = sign(document, signers.author)
    sign(document, signers.assessor, role="assessor")
    report, _ = compare(verify, document, roots_file)
    assert report["conclusion"].startswith("authentic: ")
    foreign = cms.ContentInfo.load(sign(other, signers.author).read_bytes())
    foreign["content"]["encap_content_info"] = {"content_type": "data", "content": b"other"}
    carried = verify(document.read_bytes(), document.name, foreign.dump(force=True), roots_file.read_bytes())
    damage = "the signature is damaged (it contains its content)"
    assert list_details(carried, *BROKEN) == [f"signature 1 (unknown): {damage}"]
    document.write_bytes(document.read_bytes() + b"\n")
    report, _ = compare(verify, document, roots_file)
    assert report["state"] == "contradicted"
    (tmp_path / "b" / "certificate.html").write_bytes(document.read_bytes())
    compare(verify, other, roots_file)
    for content in (b"x", b"0\x80", signature.read_bytes()[:-9], b"-----BEGIN CMS-----\nAAAA\n-----END CMS-----\n"):
        refused = verify(document.read_bytes(), document.name, content, roots_file.read_bytes())
        assert refused["state"] == "refused"
        assert refused["conclusion"].startswith("the signature file is damaged")
    for roots, found in ((b"x", "a damaged certificate"), (b"-----BEGIN A-----\n-----END A-----\n", "no certificate")):
        refused = verify(document.read_bytes(), document.name, None, roots)
        assert refused["conclusion"] == f"trust roots 'roots.pem': holds {found}"


def test_signatures_inside_a_pdf(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    """Signatures in sequence, and every update beside or inside of one: the same changes in the same words."""
    genuine, signers, roots_file, verify, tmp_path = bench
    document = write(tmp_path / "s", "certificate.pdf", genuine.pdf)
    signed = sign(document, signers.author, place="top-left")
    once = signed.read_bytes()
    compare(verify, sign(signed, signers.assessor, role="assessor"), roots_file)
    report, _ = compare(verify, signed, None)
    assert report["conclusion"].startswith("NOT TRUSTED: the document claims to be signed by Ada Author, Ben Assessor;")
    for name, (change, expected) in (UPDATES | HIDDEN).items():
        updated = sign_with(change, write(tmp_path / name, "certificate.pdf", genuine.pdf), signers, monkeypatch)
        report, _ = compare(verify, updated, roots_file)
        assert expected in "\n".join(list_details(report, *BROKEN)), name
        if name in UPDATES:
            writer = signature_writing._open_writer(once, "report")
            change(writer)
            with updated.open("wb") as file:
                writer.write(file)
            changed, expected_changes = compare_state(verify, updated, roots_file)
            assert "2 revisions were added to the document, 1 of them by a signature" in changed
            assert expected_changes


def compare_state(verify: Verify, document: Path, roots: Path) -> tuple[list[str], bool]:
    """Contradictions of the signatures in the browser; both verifiers find one, or neither does."""
    report = verify(document.read_bytes(), document.name, None, roots.read_bytes())
    found = list_details(report, *BROKEN)
    assert report["state"] == "refused" or bool(found) == bool(check_signatures(document, roots).contradictions)
    assert not report["conclusion"].startswith("authentic")
    return found, bool(found)


def test_forged_signed_pdfs(bench: Bench) -> None:
    """Forged files that are made from a signed document, and bytes changed inside and outside of its range."""
    genuine, signers, roots_file, verify, tmp_path = bench
    signed = sign(write(tmp_path, "certificate.pdf", genuine.pdf), signers.author)
    content = signed.read_bytes()
    start, end = content.rindex(b"/Contents <") + 11, content.rindex(b">\n/")
    value = start + len(content[start:end].rstrip(b"0")) - 9
    forged = {name: PDF_FORGERIES[name](content, random.Random(f"{SEED} {name}")) for name in KINDS}
    for name, place in (("page", 9000), ("field", content.rindex(b"/T (") + 5), ("digits of the signature", value)):
        forged[name] = content[:place] + bytes([content[place] ^ 1]) + content[place + 1 :]
    forged["signature emptied"] = content[:start] + b"0" * (end - start) + content[end:]
    forged["range shortened"] = content.replace(b"/ByteRange [0 ", b"/ByteRange [1 ", 1)
    forged["pages of another document"] = genuine.pdf.replace(b"/Lang(en)", b"/Lang(de)") + content[len(genuine.pdf) :]
    for name, changed in forged.items():
        assert changed != content, name
        signed.write_bytes(changed)
        compare_state(verify, signed, roots_file)


def test_browser_without_cryptography(bench: Bench, verifier_page: Any) -> None:
    """Some browsers offer no cryptography to a local file: a signature is then not checked, and never trusted."""
    genuine, signers, roots_file, verify, tmp_path = bench
    signed = sign(write(tmp_path, "certificate.pdf", genuine.pdf), signers.author)
    assert verifier_page.evaluate("[location.protocol, isSecureContext]") == ["file:", True]
    reason = "signatures were not checked: this browser offers no cryptography to a local file."
    hide = "() => Object.defineProperty(globalThis, 'crypto', { value: {}, configurable: true })"
    verifier_page.evaluate(hide)
    try:
        for roots in (None, roots_file.read_bytes()):
            report = verify(signed.read_bytes(), signed.name, None, roots)
            assert (report["state"], report["authentic"]) == ("incomplete", False)
            assert list_details(report, *ORIGINS) == [reason]
            assert list_details(report, *BROKEN) == []
            assert report["conclusion"].startswith("NOT TRUSTED: the document claims to be signed; ")
    finally:
        verifier_page.evaluate("() => delete globalThis.crypto")
