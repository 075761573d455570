"""Forged certificates and the outcome of their verification.

    python -m verification.attacks.forgeries [--seed 20261122] [--only WORD] [--jobs N]

The genuine document is a run that fails. Each kind of forgery changes the file of a certificate (`forged_pdfs.py`,
`forged_pages.py`) or its results (`forged_results.py`). Changed results are put into `results.json`, into the PDF and
the HTML page beside the genuine pages, and into pages that are made again by the same software. `--only` selects kinds
by a part of their names. The exit code is 1 if a forgery is accepted that is not
listed in `OUTSIDE`.
"""

import argparse
import multiprocessing
import random
import re
import sys
import tempfile
from collections import Counter
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from pantocheck.conformance.cases.input_changes import parse_changes
from pantocheck.conformance.cases.library import load_case
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.documents.authenticity_check import DocumentCheck
from pantocheck.conformance.documents.document_reading import read_certificate
from pantocheck.conformance.documents.repetition_check import check_record_quantities, check_rerun
from pantocheck.conformance.documents.verification import Verification, verify_certificate
from pantocheck.conformance.execution.runner import run_cases
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.pages.certificate_page import build_certificate
from pantocheck.conformance.pages.document import encode_attachment, encode_data_block
from pantocheck.conformance.pages.html import render_html
from pantocheck.conformance.pages.pdf import render_pdf
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.record_writing import write_record
from pantocheck.conformance.results.results_format import Results
from pantocheck.conformance.runs.record_folder import open_record_folder
from pantocheck.conformance.runs.reference_simulator import ReferenceSimulator
from verification.attacks.forged_pages import HTML_FORGERIES
from verification.attacks.forged_pdfs import PDF_FORGERIES, replace_attachment
from verification.attacks.raised_statements import EVERY_CHANGE, STATE_CHANGES, forge_results

SEED = 20261122
CASE = "en50318-2002/250"

OUTSIDE = {
    "unconfirmed records accepted": "page 1 names the accepted system",
    "trust of the run": "page 1 states the trust; the verdict is `info`",
    "case for information": "page 1 names the case; the verdict is `info`",
    "uncertainty divided by ten": "",
    "name of the system": "",
    "version of the system": "",
    "software of the pages": "the output names the other versions",
    "definition of skipped quantities": "",
    "time step and element length": "",
    "time of the run": "an earlier date follows from no result; the time stamp of a signature shows it",
    "administrative data": "",
}
"""Kinds that are consistent, and the remark that a reader sees. A signature shows them."""

SHORT_STATEMENTS = {
    "Numbers of consistency checks": "checks of the record",
    "The embedded numbers": "numbers",
    "Parts that every run": "missing parts",
    "Inputs, limits": "library",
    "Cases or limits": "library",
    "The document is not the one": "pages",
    "The file is not as": "layout",
    "The document shows": "pages",
    "The document has a date": "pages",
    "The file was changed": "appended bytes",
}
"""Short names of the checks, by the beginning of their statements."""


@dataclass(frozen=True)
class Genuine:
    """Genuine documents of one run."""

    results: dict[str, Any]
    pdf: bytes
    html: str


@dataclass(frozen=True)
class Attempt:
    """Outcome of one forgery in one file."""

    kind: str
    carrier: str
    outcome: str
    """`consistent`, or the checks that found the forgery."""


def build_genuine(results: dict[str, Any]) -> Genuine:
    """Documents of results."""
    certificate = build_certificate(Results.model_validate(results))
    return Genuine(results, render_pdf(certificate), render_html(certificate))


def simulate_failing() -> Record:
    """Record that fails: another start of the train, where the standard deviation is below its limit."""
    path = library_folder() / f"{CASE}.toml"
    simulated = ReferenceSimulator().run_unrefined(load_case(path, parse_changes(["start_m=120"]))).record
    assert simulated is not None
    return simulated


