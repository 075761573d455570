"""Check of cases from outside against the distribution or folder that holds them."""

from collections.abc import Iterator

from pantocheck.conformance.authenticity.authenticity_check import DocumentCheck, judge_details
from pantocheck.conformance.authenticity.library_check import compare_with_case
from pantocheck.conformance.cases.case_origin import CaseOrigin
from pantocheck.conformance.cases.catalogue import CaseEntry, Catalogue
from pantocheck.conformance.cases.library import load_entry
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.results.results_format import CaseResult, Results

SOURCE_REMEDIES = {
    "file": "only the digest of its file is stated",
    "folder": "give its folder by --cases",
    "distribution": "install the distribution",
}
"""Way to compare a case whose source is not at hand, by the kind of the source."""


def check_outside_cases(results: Results, catalogue: Catalogue) -> list[DocumentCheck]:
    """Compare the cases from outside with the sources that are at hand.

    A source is written by its author, so that a proved comparison shows the origin of inputs and limits, not their
    quality.

    Args:
        results: Results of a document.
        catalogue: Folders of the user; installed distributions are searched for the ids of the results.
    """
    return [_check(case, case.origin, catalogue) for case in results.cases if case.origin is not None]


def _check(result: CaseResult, stated: CaseOrigin, catalogue: Catalogue) -> DocumentCheck:
    try:
        entry = catalogue.find_id(result.id)
    except InputError as error:
        return DocumentCheck("open", f"{result.id} was not compared: {stated.text} is refused.", (error.message,))
    if entry is None or entry.origin is None or (entry.origin.kind, entry.origin.name) != (stated.kind, stated.name):
        return DocumentCheck(
            "open", f"{result.id} was not compared with {stated.text}: {SOURCE_REMEDIES[stated.kind]}."
        )
    if entry.origin.version != stated.version:
        text = f"{result.id} was not compared with {stated.text}: version {entry.origin.version} is installed."
        return DocumentCheck("open", text)
    return judge_details(
        f"Inputs, limits and texts of {result.id} are those of {stated.text}, as its author states them.",
        f"{result.id} is not the case of {stated.text}.",
        _list_differences(result, entry, stated),
    )


def _list_differences(result: CaseResult, entry: CaseEntry, stated: CaseOrigin) -> Iterator[str]:
    # The sentences of the comparison call the place of the case the library.
    yield from (text.replace("the library", stated.text) for text in compare_with_case(load_entry(entry), result))
    if entry.origin is not None and entry.origin.digest != stated.digest:
        yield f"digest of all files: {entry.origin.digest[:19]} at hand, {stated.digest[:19]} in the certificate"
