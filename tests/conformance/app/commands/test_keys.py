"""Keys, certificates and passphrases: accepted forms, and one message for each that cannot be used."""

import getpass
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from helpers.command_line import pantocheck
from helpers.signer_fixtures import Signers
from pantocheck.conformance.app.commands.sign_command import PASSPHRASE_VARIABLE, read_passphrase
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.documents.key_files import read_signing_key


def never() -> bytes:
    raise AssertionError("a key without encryption needs no passphrase")


def test_forms_of_keys(signers: Signers, tmp_path: Path) -> None:
    """PKCS#12 and PEM, encrypted or not, with the certificate inside or beside; each gives the same certificate."""
    holder = signers.author
    certificate = holder.write_certificate(tmp_path / "author.crt")
    pem = holder.write_key(tmp_path / "key.pem", b"secret")
    both = tmp_path / "both.pem"
    both.write_bytes(certificate.read_bytes() + holder.write_key(tmp_path / "open.pem", None).read_bytes())
    forms: list[tuple[Path, Path | None, Callable[[], bytes]]] = [
        (holder.write_pkcs12(tmp_path / "key.p12", b"secret"), None, lambda: b"secret"),
        (holder.write_pkcs12(tmp_path / "open.p12", None), None, never),
        (pem, certificate, lambda: b"secret"),
        (both, None, never),
    ]
    for path, beside, ask in forms:
        key = read_signing_key(path, beside, ask)
        assert key.holder == "Ada Author"
        assert "PRIVATE" not in repr(key)
        assert "Ada" not in repr(key)
    key = read_signing_key(signers.author.write_pkcs12(tmp_path / "key.p12", b"secret"), None, lambda: b"secret")
    assert [certificate.subject.native["common_name"] for certificate in key.chain] == ["Test authority"]


def write_text(path: Path, content: bytes) -> Path:
    path.write_bytes(content)
    return path


def server_purpose() -> Any:
    from cryptography.x509.oid import ExtendedKeyUsageOID

    return ExtendedKeyUsageOID.SERVER_AUTH


def small_rsa(signers: Signers, folder: Path) -> Path:
    from cryptography.hazmat.primitives.asymmetric import rsa

    from helpers.authorities import issue, request

    key = rsa.generate_private_key(public_exponent=65537, key_size=1024)
    return Path(issue(request("Small"), signers.root, key).write_pkcs12(folder / "key", b"secret"))