def grade_record(record: Record, folder: Path) -> dict[str, Any]:
    """Results of a record, which is written into a folder as `run.h5`."""
    write_record(folder / "run.h5", record, case=CASE, system={"name": "Simulator A", "version": "1"}, run={})
    return run_cases([load_case(library_folder() / f"{CASE}.toml")], open_record_folder(folder)).to_dict()


def list_result_forgeries(genuine: Genuine, kind: str, seed: int) -> Iterator[tuple[str, bytes, str]]:
    """Forged files of one kind of forged results: carrier, content and suffix."""
    forged = forge_results(genuine.results, kind, seed)
    if forged == genuine.results:
        raise AssertionError(f"{kind}: nothing was forged")
    yield "results.json", Results.model_validate(forged).to_json(), "json"
    yield (
        "PDF, attachment alone",
        replace_attachment(genuine.pdf, encode_attachment(Results.model_validate(forged))),
        "pdf",
    )
    block = re.escape(encode_data_block(Results.model_validate(genuine.results)))
    yield (
        "HTML, data alone",
        re.sub(block, lambda _: encode_data_block(Results.model_validate(forged)), genuine.html).encode(),
        "html",
    )
    try:
        certificate = build_certificate(Results.model_validate(forged))
    except KeyError:  # the results contradict themselves, so that no page can be made from them
        return
    yield "PDF made again", render_pdf(certificate), "pdf"
    yield "HTML made again", render_html(certificate).encode(), "html"


def list_forgeries(genuine: Genuine, kind: str, seed: int) -> Iterator[tuple[str, bytes, str]]:
    """Forged files of one kind: carrier, content and suffix; parameters as in `list_result_forgeries`."""
    if kind in EVERY_CHANGE:
        yield from list_result_forgeries(genuine, kind, seed)
    if kind in PDF_FORGERIES:
        yield "PDF", PDF_FORGERIES[kind](genuine.pdf, random.Random(f"{seed} {kind}")), "pdf"
    if kind in HTML_FORGERIES:
        yield "HTML", HTML_FORGERIES[kind](genuine.html, random.Random(f"{seed} {kind}")).encode("utf-8"), "html"


def verify_content(content: bytes, suffix: str, folder: Path) -> Verification:
    """Verification of the content of a file."""
    path = folder / f"forged.{suffix}"
    path.write_bytes(content)
    return verify_certificate(read_certificate(path))


def attempt_kind(genuine: Genuine, kind: str, seed: int) -> list[Attempt]:
    """Verify every forged file of one kind."""
    with tempfile.TemporaryDirectory() as folder:
        return [attempt(kind, *item, Path(folder)) for item in list_forgeries(genuine, kind, seed)]


def attempt(kind: str, carrier: str, content: bytes, suffix: str, folder: Path) -> Attempt:
    """Verify one forged file."""
    try:
        verification = verify_content(content, suffix, folder)
    except InputError:
        return Attempt(kind, carrier, "refused")
    if verification.consistent:
        return Attempt(kind, carrier, "consistent")
    found = name_checks(verification.checks, "contradicted") or "not compared in full"
    return Attempt(kind, carrier, found)


def name_checks(checks: tuple[DocumentCheck, ...], outcome: str) -> str:
    """Short names of the checks with an outcome."""
    statements = [check.statement for check in checks if check.outcome == outcome]
    names = (
        next((short for beginning, short in SHORT_STATEMENTS.items() if statement.startswith(beginning)), statement)
        for statement in statements
    )
    return ", ".join(dict.fromkeys(names))


def check_outside(kind: str, genuine: Genuine, built_in: dict[str, Any], folder: Path, seed: int) -> tuple[str, str]:
    """Outcomes of `--record` and `--rerun` for a kind that the document alone does not show."""
    if kind not in EVERY_CHANGE:
        return "-", "-"
    forged = Results.model_validate(forge_results(genuine.results, kind, seed))
    again = Results.model_validate(forge_results(built_in, kind, seed))
    return (
        find_outcome(lambda: check_record_quantities(forged, folder / "run.h5")),
        find_outcome(lambda: check_rerun(again)),
    )


