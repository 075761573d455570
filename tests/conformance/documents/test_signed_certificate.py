"""A signed certificate: the commands, hostile names, a visible signature, and a second implementation."""

import io
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from pypdf import PdfReader
from typer.testing import CliRunner

from helpers.graded_wave import render_document
from helpers.signed_files import sign
from helpers.signer_fixtures import Signers
from pantocheck.conformance.app.commands.command_list import app
from pantocheck.conformance.app.commands.sign_command import PASSPHRASE_VARIABLE
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.documents.signature_check import check_signatures
from pantocheck.conformance.documents.signature_writing import BOXES
from pantocheck.conformance.results.results_format import Results


def invoke(*arguments: Any) -> Any:
    return CliRunner().invoke(app, list(map(str, arguments)), env={PASSPHRASE_VARIABLE: "secret"})


@pytest.fixture
def passing_certificate(accepted_wave: Results, tmp_path: Path) -> Path:
    path = tmp_path / "certificate.pdf"
    path.write_bytes(render_document(accepted_wave.to_dict(), path.name))
    return path


def one_line(output: str) -> str:
    """Output without its line breaks."""
    return " ".join(output.split())


def test_commands_from_signing_to_authentic(
    passing_certificate: Path, signers: Signers, roots_file: Path, tmp_path: Path
) -> None:
    """Author and assessor sign with two commands; `verify` names both, and trusts them with the root only."""
    unsigned = passing_certificate.read_bytes()
    author = signers.author.write_pkcs12(tmp_path / "author.p12", b"secret")
    assessor = signers.assessor.write_pkcs12(tmp_path / "assessor.p12", b"secret")
    signed = tmp_path / "certificate-signed.pdf"
    first = invoke("sign", passing_certificate, "--key", author, "--visible", "top-left")
    assert (first.exit_code, first.stdout) == (0, f"Signed by Ada Author as author\n{signed}\n")
    second = invoke("sign", signed, "--key", assessor, "--role", "assessor")
    assert (second.exit_code, second.stdout) == (0, f"Signed by Ben Assessor as assessor\n{signed}\n")
    assert passing_certificate.read_bytes() == unsigned
    assert signed.read_bytes().startswith(unsigned)

    trusted = invoke("verify", signed, "--trust-roots", roots_file)
    assert trusted.exit_code == 0
    assert trusted.stdout.startswith("authentic: the verdict 'PASS")
    text = one_line(trusted.stdout)
    assert "signature 2: signed by Ben Assessor as assessor (trusted: its chain leads to Test root)." in text
    assert "Revocation of certificates was not checked" in text

    named = invoke("verify", signed)
    assert named.exit_code == 1
    assert one_line(named.stdout).startswith(
        "NOT TRUSTED: the document claims to be signed by Ada Author, Ben Assessor; the verdict 'PASS"
    )
    assert "claims to be signed by Ada Author as author (not trusted: no trust root given)" in one_line(named.stdout)
    assert invoke("verify", signed, "--numbers-only").exit_code == 0

    bare = invoke("verify", passing_certificate)
    assert bare.exit_code == 1
    assert one_line(bare.stdout).startswith(
        "UNSIGNED: the numbers are consistent, anyone can have written this document; the verdict 'PASS"
    )
    assert "unsigned: nothing shows who made this document." in bare.stdout
    numbers = invoke("verify", passing_certificate, "--numbers-only")
    assert (numbers.exit_code, numbers.stdout[:12]) == (0, "consistent: ")
    demanded = invoke("verify", passing_certificate, "--trust-roots", roots_file)
    assert demanded.exit_code == 1
    assert demanded.stdout.startswith("UNSIGNED: ")
    assert "The document has no signature to compare with the trust roots." in one_line(demanded.stdout)
    # Whoever names an authority is not content with the numbers alone.
    assert invoke("verify", passing_certificate, "--trust-roots", roots_file, "--numbers-only").exit_code == 1

    again = invoke("sign", passing_certificate, "--key", author)
    assert again.exit_code == 2
    assert "certificate-signed.pdf: exists already" in again.stderr
    itself = invoke("sign", passing_certificate, "--key", author, "--out", passing_certificate)
    assert itself.exit_code == 2
    assert "names the unsigned document" in itself.stderr
    assert passing_certificate.read_bytes() == unsigned