FAULTS: dict[str, tuple[Callable[[Signers, Path], Path], str]] = {
    "wrong passphrase of PKCS#12": (lambda s, f: s.author.write_pkcs12(f / "key", b"other"), "passphrase is wrong"),
    "wrong passphrase of PEM": (lambda s, f: s.author.write_key(f / "key", b"other"), "passphrase is wrong"),
    "text": (lambda _, f: write_text(f / "key", b"hello"), "neither PKCS#12 nor PEM"),
    "empty": (lambda _, f: write_text(f / "key", b""), "neither PKCS#12 nor PEM"),
    "missing": (lambda _, f: f / "key", "cannot be read"),
    "folder": (lambda _, f: f, "not a regular file"),
    "damaged PEM": (
        lambda _, f: write_text(f / "key", b"-----BEGIN PRIVATE KEY-----\nAAAA\n-----END PRIVATE KEY-----\n"),
        "the file holds no intact private key in PEM format",
    ),
    "PEM without certificate": (lambda s, f: s.author.write_key(f / "key", None), "holds no certificate"),
    "certificate alone": (lambda s, f: s.author.write_certificate(f / "key"), "no intact private key"),
    "certificate of another key": (
        lambda s, f: write_text(
            f / "key", s.author.write_key(f / "a", None).read_bytes() + s.root.write_certificate(f / "b").read_bytes()
        ),
        "the signing certificate belongs to another key",
    ),
    "expired": (lambda s, f: s.issue("Old", (-9, -1)).write_pkcs12(f / "key", b"secret"), "'Old' expired on "),
    "not valid yet": (lambda s, f: s.issue("Soon", (1, 9)).write_pkcs12(f / "key", b"secret"), "is not valid before"),
    "for encryption": (
        lambda s, f: s.issue("Box", usages=("key_encipherment",)).write_pkcs12(f / "key", b"secret"),
        "lacks the key usage 'digital signature' or 'non repudiation'",
    ),
    "of a server": (
        lambda s, f: s.issue("Host", purpose=server_purpose()).write_pkcs12(f / "key", b"secret"),
        r"is for other purposes \(server auth\)",
    ),
    "small RSA key": (small_rsa, "holds an RSA key of 1024 bits"),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_unusable_keys(signers: Signers, tmp_path: Path, fault: str) -> None:
    """One message with the file and the next step; nothing of the key is in it."""
    write, message = FAULTS[fault]
    path = write(signers, tmp_path)
    with pytest.raises(InputError, match=message) as caught:
        read_signing_key(path, None, lambda: b"secret")
    assert "\n  " in str(caught.value)
    assert "secret" not in str(caught.value)


def test_damage_never_ends_in_a_traceback(signers: Signers, tmp_path: Path) -> None:
    """Every byte of a PKCS#12 file changed in turn, in steps: refused by a message, or without effect."""
    content = signers.author.write_pkcs12(tmp_path / "key", None).read_bytes()
    refused = 0
    for place in range(0, len(content), 7):
        damaged = bytearray(content)
        damaged[place] ^= 0x55
        (tmp_path / "key").write_bytes(damaged)
        try:
            read_signing_key(tmp_path / "key", None, lambda: b"secret")
        except InputError:
            refused += 1
    assert refused > 20


def test_sources_of_the_passphrase(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The file counts before the environment, and the environment before the terminal."""
    monkeypatch.delenv(PASSPHRASE_VARIABLE, raising=False)
    monkeypatch.setattr(getpass, "getpass", lambda _: "typed ö")
    monkeypatch.setattr(sys.stdin, "isatty", lambda: True)
    assert read_passphrase(None) == "typed ö".encode()
    monkeypatch.setenv(PASSPHRASE_VARIABLE, "of the environment")
    assert read_passphrase(None) == b"of the environment"
    file = write_text(tmp_path / "passphrase", b" of the file \r\nsecond line\n")
    assert read_passphrase(file) == b" of the file "
    assert read_passphrase(write_text(file, b"")) == b""
    monkeypatch.delenv(PASSPHRASE_VARIABLE)
    monkeypatch.setattr(sys.stdin, "isatty", lambda: False)
    with pytest.raises(InputError, match="needs a passphrase, and none is given"):
        read_passphrase(None)


def test_passphrase_is_no_option() -> None:
    """Arguments are visible to other users of the machine."""
    text = pantocheck("sign", "--help", COLUMNS="200").output
    assert "--passphrase-file" in text
    assert "--passphrase " not in text


def test_failures_of_the_command(signers: Signers, tmp_path: Path) -> None:
    """Exit code 2 and one message; no file is written."""
    document = write_text(tmp_path / "results.json", b"{}")
    key = signers.author.write_pkcs12(tmp_path / "key.p12", b"secret")
    for arguments, message in [
        (("--key", tmp_path / "none"), "cannot be read"),
        (("--key", key, "--visible", "top-left"), "Only a PDF can show a signature"),
        (("--key", key, "--role", " "), "is not the name of a role"),
        (("--key", key, "--role", "x\x1b[31m"), "is not the name of a role"),
        (("--key", key, "--role", "x" * 61), "Give 1 to 60 printable characters"),
        (("--key", key, "--timestamp-url", "ftp://host/"), "is not the address of a server"),
        (("--key", key, "--timestamp-url", "file:///etc/passwd"), "is not the address of a server"),
        (("--key", key, "--timestamp-url", "http://127.0.0.1:1/"), "gave no time stamp"),
    ]:
        result = pantocheck("sign", document, *arguments, **{PASSPHRASE_VARIABLE: "secret"})
        assert (result.exit_code, result.stdout) == (2, "")
        assert message in result.stderr
    wrong = pantocheck("sign", document, "--key", key, **{PASSPHRASE_VARIABLE: "wrong phrase"})
    assert wrong.exit_code == 2
    assert "wrong phrase" not in wrong.output
    assert sorted(path.name for path in tmp_path.iterdir()) == ["key.p12", "results.json"]