def find_outcome(check: Callable[[], list[DocumentCheck]]) -> str:
    """Whether checks find a contradiction."""
    try:
        return "found" if any(item.outcome == "contradicted" for item in check()) else "-"
    except InputError:
        return "refused"


CARRIERS = ("results.json", "PDF, attachment alone", "PDF made again", "HTML, data alone", "HTML made again")
"""Files that carry forged results."""


def print_tables(attempts: list[Attempt], others: dict[str, tuple[str, str]]) -> None:
    """Print the tables of docs/forgeries.md: forged results, PDFs and HTML pages, and kinds that are consistent."""
    results = {item.kind for item in attempts if item.kind in EVERY_CHANGE}
    outcomes = {(item.kind, item.carrier): item.outcome for item in attempts}
    rows = [[kind, *(outcomes.get((kind, carrier), "not possible") for carrier in CARRIERS)] for kind in EVERY_CHANGE]
    _print_table(["kind", "`results.json`", *CARRIERS[1:]], [row for row in rows if row[0] in results])
    for carrier in ("PDF", "HTML"):
        _print_table(["kind", "outcome"], [[item.kind, item.outcome] for item in attempts if item.carrier == carrier])
    outside = [[kind, *others[kind], "found", remark] for kind, remark in OUTSIDE.items() if kind in others]
    _print_table(["kind", "`--record`", "`--rerun`", "`--trust-roots`", "remark"], outside)


def _print_table(heading: list[str], rows: list[list[str]]) -> None:
    print("\n" + "\n".join(f"| {' | '.join(row)} |" for row in (heading, ["---"] * len(heading), *rows)))


def main() -> int:
    """Forge documents of every kind, and print the outcomes and the tables of docs/forgeries.md."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, default=SEED)
    parser.add_argument("--only", default="", help="part of the names of the kinds")
    parser.add_argument("--jobs", type=int, default=1, help="number of processes")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        record, bare_folder = simulate_failing(), folder / "bare"
        genuine = build_genuine(grade_record(record, folder))
        # Kinds that raise the state of a record need one that is not confirmed: it has no contact height.
        bare = build_genuine(grade_record(replace(record, contact_height=None), bare_folder))
        for content, suffix in ((genuine.pdf, "pdf"), (genuine.html.encode(), "html"), (bare.pdf, "pdf")):
            assert verify_content(content, suffix, folder).consistent
        kinds = [kind for kind in (*EVERY_CHANGE, *PDF_FORGERIES, *HTML_FORGERIES) if options.only in kind]
        attempts = []
        with ProcessPoolExecutor(options.jobs, multiprocessing.get_context("spawn")) as pool:
            chosen = list(dict.fromkeys(kinds))
            bases = [bare if kind in STATE_CHANGES else genuine for kind in chosen]
            for found in pool.map(attempt_kind, bases, chosen, [options.seed] * len(chosen)):
                attempts += found
                for item in found:
                    print(f"{item.kind:36s} {item.carrier:22s} {item.outcome}", flush=True)
        missed = list(dict.fromkeys(item.kind for item in attempts if item.outcome == "consistent"))
        case = load_case(library_folder() / f"{CASE}.toml")
        built_in = run_cases([case], ReferenceSimulator()).to_dict() if missed else {}
        others = {}
        for kind in missed:
            base, place = (bare, bare_folder) if kind in STATE_CHANGES else (genuine, folder)
            others[kind] = check_outside(kind, base, built_in, place, options.seed)
    print(Counter(item.outcome for item in attempts))
    print_tables(attempts, others)
    unexpected = [kind for kind in missed if kind not in OUTSIDE]
    print(f"accepted, and not listed: {', '.join(unexpected) or 'none'}")
    return 1 if unexpected else 0


if __name__ == "__main__":
    sys.exit(main())