@pytest.mark.thorough
def test_failing_certificate_may_be_authentic(
    wave_results: Results, signers: Signers, roots_file: Path, tmp_path: Path
) -> None:
    """A signature shows who made a document. It does not improve its verdict."""
    (tmp_path / "certificate.pdf").write_bytes(render_document(wave_results.to_dict(), "certificate.pdf"))
    signed = sign(tmp_path / "certificate.pdf", signers.author)
    result = invoke("verify", signed, "--trust-roots", roots_file)
    assert result.exit_code == 1
    assert result.stdout.startswith("authentic: the verdict 'FAIL' follows")


def test_unusable_trust_roots(passing_certificate: Path, signers: Signers, tmp_path: Path) -> None:
    signed = sign(passing_certificate, signers.author)
    (tmp_path / "empty.pem").write_text("no certificate")
    for roots, message in (("none.pem", "cannot be read"), ("empty.pem", "holds a damaged certificate")):
        result = invoke("verify", signed, "--trust-roots", tmp_path / roots)
        assert result.exit_code == 2
        assert message in result.stderr


def test_hostile_names_are_escaped(passing_certificate: Path, tmp_path: Path, signers: Signers) -> None:
    """Names in certificates reach neither the terminal nor the page as commands."""
    name = "Eve\x1b[2J\u202egnp\r\n<script> #panic() \x07"
    signed = sign(passing_certificate, signers.issue(name), place="top-right", role="#eval(1) ${x}")
    output = invoke("verify", signed).stdout
    assert "signed by Eve [2Jgnp <script> #panic() as #eval(1) ${x}" in one_line(output)
    assert all(character.isprintable() or character == "\n" for character in output)
    widget = PdfReader(signed).pages[0]["/Annots"][0].get_object()
    assert widget["/T"] == "#eval(1) ${x}"


@pytest.mark.parametrize("place", BOXES)
def test_visible_signature(passing_certificate: Path, signers: Signers, place: str) -> None:
    """The box lies at its place in the margin above the header, and its fonts are embedded, as PDF/A demands."""
    left, bottom, right, top = BOXES[place]
    assert (right - left, top - bottom) == (158, 22)  # equal boxes, in equal margins at both sides
    signed = sign(passing_certificate, signers.author, place=place)
    reader = PdfReader(signed)
    widget = reader.pages[0]["/Annots"][0].get_object()
    assert [round(float(edge)) for edge in widget["/Rect"]] == list(BOXES[place])
    drawing = widget["/AP"]["/N"]["/Resources"]["/XObject"]["/SignatureBox"]
    fonts = [font.get_object() for font in drawing["/Resources"]["/Font"].values()]
    assert fonts
    for font in fonts:
        descriptor = font["/DescendantFonts"][0].get_object()["/FontDescriptor"]
        assert any(key.startswith("/FontFile") for key in descriptor)
    with pytest.raises(InputError, match=f"a signature is already at {place}"):
        sign(signed, signers.assessor, place=place)


@pytest.mark.skipif(shutil.which("pdfsig") is None, reason="pdfsig (poppler) is not installed")
def test_poppler_confirms_the_signatures(passing_certificate: Path, signers: Signers) -> None:
    """A second implementation finds both signatures valid, and the second one over the whole document."""
    signed = sign(sign(passing_certificate, signers.author, place="top-left"), signers.assessor)
    text = subprocess.run(["pdfsig", "-nocert", str(signed)], capture_output=True, check=False, text=True).stdout
    assert text.count("Signature Validation: Signature is Valid.") == 2
    assert text.count("ETSI.CAdES.detached") == 2
    assert text.count("Total document signed") == 1


