"""Trust in a signer: chain, expiry, key usage and time stamps, for a detached signature (the same code checks PDF)."""

from dataclasses import replace
from datetime import UTC, datetime, timedelta
from pathlib import Path
from types import SimpleNamespace

import pytest

from helpers.signed_files import sign
from helpers.signer_fixtures import Signers
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.documents import key_files
from pantocheck.conformance.documents.authenticity_check import DocumentCheck
from pantocheck.conformance.documents.cms_check import NO_SIGNATURE, REVOCATION, SignatureReport, describe_signatures
from pantocheck.conformance.documents.signature_check import check_signatures
from pantocheck.conformance.documents.verification import check_origin


@pytest.fixture
def document(tmp_path: Path) -> Path:
    path = tmp_path / "results.json"
    path.write_text("{}")
    return path


@pytest.fixture
def any_key(monkeypatch: pytest.MonkeyPatch) -> None:
    """Sign with keys that `sign` refuses, as other programs do."""
    monkeypatch.setattr(key_files, "_check_usable", lambda *_: None)


def test_document_without_a_signature_is_described_by_what_was_checked() -> None:
    """Trust roots that nothing was compared with are named, unless a note says why."""
    unsigned = "unsigned: nothing shows who made this document."
    for roots, note, lines in (
        (False, "", [unsigned]), (True, "", [unsigned, NO_SIGNATURE]), (True, "no pyhanko", ["no pyhanko"])
    ):  # fmt: skip
        assert describe_signatures(SignatureReport((), (), roots, note)) == lines


def test_chain_to_a_given_root_is_authentic(signers: Signers, document: Path, roots_file: Path) -> None:
    sign(document, signers.author, role="author")
    report = check_signatures(document, roots_file)
    assert report.authentic
    (facts,) = report.signatures
    found = (facts.signer, facts.issuer, facts.role, facts.root)
    assert found == ("Ada Author", "Test authority", "author", "Test root")
    assert facts.stated_time is not None
    assert abs(facts.stated_time - datetime.now(UTC)) < timedelta(minutes=5)
    document.with_name("results.json.p7s").unlink()
    sign(document, replace(signers.author, authority=None))
    (facts,) = check_signatures(document, roots_file).signatures
    assert facts.distrust == "its chain does not lead to a given trust root"


def test_signer_without_a_given_root_is_named_but_not_trusted(signers: Signers, document: Path, tmp_path: Path) -> None:
    from helpers.authorities import issue, request

    sign(document, signers.author)
    report = check_signatures(document, None)
    assert not report.authentic
    assert report.contradictions == ()  # the content is unchanged; trust was not asked for
    assert "signed by Ada Author as author (not trusted: no trust root given)" in describe_signatures(report)[0]
    other = issue(request("Test root", authority=True, usages=("key_cert_sign",)))  # the same name, another key
    report = check_signatures(document, other.write_certificate(tmp_path / "other.pem"))
    assert (report.contradictions, report.authentic) == ((), False)
    assert "(not trusted: its chain does not lead to a given trust root)" in describe_signatures(report)[0]
    proved = DocumentCheck("proved", "The signature holds: it covers the whole file, and nothing was changed since.")
    assert check_origin(report)[0] == proved
    assert [check.outcome for check in check_origin(report)] == ["proved", "open"]


def test_first_certificate_of_a_key_signs_and_a_long_name_is_shortened() -> None:
    own = [SimpleNamespace(public_key=SimpleNamespace(dump=lambda: b"key")) for _ in range(2)]
    key = SimpleNamespace(public_key=lambda: SimpleNamespace(public_bytes=lambda *_: b"key"))
    assert key_files._select_certificate(key, own, "key.pem").certificate is own[0]
    for length, shown in ((120, "x" * 120), (121, "x" * 119 + "…")):
        assert key_files.read_name(SimpleNamespace(native={"common_name": "x" * length})) == shown


