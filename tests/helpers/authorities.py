"""Certificate authorities, signers and a time-stamp server of a test, made by the package cryptography."""

import threading
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from http.server import BaseHTTPRequestHandler, HTTPServer
from pathlib import Path
from typing import Any

from cryptography import x509
from cryptography.hazmat.primitives import hashes
from cryptography.hazmat.primitives.asymmetric import ec
from cryptography.hazmat.primitives.serialization import (
    BestAvailableEncryption,
    Encoding,
    NoEncryption,
    PrivateFormat,
    pkcs12,
)
from cryptography.x509.oid import NameOID

PASSPHRASE = b"open sesame"
DAY = timedelta(days=1)


@dataclass(frozen=True)
class Holder:
    """Private key with its certificate, and the certificate of the authority above it."""

    key: Any
    certificate: x509.Certificate
    authority: x509.Certificate | None = None

    def write_pkcs12(self, path: Path, passphrase: bytes | None = PASSPHRASE) -> Path:
        encryption = NoEncryption() if passphrase is None else BestAvailableEncryption(passphrase)
        chain = None if self.authority is None else [self.authority]
        path.write_bytes(pkcs12.serialize_key_and_certificates(b"key", self.key, self.certificate, chain, encryption))
        return path

    def write_certificate(self, path: Path) -> Path:
        path.write_bytes(self.certificate.public_bytes(Encoding.PEM))
        return path

    def write_key(self, path: Path, passphrase: bytes | None = PASSPHRASE) -> Path:
        encryption = NoEncryption() if passphrase is None else BestAvailableEncryption(passphrase)
        path.write_bytes(self.key.private_bytes(Encoding.PEM, PrivateFormat.PKCS8, encryption))
        return path


@dataclass(frozen=True)
class Request:
    """Content of a certificate to be issued."""

    name: str
    valid_from: datetime
    valid_to: datetime
    authority: bool = False
    usages: tuple[str, ...] = ("digital_signature",)
    purpose: x509.ObjectIdentifier | None = None
    path_length: int | None = None


def request(name: str, days: tuple[float, float] = (-1, 365), **content: Any) -> Request:
    """Request for a certificate that is valid between two numbers of days from now."""
    now = datetime.now(UTC)
    return Request(name, now + days[0] * DAY, now + days[1] * DAY, **content)


USAGES = (
    "digital_signature", "content_commitment", "key_encipherment", "data_encipherment", "key_agreement",
    "key_cert_sign", "crl_sign", "encipher_only", "decipher_only",
)  # fmt: skip


def issue(wanted: Request, issuer: Holder | None = None, key: Any = None) -> Holder:
    """Certificate for a request, signed by its issuer, or by itself without one."""
    key = ec.generate_private_key(ec.SECP256R1()) if key is None else key
    subject = x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, wanted.name)])
    signer = Holder(key, None) if issuer is None else issuer  # type: ignore[arg-type]
    builder = (
        x509.CertificateBuilder()
        .subject_name(subject)
        .issuer_name(subject if issuer is None else issuer.certificate.subject)
        .public_key(key.public_key())
        .serial_number(x509.random_serial_number())
        .not_valid_before(wanted.valid_from)
        .not_valid_after(wanted.valid_to)
        .add_extension(x509.BasicConstraints(wanted.authority, wanted.path_length), critical=True)
        .add_extension(x509.SubjectKeyIdentifier.from_public_key(key.public_key()), critical=False)
        .add_extension(x509.KeyUsage(**{name: name in wanted.usages for name in USAGES}), critical=True)
        .add_extension(x509.AuthorityKeyIdentifier.from_issuer_public_key(signer.key.public_key()), critical=False)
    )
    if wanted.purpose is not None:
        builder = builder.add_extension(x509.ExtendedKeyUsage([wanted.purpose]), critical=True)
    certificate = builder.sign(signer.key, hashes.SHA256())
    return Holder(key, certificate, None if issuer is None else issuer.certificate)


def list_revoked(issuer: Holder, revoked: Iterable[Holder] = (), days: tuple[float, float] = (-1, 30)) -> bytes:
    """List of certificates that their issuer revoked 6 hours ago (PEM), valid between two numbers of days from now."""
    now = datetime.now(UTC)
    builder = (
        x509.CertificateRevocationListBuilder()
        .issuer_name(issuer.certificate.subject)
        .last_update(now + days[0] * DAY)
        .next_update(now + days[1] * DAY)
        .add_extension(x509.AuthorityKeyIdentifier.from_issuer_public_key(issuer.key.public_key()), critical=False)
        .add_extension(x509.CRLNumber(1), critical=False)
    )
    for holder in revoked:
        entry = x509.RevokedCertificateBuilder().serial_number(holder.certificate.serial_number)
        builder = builder.add_revoked_certificate(entry.revocation_date(now - DAY / 4).build())
    return builder.sign(issuer.key, hashes.SHA256()).public_bytes(Encoding.PEM)


@contextmanager
def serve_time_stamps(holder: Holder, moment: datetime | None = None) -> Iterator[str]:
    """Time-stamp server in this process; the block receives its address."""
    from asn1crypto import keys, tsp
    from asn1crypto import x509 as asn1_x509
    from pyhanko.sign.timestamps.dummy_client import DummyTimeStamper

    private = holder.key.private_bytes(Encoding.DER, PrivateFormat.PKCS8, NoEncryption())
    stamper = DummyTimeStamper(
        asn1_x509.Certificate.load(holder.certificate.public_bytes(Encoding.DER)),
        keys.PrivateKeyInfo.load(private),
        fixed_dt=moment,
    )

    class Handler(BaseHTTPRequestHandler):
        def do_POST(self) -> None:
            asked = tsp.TimeStampReq.load(self.rfile.read(int(self.headers["Content-Length"])))
            self.send_response(200)
            self.end_headers()
            self.wfile.write(stamper.request_tsa_response(asked).dump())

        def log_message(self, *_: Any) -> None:
            pass

    server = HTTPServer(("127.0.0.1", 0), Handler)
    thread = threading.Thread(target=server.serve_forever, daemon=True)
    thread.start()
    try:
        yield f"http://127.0.0.1:{server.server_port}/"
    finally:
        server.shutdown()
        server.server_close()
        thread.join()
