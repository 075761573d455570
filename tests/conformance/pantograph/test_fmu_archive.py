"""Archives of FMUs are a stranger's: nothing is written outside of the folder, and nothing but a message comes out."""

import stat
import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from helpers.fmu_fixtures import damage
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.pantograph.fmu_archive import FREE_CONTENT, unpack_fmu

Write = Callable[[zipfile.ZipFile], object]


def archive(path: Path, *writes: Write) -> Path:
    """Archive with a model description, a library of random bytes, and further entries."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as file:
        file.writestr("modelDescription.xml", "<fmiModelDescription/>")
        file.writestr("binaries/linux64/model.so", np.random.default_rng(7).bytes(3000))
        for write in writes:
            write(file)
    return path


def unpack(path: Path, folder: Path, digest: str | None = None) -> list[str]:
    """Unpacked files; the folder stands in an empty one, in which nothing else may appear."""
    place = folder / "place"
    place.mkdir(parents=True)
    try:
        unpack_fmu(path, place, digest)
    finally:
        assert [other.name for other in folder.iterdir()] == ["place"]
    return sorted(str(file.relative_to(place)) for file in place.rglob("*") if file.is_file())


def link(file: zipfile.ZipFile) -> None:
    entry = zipfile.ZipInfo("resources/link")
    entry.external_attr = (stat.S_IFLNK | 0o777) << 16
    file.writestr(entry, "/etc/passwd")


def encrypted(file: zipfile.ZipFile) -> None:
    file.writestr("resources/secret", "x")
    file.filelist[-1].flag_bits |= 1


def named(name: str) -> Write:
    return lambda file: file.writestr(name, "x")


def twice(file: zipfile.ZipFile) -> None:
    file.writestr("Resources/a", "x")
    file.writestr("resources/A", "y")


def test_an_archive_is_unpacked_as_it_is(tmp_path: Path) -> None:
    found = unpack(archive(tmp_path / "model.fmu", named("resources/table.csv")), tmp_path / "out")
    assert found == ["binaries/linux64/model.so", "modelDescription.xml", "resources/table.csv"]


@pytest.mark.parametrize(
    ("write", "reason"),
    [
        (named("../outside"), "outside of its folder"),
        (named("/tmp/outside"), "outside of its folder"),
        (named("resources/../../outside"), "outside of its folder"),
        (named("resources\\..\\outside"), "outside of its folder"),
        (named("C:outside"), "outside of its folder"),
        (link, "a link or a device"),
        (encrypted, "encrypted"),
        (twice, "two entries of the same name"),
        (named("binaries/linux64/model.so/inside"), "damaged"),
        (lambda file: file.writestr("resources/bomb", bytes(FREE_CONTENT + 1)), "bytes in an archive of"),
        (lambda file: [file.writestr(f"resources/{n}", "") for n in range(20_000)], "20002 entries"),
    ],
)
def test_a_bad_archive_is_refused_before_anything_leaves_its_folder(tmp_path: Path, write: Write, reason: str) -> None:
    with pytest.raises(InputError, match=reason):
        unpack(archive(tmp_path / "model.fmu", write), tmp_path / "out")


def test_another_archive_than_the_named_one_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="has the SHA-256"):
        unpack(archive(tmp_path / "model.fmu"), tmp_path / "out", "0" * 64)


def unpack_damaged(folder: Path, seeds: range) -> int:
    """Number of damaged archives that are refused; the others are read as far as their library."""
    whole, refused = archive(folder / "model.fmu", named("resources/table.csv")).read_bytes(), 0
    for seed in seeds:
        path = folder / f"{seed}.fmu"
        path.write_bytes(damage(whole, seed))
        try:
            unpack(path, folder / f"out{seed}")
        except InputError:
            refused += 1
    return refused


def test_damaged_archives_give_a_message(tmp_path: Path) -> None:
    """Of 24 damaged archives, all but changed dates and the like are refused."""
    assert unpack_damaged(tmp_path, range(24)) >= 18


@pytest.mark.thorough
def test_200_damaged_archives_give_a_message(tmp_path: Path) -> None:
    assert unpack_damaged(tmp_path, range(24, 224)) >= 150
