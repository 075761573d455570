"""Fixtures for tests of signatures: signers below a root authority. Tests with them are skipped without pyHanko."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest


@dataclass(frozen=True)
class Signers:
    """Holders of certificates below one root: author (below an intermediate authority), assessor, and time stamps."""

    root: Any
    author: Any
    assessor: Any
    clock: Any
    issue: Callable[..., Any]
    """Issue a further certificate below the root: name, days from now, further content of the request."""


@pytest.fixture(scope="session")
def signers() -> Signers:
    """Author, assessor and authority of time stamps below one root."""
    pytest.importorskip("pyhanko", reason="extra sign")
    from cryptography.hazmat.primitives.asymmetric import rsa
    from cryptography.x509.oid import ExtendedKeyUsageOID

    from helpers.authorities import issue, request

    certifying: dict[str, Any] = {"authority": True, "usages": ("key_cert_sign", "crl_sign")}
    root = issue(request("Test root", (-9, 3650), **certifying))
    intermediate = issue(request("Test authority", (-9, 3000), **certifying), root)
    clock = request("Test clock", purpose=ExtendedKeyUsageOID.TIME_STAMPING)
    # The server of pyHanko for tests signs with RSA.
    clock_key = rsa.generate_private_key(public_exponent=65537, key_size=2048)
    return Signers(
        root,
        issue(request("Ada Author"), intermediate),
        issue(request("Ben Assessor"), root),
        issue(clock, root, clock_key),
        lambda name, days=(-1, 365), **content: issue(request(name, days, **content), root),
    )


@pytest.fixture
def roots_file(signers: Signers, tmp_path: Path) -> Path:
    """File of trust roots with the root of the signers."""
    return Path(signers.root.write_certificate(tmp_path / "roots.pem"))
