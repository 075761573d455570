"""Verification of a certificate: its embedded results are extracted and graded again."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pantocheck.conformance.authenticity.attachment import (
    open_document,
    read_embedded_results,
    read_title_and_first_page,
)
from pantocheck.conformance.authenticity.recomputation import find_discrepancies
from pantocheck.conformance.grading.verdicts import Verdict
from pantocheck.conformance.reports.certificate.certificate_page import HEADING
from pantocheck.conformance.reports.page_text import clean_text
from pantocheck.conformance.reports.words import read_words


@dataclass(frozen=True)
class Verification:
    """Result of the verification of a certificate."""

    verdict: Verdict
    """Verdict stated in the embedded results."""
    cases: int
    criteria: int
    discrepancies: tuple[str, ...]
    """One line each; none if the certificate is consistent."""

    @property
    def consistent(self) -> bool:
        """Whether every verdict follows from the numbers."""
        return not self.discrepancies


def verify_certificate(path: Path) -> Verification:
    """Grade the results embedded in a certificate again and compare.

    A consistent certificate has verdicts that follow from its numbers. Only a new run shows that the numbers come from
    the named system.

    Parameters
    ----------
    path : Path
        Certificate as PDF.

    Raises
    ------
    InputError
        Not a PDF, damaged, or without valid results.
    """
    reader = open_document(path)
    results = read_embedded_results(path, reader)
    discrepancies = find_discrepancies(results)
    word = read_words()["verdict"][results["verdict"]]["word"]
    title, first_page = read_title_and_first_page(path, reader)
    if not title.startswith(word):
        discrepancies.append(f"the document's title does not begin with the verdict {word}: '{title}'")
    heading = next((line for line in first_page.splitlines() if line.startswith(HEADING)), "")
    if word not in heading.split():
        discrepancies.append(f"the first page does not print the verdict {word} in its heading: '{heading}'")
    return Verification(
        verdict=results["verdict"],
        cases=len(results["cases"]),
        criteria=sum(len(case["criteria"]) + _count_verified(case) for case in results["cases"]),
        discrepancies=tuple(clean_text(text) for text in discrepancies),
    )


def _count_verified(case: dict[str, Any]) -> int:
    """Number of criteria of the verification up to 50 Hz of a case."""
    return 0 if case["verification"] is None else len(case["verification"]["criteria"])