def test_without_the_package(
    passing_certificate: Path, signers: Signers, roots_file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Without pyHanko, a signature is named as not checked: the verification is incomplete, and never accepted."""
    import sys

    signed = sign(passing_certificate, signers.author)
    for name in [*(name for name in sys.modules if name.startswith("pyhanko")), "pyhanko"]:
        monkeypatch.setitem(sys.modules, name, None)
    result = invoke("verify", signed)
    assert result.exit_code == 1
    assert "signatures were not checked: the check needs the package pyhanko" in one_line(result.stdout)
    assert "pip install 'pantocheck[sign]'" in one_line(result.stdout)
    demanded = invoke("verify", signed, "--trust-roots", roots_file)
    assert demanded.exit_code == 2
    assert not check_signatures(signed, None).authentic


@pytest.mark.thorough
def test_signed_copy_shows_the_same_pages(passing_certificate: Path, signers: Signers) -> None:
    signed = sign(passing_certificate, signers.author, place="top-centre")
    before, after = (PdfReader(io.BytesIO(path.read_bytes())) for path in (passing_certificate, signed))
    assert [page.extract_text() for page in before.pages] == [page.extract_text() for page in after.pages]
    assert before.attachments["results.json"] == after.attachments["results.json"]
    assert before.metadata == after.metadata


@pytest.mark.parametrize("name", [pytest.param("certificate.html", marks=pytest.mark.thorough), "results.json"])
def test_signature_beside_a_document(
    accepted_wave: Results, signers: Signers, roots_file: Path, tmp_path: Path, name: str
) -> None:
    """`verify` finds the signature file by its name; a changed document contradicts it."""
    document = tmp_path / name
    document.write_bytes(render_document(accepted_wave.to_dict(), name))
    key = signers.author.write_pkcs12(tmp_path / "author.p12", b"secret")
    assert invoke("sign", document, "--key", key).stdout == f"Signed by Ada Author as author\n{document}.p7s\n"
    # A process of its own: the package that signs also registers the attributes of a signature.
    command = [sys.executable, "-m", "pantocheck", "verify", str(document), "--trust-roots", str(roots_file)]
    verified = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (verified.returncode, verified.stdout[:11], verified.stderr) == (0, "authentic: ", "")
    document.write_bytes(document.read_bytes() + b"\n")
    changed = invoke("verify", document, "--trust-roots", roots_file)
    assert changed.exit_code == 1
    assert "the content was changed after signing" in one_line(changed.stdout)


def invent(results: dict[str, Any]) -> dict[str, Any]:
    """Results of another system, without a contradiction: no check of numbers can find this."""
    return results | {"system": results["system"] | {"name": "my simulator"}}


@pytest.mark.thorough
@pytest.mark.parametrize("name", ["certificate.pdf", "certificate.html", "results.json"])
@pytest.mark.parametrize("signature", ["removed", "kept", "of the forger"])
def test_invented_results_are_detected_by_the_signature(
    wave_results: Results, signers: Signers, roots_file: Path, tmp_path: Path, name: str, signature: str
) -> None:
    """A document made anew from invented results is consistent, and whoever demands a trusted signature refuses it."""
    from helpers.authorities import issue, request

    document = tmp_path / name
    document.write_bytes(render_document(wave_results.to_dict(), name))
    genuine = sign(document, signers.author)
    forged = render_document(invent(wave_results.to_dict()), name)
    if signature == "of the forger":
        (tmp_path / "forged").mkdir()
        document = tmp_path / "forged" / name
        document.write_bytes(forged)
        path = sign(document, issue(request("Ada Author")))
        document = path if name.endswith("pdf") else document
    elif signature == "removed":
        document.write_bytes(forged)
        genuine.unlink()
    elif name.endswith("pdf"):
        update = genuine.read_bytes()[len(document.read_bytes()) :]
        document = genuine
        document.write_bytes(forged + update)
    else:
        document.write_bytes(forged)
    report = check_signatures(document, roots_file)
    assert not report.authentic
    assert bool(report.contradictions) is (signature == "kept")  # the others are UNSIGNED and NOT TRUSTED
