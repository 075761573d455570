"""Contents and metadata of the wheel and the source distribution, compared with this checkout.

python -m verification.packaging.distribution FOLDER      # folder with one wheel and one sdist

Prints every difference; the exit code is 1 if there is one. `.ci/thorough wheel` builds both and calls this check.
"""

import argparse
import sys
import tarfile
import tomllib
import zipfile
from collections.abc import Iterator
from email import message_from_string
from email.message import Message
from pathlib import Path

CHECKOUT = Path(__file__).resolve().parents[2]
PROJECT = tomllib.loads((CHECKOUT / "pyproject.toml").read_text(encoding="utf-8"))["project"]

CODE = (".py", "py.typed")
PACKAGES = {
    "model": (*CODE, ".c", ".h"),
    "conformance": CODE,
    "reference_cases": (*CODE, ".toml", ".json"),
    "templates": ("",),
}
"""Folders of the checkout that are installed below `pantocheck/`, with the ends of the names of their files."""

LIBRARY = "pantocheck/model/dynamics/time_step"
"""Library of the core in C, without its ending."""

LEFT_OUT = ("tests/", "verification/", "docs/", "examples/", ".ci/", ".github/")
"""Folders that neither distribution contains."""


def main() -> None:
    """Check both distributions of a folder."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    folder = parser.parse_args().folder
    (wheel,), (sdist,) = folder.glob("*.whl"), folder.glob("*.tar.gz")
    problems = [f"{wheel.name}: {text}" for text in check_wheel(wheel)]
    problems += [f"{sdist.name}: {text}" for text in check_sdist(sdist)]
    print("\n".join(problems) or f"{wheel.name} and {sdist.name}: complete")
    sys.exit(1 if problems else 0)


def list_installed() -> set[str]:
    """Files of the checkout that belong to the installation, as paths of the checkout."""
    return {
        path.relative_to(CHECKOUT).as_posix()
        for folder, ends in PACKAGES.items()
        for path in (CHECKOUT / folder).rglob("*")
        if path.is_file() and path.name.endswith(ends) and "__pycache__" not in path.parts
    }


def check_wheel(path: Path) -> Iterator[str]:
    """Problems of a wheel: files, licences, metadata, commands."""
    with zipfile.ZipFile(path) as archive:
        names = {name for name in archive.namelist() if not name.endswith("/")}
        (metadata,) = (name for name in names if name.endswith(".dist-info/METADATA"))
        info = metadata.removesuffix("METADATA")
        libraries = {name for name in names if name.startswith(LIBRARY) and name.endswith((".so", ".pyd"))}
        yield from _compare({f"pantocheck/{name}" for name in list_installed()}, names - libraries, info)
        if len(libraries) != 1:
            yield f"one library of the core in C is expected: {sorted(libraries) or 'none'}"
        licences = {f"{info}licenses/{name}" for name in PROJECT["license-files"]}
        yield from (f"licence missing: {name}" for name in sorted(licences - names))
        yield from check_metadata(message_from_string(archive.read(metadata).decode("utf-8")))
        commands = archive.read(f"{info}entry_points.txt").decode("utf-8")
        yield from (f"command missing: {name}" for name in PROJECT["scripts"] if f"{name} = " not in commands)


def _compare(expected: set[str], names: set[str], info: str) -> Iterator[str]:
    yield from (f"missing: {name}" for name in sorted(expected - names))
    for name in sorted(names - expected):
        if not name.startswith(info) and name not in ("pantocheck/__main__.py", "pytest_pantocheck.py"):
            yield f"does not belong here: {name}"


def check_metadata(metadata: Message) -> Iterator[str]:
    """Fields that a package index shows or checks, and the requirements of every extra."""
    expected = {
        "Name": PROJECT["name"],
        "Version": PROJECT["version"],
        "Summary": PROJECT["description"],
        "Requires-Python": PROJECT["requires-python"],
        "License-Expression": PROJECT["license"],
        "Description-Content-Type": "text/markdown",
    }
    for field, value in expected.items():
        if metadata[field] != value:
            yield f"metadata {field}: {metadata[field]!r} in place of {value!r}"
    extras = set(metadata.get_all("Provides-Extra") or ())
    if extras != set(PROJECT["optional-dependencies"]):
        yield f"metadata Provides-Extra: {sorted(extras)}"
    if (CHECKOUT / PROJECT["readme"]).read_text(encoding="utf-8").strip() != str(metadata.get_payload()).strip():
        yield "metadata: the description is not the README"


def check_sdist(path: Path) -> Iterator[str]:
    """Problems of a source distribution: it must hold all that a wheel needs, and no tests."""
    with tarfile.open(path) as archive:
        names = {name.partition("/")[2] for name in archive.getnames()}
    needed = list_installed() | {"pyproject.toml", "setup.py", PROJECT["readme"], *PROJECT["license-files"]}
    yield from (f"missing: {name}" for name in sorted(needed - names))
    yield from (f"does not belong here: {name}" for name in sorted(names) if name.startswith(LEFT_OUT))


if __name__ == "__main__":
    main()
