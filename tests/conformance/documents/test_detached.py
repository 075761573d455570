"""Detached signatures of results and pages: beside the document, in DER or PEM, several for one document."""

import asyncio
import shutil
import subprocess
from concurrent.futures import ThreadPoolExecutor
from http.server import BaseHTTPRequestHandler
from pathlib import Path

import pytest

from helpers.signed_files import sign
from helpers.signer_fixtures import Signers
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.documents.signature_check import check_signatures


@pytest.fixture
def document(tmp_path: Path, signers: Signers) -> Path:
    assert signers
    (tmp_path / "results.json").write_bytes(b"<p>r\xc3\xa9sultats</p>\r\n")
    return tmp_path / "results.json"


@pytest.mark.parametrize(("name", "encoding"), [("results.json", "der"), ("certificate.html", "pem")])
def test_signature_beside_the_document(
    document: Path, signers: Signers, roots_file: Path, name: str, encoding: str
) -> None:
    content, document = document.read_bytes(), document.rename(document.with_name(name))
    signature = sign(document, signers.author, encoding=encoding)
    assert signature.name == document.name + ".p7s"
    assert signature.read_bytes().startswith(b"-----BEGIN CMS-----\n") == (encoding == "pem")
    assert document.read_bytes() == content
    assert check_signatures(document, roots_file).authentic
    document.write_bytes(content.replace(b"r\xc3", b"R\xc3"))
    report = check_signatures(document, roots_file)
    assert report.contradictions == ("signature 1 (Ada Author): the content was changed after signing",)
    assert check_signatures(document, None).contradictions == report.contradictions


def test_signing_and_checking_inside_a_running_event_loop(document: Path, signers: Signers, roots_file: Path) -> None:
    """A notebook runs its cells inside an event loop; the package starts one of its own."""

    async def sign_and_check() -> bool:
        sign(document, signers.author)
        return check_signatures(document, roots_file).authentic

    with ThreadPoolExecutor(1) as pool:  # a browser of other tests keeps a loop in this thread
        assert pool.submit(lambda: asyncio.run(sign_and_check())).result()


def test_two_signatures_in_one_file_of_one_version(document: Path, signers: Signers, roots_file: Path) -> None:
    sign(document, signers.author, role="author", encoding="pem")
    sign(document, signers.assessor, role="assessor of the company, 2nd")
    report = check_signatures(document, roots_file)
    assert report.authentic
    roles = {facts.signer: facts.role for facts in report.signatures}
    assert roles == {"Ada Author": "author", "Ben Assessor": "assessor of the company, 2nd"}
    signature = sign(document, signers.author)
    earlier = signature.read_bytes()
    document.write_bytes(b"written anew")
    with pytest.raises(InputError, match="belongs to another version of the document"):
        sign(document, signers.assessor)
    assert signature.read_bytes() == earlier


def test_damaged_signature_files(document: Path) -> None:
    for content in (b"", b"hello", b"-----BEGIN CMS-----\nAAAA\n-----END CMS-----\n", b"0\x80" * 100_000):
        document.with_name(document.name + ".p7s").write_bytes(content)
        with pytest.raises(InputError, match="is not a CMS signature"):
            check_signatures(document, None)


def test_every_damage_is_reported(document: Path, signers: Signers, roots_file: Path) -> None:
    """A changed byte of the signature file never leaves the document authentic with other facts."""
    signature = sign(document, signers.author)
    content = signature.read_bytes()
    (genuine,) = check_signatures(document, roots_file).signatures
    for place in range(0, len(content), 41):
        damaged = bytearray(content)
        damaged[place] ^= 0x15
        signature.write_bytes(damaged)
        try:
            report = check_signatures(document, roots_file)
        except InputError:
            continue
        assert all(len(facts.damage) < 200 for facts in report.signatures)  # parsers may print numbers without end
        if report.authentic:  # a certificate of the chain that is not needed, or the order of a list
            (facts,) = report.signatures
            assert (facts.signer, facts.role, facts.stated_time) == (genuine.signer, genuine.role, genuine.stated_time)


@pytest.mark.skipif(shutil.which("openssl") is None, reason="openssl is not installed")
def test_openssl_confirms_the_signatures(document: Path, signers: Signers, roots_file: Path) -> None:
    """A second implementation accepts both signatures, and refuses them for another document."""
    sign(document, signers.author)
    signature = sign(document, signers.assessor)
    command = ["openssl", "cms", "-verify", "-binary", "-inform", "DER", "-in", str(signature), "-purpose", "any"]
    command += ["-CAfile", str(roots_file), "-out", "/dev/null", "-content"]
    assert subprocess.run([*command, str(document)], capture_output=True, check=False).returncode == 0
    document.write_bytes(b"other")
    assert subprocess.run([*command, str(document)], capture_output=True, check=False).returncode != 0


def test_time_stamp_servers_that_fail(document: Path, signers: Signers) -> None:
    """A refusal, another page and a time stamp of another request end with one message; nothing is written."""
    import threading
    from http.server import HTTPServer

    from asn1crypto import tsp

    status = tsp.PKIStatusInfo({"status": "rejection"}).dump()
    refusal = bytes([0x30, len(status)]) + status  # a sequence without a time stamp

    class Handler(BaseHTTPRequestHandler):
        def do_POST(self) -> None:
            self.send_response(200 if self.path != "/500" else 500)
            self.end_headers()
            self.wfile.write({"/refusal": refusal, "/page": b"<html>"}.get(self.path, b""))

        def log_message(self, *_: object) -> None:
            pass

    server = HTTPServer(("127.0.0.1", 0), Handler)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    try:
        for page in ("refusal", "page", "empty", "500"):
            message = "gave no time stamp" if page == "500" else "it answered without a time stamp"
            with pytest.raises(InputError, match=message):
                sign(document, signers.author, timestamp_url=f"http://127.0.0.1:{server.server_port}/{page}")
    finally:
        server.shutdown()
        server.server_close()
    assert not document.with_name(document.name + ".p7s").exists()
