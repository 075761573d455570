"""The commit of the suite is only claimed when the suite runs from its own repository."""

import subprocess

import pytest

from pantocheck.conformance.results import suite_identity


@pytest.fixture
def repository(tmp_path, monkeypatch):
    """A repository with a folder `conformance` from which the suite seems to run."""
    (tmp_path / "conformance").mkdir()
    (tmp_path / "conformance" / "x.py").write_text("x = 1\n")
    git = ["git", "-C", str(tmp_path), "-c", "user.name=t", "-c", "user.email=t@example.org"]
    for command in (["init", "-q"], ["add", "."], ["commit", "-q", "-m", "x"]):
        subprocess.run([*git, *command], check=True)
    monkeypatch.setattr(suite_identity, "files", lambda name: tmp_path / "conformance")
    return tmp_path


def test_own_repository_gives_its_commit_and_says_if_files_were_changed(repository):
    head = subprocess.run(
        ["git", "-C", str(repository), "rev-parse", "HEAD"], capture_output=True, text=True, check=True
    )
    commit = suite_identity.find_suite_commit.__wrapped__()
    assert commit is not None
    assert head.stdout.startswith(commit)
    (repository / "conformance" / "x.py").write_text("x = 2\n")
    assert suite_identity.find_suite_commit.__wrapped__() == f"{commit}-dirty"


def test_foreign_repository_or_none_gives_no_commit(repository, monkeypatch, tmp_path_factory):
    inner = repository / "site-packages" / "conformance"
    inner.mkdir(parents=True)
    monkeypatch.setattr(suite_identity, "files", lambda name: inner)
    assert suite_identity.find_suite_commit.__wrapped__() is None
    monkeypatch.setattr(suite_identity, "files", lambda name: tmp_path_factory.mktemp("plain"))
    assert suite_identity.find_suite_commit.__wrapped__() is None