@pytest.mark.usefixtures("any_key")
@pytest.mark.parametrize(
    ("days", "content", "reason"),
    [
        ((-9, -1), {}, "the signing certificate expired on "),
        ((1, 9), {}, "the signing certificate is not valid before "),
        ((-1, 9), {"usages": ("key_encipherment",)}, "the signing certificate lacks the key usage 'digital signature'"),
    ],
)
def test_unusable_certificate(
    signers: Signers, document: Path, roots_file: Path, days: tuple[int, int], content: dict[str, object], reason: str
) -> None:
    sign(document, signers.issue("Late Signer", days, **content))
    report = check_signatures(document, roots_file)
    assert not report.authentic
    assert report.signatures[0].distrust.startswith(reason)


@pytest.mark.usefixtures("any_key")
def test_certificate_of_a_server_or_of_an_expired_authority(signers: Signers, document: Path, roots_file: Path) -> None:
    """The authority of a company certifies servers as well; none of them signs reports."""
    from cryptography.x509.oid import ExtendedKeyUsageOID

    from helpers.authorities import issue, request

    sign(document, signers.issue("www.example.org", purpose=ExtendedKeyUsageOID.SERVER_AUTH))
    (facts,) = check_signatures(document, roots_file).signatures
    assert facts.distrust == "the signing certificate is for other purposes (server auth)"
    document.with_name("results.json.p7s").unlink()
    authority = signers.issue("Old authority", (-9, -1), authority=True, usages=("key_cert_sign",))
    sign(document, issue(request("Ada Author"), authority))
    (facts,) = check_signatures(document, roots_file).signatures
    assert facts.distrust.startswith("the certificate of the authority Old authority expired on ")


@pytest.mark.usefixtures("any_key")
def test_self_signed_certificate_as_trust_root_expires(document: Path, tmp_path: Path, signers: Signers) -> None:
    """A trust root is trusted without its own chain, but its validity still counts for its own signature."""
    from helpers.authorities import issue, request

    for name, days in (("Now", (-1, 9)), ("Old", (-9, -1))):
        holder = issue(request(name, days))
        sign(document, holder, out=tmp_path / f"{name}.p7s")
        (tmp_path / "results.json.p7s").write_bytes((tmp_path / f"{name}.p7s").read_bytes())
        report = check_signatures(document, holder.write_certificate(tmp_path / "own.pem"))
        assert report.authentic == (name == "Now")


def test_time_stamp_of_a_trusted_authority_decides_the_moment(
    signers: Signers, document: Path, roots_file: Path, any_key: None
) -> None:
    """A certificate that expired since is trusted, because the time stamp shows that it was valid when it signed."""
    from helpers.authorities import serve_time_stamps

    moment = datetime.now(UTC).replace(microsecond=0) - timedelta(hours=12)
    holder = signers.issue("Former Signer", (-9, -0.25))  # expired 6 hours ago, 6 hours after the time stamp
    with serve_time_stamps(signers.clock, moment) as url:
        sign(document, holder, timestamp_url=url)
    report = check_signatures(document, roots_file)
    assert report.authentic
    (facts,) = report.signatures
    assert facts.stamped_time == facts.checked_at == moment
    assert "validity was checked at this time" in describe_signatures(report)[1]


def test_time_stamp_of_an_unknown_authority_does_not_count(
    signers: Signers, document: Path, roots_file: Path, any_key: None
) -> None:
    from cryptography.hazmat.primitives.asymmetric import rsa
    from cryptography.x509.oid import ExtendedKeyUsageOID

    from helpers.authorities import issue, request, serve_time_stamps

    key = rsa.generate_private_key(public_exponent=65537, key_size=2048)
    clock = issue(request("Own clock", purpose=ExtendedKeyUsageOID.TIME_STAMPING), None, key)
    moment = datetime.now(UTC) - timedelta(hours=12)
    with serve_time_stamps(clock, moment) as url:
        sign(document, signers.issue("Former Signer", (-9, -0.25)), timestamp_url=url)
    (facts,) = check_signatures(document, roots_file).signatures
    assert facts.stamped_time is None
    assert facts.stamp_problem == "its authority Own clock is not trusted (no valid chain to a trust root)"
    assert facts.distrust.startswith("the signing certificate expired on ")
    assert facts.distrust.endswith("(no trusted time stamp)")


