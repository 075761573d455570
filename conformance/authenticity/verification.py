"""Verifying a certificate: its results are taken out of it and graded once more."""

from dataclasses import dataclass
from pathlib import Path

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
    """What came out of verifying a certificate.

    Parameters
    ----------
    verdict : Verdict
        As the embedded results state it.
    cases, criteria : int
        How many there are.
    discrepancies : tuple[str, ...]
        One line each; none if the certificate is consistent.
    """

    verdict: Verdict
    cases: int
    criteria: int
    discrepancies: tuple[str, ...]

    @property
    def consistent(self) -> bool:
        """Whether every verdict follows from the numbers."""
        return not self.discrepancies


def verify_certificate(path: Path) -> Verification:
    """Grade the results embedded in a certificate once more and compare.

    This shows that the verdicts follow from the numbers; that the numbers come from the system they name, only a new
    run shows.

    Parameters
    ----------
    path : Path
        a certificate.pdf.

    Raises
    ------
    InputError
        Not a PDF, damaged, or without valid results.
    """
    reader = open_document(path)
    results = read_embedded_results(path, reader)
    found = find_discrepancies(results)
    word = read_words()["verdict"][results["verdict"]]["word"]
    title, first_page = read_title_and_first_page(path, reader)
    if not title.startswith(word):
        found.append(f"the document's title does not begin with the verdict {word}: '{title}'")
    heading = next((line for line in first_page.splitlines() if line.startswith(HEADING)), "")
    if word not in heading.split():
        found.append(f"the first page does not print the verdict {word} in its heading: '{heading}'")
    return Verification(
        verdict=results["verdict"],
        cases=len(results["cases"]),
        criteria=sum(len(case["criteria"]) for case in results["cases"]),
        discrepancies=tuple(clean_text(text) for text in found),
    )
