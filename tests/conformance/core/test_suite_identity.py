"""Suite identity: digest of its files; a commit is stated only if the suite runs from its own repository."""

import shutil
import subprocess
from importlib.resources import files
from pathlib import Path

import pytest

from pantocheck.conformance.core import suite_identity


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


def test_digest_of_the_suite_is_that_of_its_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A copy of the files, as a plain installation makes, has the same digest; caches and other files do not count."""
    installed = suite_identity.suite_digest()  # it is kept, so that it must be computed before the folders change
    packages = {name: Path(str(files(name))) for name in suite_identity.PACKAGES}
    for name, folder in packages.items():
        shutil.copytree(folder, tmp_path / name, ignore=shutil.ignore_patterns("__pycache__", "py.typed", "schema"))
    monkeypatch.setattr(suite_identity, "files", lambda name: tmp_path / name)
    digest = suite_identity.suite_digest.__wrapped__()
    assert digest == installed
    (tmp_path / "pantocheck.model" / "__pycache__").mkdir()
    (tmp_path / "pantocheck.model" / "__pycache__" / "beam.cpython-311.pyc").write_bytes(b"cache")
    assert suite_identity.suite_digest.__wrapped__() == digest
    folder = Path(str(files("pantocheck.templates")))
    suffixes = {path.suffix for path in folder.iterdir() if path.is_file() and path.name != "py.typed"}
    assert suffixes <= suite_identity.SOURCE_SUFFIXES


@pytest.mark.parametrize(
    "name",
    [
        "pantocheck.model/pantograph.py",
        "pantocheck.conformance/grading/verdicts.py",
        "pantocheck.reference_cases/en50318-2002/250.toml",
        "pantocheck.templates/elements.typ",
    ],
)
def test_change_of_a_file_of_the_suite_changes_its_digest(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    installed = suite_identity.suite_digest()
    for package in suite_identity.PACKAGES:
        shutil.copytree(Path(str(files(package))), tmp_path / package)
    with (tmp_path / name).open("ab") as file:
        file.write(b" ")
    monkeypatch.setattr(suite_identity, "files", lambda name: tmp_path / name)
    assert suite_identity.suite_digest.__wrapped__() != installed