def test_time_stamp_of_another_signature_does_not_count(
    signers: Signers, document: Path, roots_file: Path, tmp_path: Path
) -> None:
    """A time stamp moved from one signature to another belongs to other content."""
    from asn1crypto import cms

    from helpers.authorities import serve_time_stamps

    with serve_time_stamps(signers.clock) as url:
        stamped = sign(document, signers.author, timestamp_url=url)
    donor = cms.ContentInfo.load(stamped.read_bytes())["content"]["signer_infos"][0]["unsigned_attrs"]
    plain = cms.ContentInfo.load(sign(document, signers.author, out=tmp_path / "plain.p7s").read_bytes())
    plain["content"]["signer_infos"][0]["unsigned_attrs"] = donor
    stamped.write_bytes(plain.dump(force=True))
    (facts,) = check_signatures(document, roots_file).signatures
    assert (facts.stamped_time, facts.stamp_problem) == (None, "it belongs to other content")


def test_signer_without_the_purpose_of_time_stamps(signers: Signers, document: Path, roots_file: Path) -> None:
    from cryptography.hazmat.primitives.asymmetric import rsa

    from helpers.authorities import issue, request, serve_time_stamps

    key = rsa.generate_private_key(public_exponent=65537, key_size=2048)
    with serve_time_stamps(issue(request("No clock"), signers.root, key)) as url:
        sign(document, signers.author, timestamp_url=url)
    (facts,) = check_signatures(document, roots_file).signatures
    assert facts.stamped_time is None
    assert facts.stamp_problem.startswith("its authority No clock is not trusted")


def test_lists_of_revoked_certificates(signers: Signers, document: Path, roots_file: Path) -> None:
    """A list among the trust roots is checked; then every certificate of a chain needs a valid one."""
    from helpers.authorities import issue, list_revoked, request, serve_time_stamps

    root, certificate = signers.root, roots_file.read_bytes()
    middle = signers.issue("Middle authority", authority=True, usages=("key_cert_sign", "crl_sign"))
    unlisted = "no valid list of revoked certificates is given for a certificate of its chain"
    for holder, lists, reason in (
        (signers.assessor, [list_revoked(root)], ""),
        (signers.assessor, [list_revoked(root, [signers.author])], ""),  # another certificate
        (signers.assessor, [list_revoked(root, [signers.assessor])], "the signing certificate was revoked on "),
        (signers.assessor, [list_revoked(root, days=(-9, -1))], unlisted),
        (signers.assessor, [list_revoked(middle, [signers.assessor])], unlisted),
        (issue(request("Ada Author"), middle), [list_revoked(root)], unlisted),
        (issue(request("Ada Author"), middle), [list_revoked(root), list_revoked(middle)], ""),
        (
            issue(request("Ada Author"), middle),
            [list_revoked(root, [middle])],
            "the certificate of an authority was revoked",
        ),
        (issue(request("Mallory")), [list_revoked(root)], "its chain does not lead to a given trust root"),
    ):
        document.with_name("results.json.p7s").unlink(missing_ok=True)
        sign(document, holder)
        roots_file.write_bytes(certificate + b"".join(lists))
        report = check_signatures(document, roots_file)
        assert report.signatures[0].distrust.startswith(reason)
        assert report.authentic == (reason == "")
        assert describe_signatures(report)[-1] == REVOCATION
    document.with_name("results.json.p7s").unlink()
    with serve_time_stamps(signers.clock, datetime.now(UTC) - timedelta(hours=12)) as url:
        sign(document, signers.assessor, timestamp_url=url)  # revoked 6 hours after the time stamp
    roots_file.write_bytes(certificate + list_revoked(root, [signers.assessor]))
    assert check_signatures(document, roots_file).authentic
    roots_file.write_bytes(certificate + b"-----BEGIN X509 CRL-----\nAAAA\n-----END X509 CRL-----\n")
    with pytest.raises(InputError, match="holds a damaged revocation list"):
        check_signatures(document, roots_file)
