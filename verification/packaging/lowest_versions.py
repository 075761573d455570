"""Constraints for pip: the lowest declared version of every dependency.

python -m verification.packaging.lowest_versions [EXTRA ...] > constraints.txt
pip install -c constraints.txt ".[EXTRA,...]"
"""

import re
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path

PROJECT = Path(__file__).resolve().parents[2] / "pyproject.toml"


def pin_lowest(requirement: str) -> str:
    """Requirement with its lower bound as the exact version; other bounds are dropped."""
    match = re.fullmatch(r"\s*([A-Za-z0-9._-]+)(?:\[[^]]*\])?\s*>=\s*([A-Za-z0-9.]+)\s*(?:,.*)?", requirement)
    if match is None:
        raise ValueError(f"{requirement!r} has no lower bound")
    name, version = match.groups()
    return f"{name}=={version}"


def build_constraints(extras: list[str]) -> list[str]:
    """Lines of a constraints file for the dependencies and the chosen extras, with those that they contain."""
    project = tomllib.loads(PROJECT.read_text(encoding="utf-8"))["project"]
    requirements = [*project["dependencies"]]
    for extra in extras:
        requirements += _list_requirements(extra, project["optional-dependencies"])
    return list(dict.fromkeys(pin_lowest(requirement) for requirement in requirements))


def _list_requirements(extra: str, optional: dict[str, list[str]]) -> Iterator[str]:
    """Requirements of an extra; one on the project itself names other extras."""
    for requirement in optional[extra]:
        if match := re.fullmatch(r"pantocheck\[(.*)\]", requirement):
            for other in match[1].split(","):
                yield from _list_requirements(other, optional)
        else:
            yield requirement


if __name__ == "__main__":
    print("\n".join(build_constraints(sys.argv[1:])))
