"""Packages of cases in installed distributions, found by entry points; no code of a distribution is run."""

from dataclasses import dataclass
from importlib.metadata import EntryPoint, entry_points
from typing import Final

GROUP: Final = "pantocheck.cases"
"""Group of the entry points."""

LONGEST_TEXT = 100
"""Largest number of characters of a name or version that is shown; metadata are written by strangers."""


@dataclass(frozen=True, order=True)
class CasePackage:
    """Package of cases, as an entry point of an installed distribution names it."""

    name: str
    """Name of the entry point, which is free."""
    distribution: str
    version: str
    value: str
    """Name of the package that holds the case files."""

    @property
    def text(self) -> str:
        """Name in messages, such as `cases 'lines' of acme-lines 1.0`."""
        return f"cases '{self.name}' of {self.distribution} {self.version}"


def list_case_packages() -> list[CasePackage]:
    """Packages of cases of all installed distributions, by name."""
    return sorted(
        CasePackage(entry.name[:LONGEST_TEXT], *_identify_distribution(entry), entry.value)
        for entry in entry_points(group=GROUP)
    )


def _identify_distribution(entry: EntryPoint) -> tuple[str, str]:
    """Name and version of the distribution of an entry point; broken metadata may lack them."""
    stated = {} if entry.dist is None else entry.dist.metadata.json
    name, version = (" ".join(str(stated.get(key) or "unknown").split()) for key in ("name", "version"))
    return name[:LONGEST_TEXT], version[:LONGEST_TEXT]
