"""The page on signatures: its commands work as printed, each in a process of its own."""

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest

from helpers.graded_wave import render_document
from helpers.pdf_updates import add_content, sign_with
from helpers.signed_files import sign
from helpers.signer_fixtures import Signers
from pantocheck.conformance.documents import key_files, signature_writing
from pantocheck.conformance.results.results_format import Results

PAGE = Path(__file__).parents[2] / "docs" / "signing.md"


@pytest.mark.thorough
@pytest.mark.skipif(shutil.which("openssl") is None, reason="openssl is not installed")
@pytest.mark.skipif(shutil.which("bash") is None, reason="the commands are those of a shell")
def test_commands_of_the_test_authority(accepted_wave: Results, tmp_path: Path) -> None:
    pytest.importorskip("pyhanko", reason="extra sign")
    (tmp_path / "report").mkdir()
    for name in ("certificate.pdf", "results.json"):
        (tmp_path / "report" / name).write_bytes(render_document(accepted_wave.to_dict(), name))
    commands = PAGE.read_text(encoding="utf-8").split("## A test authority")[1].split("```sh\n")[1].split("```")[0]
    program = f"{sys.executable} -c 'from pantocheck.conformance.app.main import start; start()'"
    script = f'set -e\npantocheck() {{ {program} "$@"; }}\n{commands}'
    folder = str(Path(sys.executable).parent)
    done = subprocess.run(
        ["bash", "-c", script], cwd=tmp_path, env=os.environ | {"PATH": f"{folder}{os.pathsep}{os.environ['PATH']}"},
        capture_output=True, check=False, text=True,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    assert "\nauthentic: the verdict 'PASS" in done.stdout
    output = " ".join(done.stdout.split())
    assert "signed by Test author as author (trusted: its chain leads to Test authority)" in output
    assert "signed by Test assessor as assessor (trusted" in output
    assert (tmp_path / "report" / "results.json.p7s").exists()


def run(folder: Path, arguments: str) -> tuple[int, str]:
    """Exit code and output, on one line, of a command in a folder, as a new process."""
    environment = os.environ | {"PANTOCHECK_PASSPHRASE": "secret"}
    command = [sys.executable, "-m", "pantocheck", *arguments.split()]
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    assert done.stderr == ""
    return done.returncode, " ".join(done.stdout.split())


def list_doubtful(folder: Path, signers: Signers, patch: pytest.MonkeyPatch) -> Iterator[tuple[str, str]]:
    """Signed documents that a trust root does not make authentic, one at a time, with the reason that is printed."""
    from helpers.authorities import issue, list_revoked, request

    pdf, json, beside = (folder / name for name in ("certificate.pdf", "results.json", "results.json.p7s"))
    patch.setattr(key_files, "_check_usable", lambda *_: None)  # `sign` refuses an expired key
    for holder, reason in (
        (signers.issue("Late Signer", (-9, -1)), "the signing certificate expired on"),
        (issue(request("Ada Author")), "its chain does not lead to a given trust root"),
        (signers.assessor, "the signing certificate was revoked on"),
    ):
        beside.unlink(missing_ok=True)
        sign(json, holder)
        if holder is signers.assessor:
            roots = folder / "roots.pem"
            roots.write_bytes(roots.read_bytes() + list_revoked(signers.root, [signers.assessor]))
        yield json.name, reason
    signers.root.write_certificate(folder / "roots.pem")
    signed = sign(pdf, signers.author)
    content = signed.read_bytes()
    writer = signature_writing._open_writer(content, "report")
    add_content(writer)
    with signed.open("wb") as file:
        writer.write(file)
    yield signed.name, "2 revisions were added to the document, 1 of them by a signature"
    signed.unlink()
    sign_with(add_content, pdf, signers, patch)  # hidden behind a valid signature of a trusted signer
    yield signed.name, "revision 1 of the document is more than a signature: /Contents of the page changed"
    signed.write_bytes(content.replace(b"/Reason (author)", b"/Reason (notary)"))
    yield signed.name, "the content was changed after signing"


@pytest.mark.thorough
def test_keys_of_a_company_and_documents_in_doubt(
    accepted_wave: Results, signers: Signers, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A key with its chain, a time stamp, and signatures that do not hold or are not trusted."""
    from cryptography.hazmat.primitives.serialization import Encoding

    from helpers.authorities import serve_time_stamps

    (tmp_path / "report").mkdir()
    for folder in (tmp_path, tmp_path / "report"):
        for name in ("certificate.pdf", "results.json"):
            (folder / name).write_bytes(render_document(accepted_wave.to_dict(), name))
    author = signers.author
    author.write_key(tmp_path / "author.pem", b"secret")
    signers.root.write_certificate(tmp_path / "roots.pem")
    chain = (author.certificate, author.authority)
    (tmp_path / "chain.pem").write_bytes(b"".join(part.public_bytes(Encoding.PEM) for part in chain))
    commands = re.findall(r"```text\npantocheck (.*)\n```", PAGE.read_text(encoding="utf-8"))
    assert [command.split()[0] for command in commands] == ["sign", "verify"]
    moment = datetime.now(UTC).replace(microsecond=0) - timedelta(hours=12)
    with serve_time_stamps(signers.clock, moment) as url:
        assert run(tmp_path, f"{commands[0]} --timestamp-url {url}")[0] == 0
    code, output = run(tmp_path, commands[1])
    assert (code, output[:11]) == (0, "authentic: ")
    assert f"Time stamp: {key_files.format_moment(moment)}; validity was checked at this time." in output
    for name, reason in list_doubtful(tmp_path, signers, monkeypatch):
        code, output = run(tmp_path, f"verify {name} --trust-roots roots.pem")
        first = "NOT TRUSTED: the" if name == "results.json" else "not consistent: "
        assert (code, output[:16]) == (1, first), reason
        assert reason in output
