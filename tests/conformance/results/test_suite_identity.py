"""Suite identity: a commit is stated only if the suite runs from its own repository."""

import subprocess
from pathlib import Path

import pytest

from pantocheck.conformance.results import suite_identity


@pytest.fixture
def repository(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A repository with a folder `conformance` from which the suite seems to run."""
    (tmp_path / "conformance").mkdir()
    (tmp_path / "conformance" / "x.py").write_text("x = 1\n")
    git = ["git", "-C", str(tmp_path), "-c", "user.name=t", "-c", "user.email=t@example.org"]
    for command in (["init", "-q"], ["add", "."], ["commit", "-q", "-m", "x"]):
        subprocess.run([*git, *command], check=True)
    monkeypatch.setattr(suite_identity, "files", lambda name: tmp_path / "conformance")
    return tmp_path


def test_commit_of_the_repository_marks_changed_files(repository: Path) -> None:
    head = subprocess.run(
        ["git", "-C", str(repository), "rev-parse", "HEAD"], capture_output=True, text=True, check=True
    )
    commit = suite_identity.find_suite_commit.__wrapped__()
    assert commit is not None
    assert head.stdout.startswith(commit)
    (repository / "conformance" / "x.py").write_text("x = 2\n")
    assert suite_identity.find_suite_commit.__wrapped__() == f"{commit}-dirty"


def test_other_repository_or_none_has_no_commit(
    repository: Path, monkeypatch: pytest.MonkeyPatch, tmp_path_factory: pytest.TempPathFactory
) -> None:
    inner = repository / "site-packages" / "conformance"
    inner.mkdir(parents=True)
    monkeypatch.setattr(suite_identity, "files", lambda name: inner)
    assert suite_identity.find_suite_commit.__wrapped__() is None
    monkeypatch.setattr(suite_identity, "files", lambda name: tmp_path_factory.mktemp("plain"))
    assert suite_identity.find_suite_commit.__wrapped__() is None
