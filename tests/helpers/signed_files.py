"""Signing in tests: a short form of the function of the suite."""

from pathlib import Path
from typing import Any

from pantocheck.conformance.documents.signing import SigningOptions, sign_document


def sign(document: Path, holder: Any, **options: Any) -> Path:
    """Sign a document with the key of a holder; returns the file of the signature."""
    key = holder.write_pkcs12(document.parent / "key.p12", b"secret")
    return sign_document(document, key, None, lambda: b"secret", SigningOptions(**options)).path
