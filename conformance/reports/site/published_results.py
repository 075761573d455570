"""Results on a site: the content of results.json, its contradictions and the place of its certificate."""

import re
from collections.abc import Iterable
from dataclasses import dataclass

from pantocheck.conformance.results.results_format import Results

LONGEST_FILE_NAME = 60
"""Longest part of a file name that comes from a name in the results."""


@dataclass(frozen=True)
class PublishedResults:
    """Results of one run on a site."""

    results: Results
    """Results of a run."""
    discrepancies: tuple[str, ...]
    """Contradictions between its numbers and verdicts; none if it is consistent."""
    folder: str
    """Folder of the certificate in the site."""

    @property
    def system(self) -> str:
        """Name of the system."""
        return self.results.system.name

    @property
    def version(self) -> str:
        """Version of the system."""
        return self.results.system.version

    @property
    def date(self) -> str:
        """Date and time of the run; empty if the results state none."""
        return self.results.started or ""

    def verdict(self, stated: str) -> str:
        """Verdict as shown: `error` for results that contradict themselves."""
        return "error" if self.discrepancies else stated


def publish_results(contents: Iterable[tuple[Results, tuple[str, ...]]]) -> list[PublishedResults]:
    """Order results by date and name their folders.

    Args:
        contents: Content of each results.json with its contradictions.

    Returns:
        Results from the oldest to the latest; equal dates keep their order.
    """
    ordered = sorted(contents, key=lambda content: content[0].started or "")
    return [
        PublishedResults(results, discrepancies, f"runs/{number:04d}-{name_file(results.system.name)}")
        for number, (results, discrepancies) in enumerate(ordered, 1)
    ]


def name_file(text: str) -> str:
    """Part of a file name from any text: small letters, digits and hyphens."""
    return re.sub(r"[^a-z0-9]+", "-", text.lower()).strip("-")[:LONGEST_FILE_NAME] or "unnamed"
