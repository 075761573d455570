"""Forgeries: each kind is found in results.json, a few in PDF and HTML; `.ci/thorough forgeries` tries all of them."""

import csv
from pathlib import Path

import pytest

from verification.attacks.forged_pages import HTML_FORGERIES
from verification.attacks.forged_pdfs import PDF_FORGERIES
from verification.attacks.forgeries import (
    OUTSIDE,
    SEED,
    SHORT_STATEMENTS,
    Genuine,
    attempt,
    list_forgeries,
    list_result_forgeries,
)
from verification.attacks.raised_statements import EVERY_CHANGE, STATE_CHANGES
from verification.tables.__main__ import TABLES

OUTCOMES = {*SHORT_STATEMENTS.values(), "refused", "consistent", "not compared in full"}
"""First words of the outcome of a file."""

PDF_KINDS = [
    "heading painted over", "note over the heading, as update", "further attachment", "script", "written again",
]  # fmt: skip
HTML_KINDS = ["every word of a verdict", "coordinate of a curve", "rows hidden by style", "script", "embedded verdict"]


@pytest.mark.parametrize("kind", EVERY_CHANGE)
def test_forged_results_are_found(genuine: Genuine, bare: Genuine, tmp_path: Path, kind: str) -> None:
    """A forged results.json is consistent only for the kinds that need a record, a new run or a signature."""
    base = bare if kind in STATE_CHANGES else genuine
    carrier, content, suffix = next(list_result_forgeries(base, kind, SEED))
    outcome = attempt(kind, carrier, content, suffix, tmp_path).outcome
    assert (outcome == "consistent") == (kind in OUTSIDE), outcome


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("carrier", "kind"), [*(("PDF", kind) for kind in PDF_KINDS), *(("HTML", kind) for kind in HTML_KINDS)]
)
def test_forged_files_are_found(genuine: Genuine, tmp_path: Path, carrier: str, kind: str) -> None:
    [item] = [item for item in list_forgeries(genuine, kind, SEED) if item[0] == carrier]
    assert {"pages", "appended bytes"} & set(attempt(kind, *item, tmp_path).outcome.split(", "))


@pytest.mark.thorough
@pytest.mark.parametrize("carrier", ["PDF, attachment alone", "HTML, data alone"])
def test_pages_beside_other_results_are_found(genuine: Genuine, tmp_path: Path, carrier: str) -> None:
    """Results that are consistent in themselves contradict the genuine pages."""
    kind = "name of the system"
    [item] = [item for item in list_result_forgeries(genuine, kind, SEED) if item[0] == carrier]
    assert attempt(kind, *item, tmp_path).outcome == "pages"


def test_tables_list_every_kind() -> None:
    texts = [path.read_text("utf-8") for path in TABLES.glob("forged-*.csv")]
    rows = [row for text in texts for row in csv.reader(text.splitlines())]
    kinds = {*EVERY_CHANGE, *PDF_FORGERIES, *HTML_FORGERIES}
    assert len(kinds) >= 60
    assert kinds <= {row[0] for row in rows}
    assert {row[0] for row in rows if "consistent" in row} <= set(OUTSIDE)
    page = (TABLES.parent / "forgeries.md").read_text("utf-8")
    tables = [TABLES / f"forged-{name}.csv" for name in ("results", "pdf", "html")]
    cells = [cell for path in tables for row in csv.reader(path.read_text("utf-8").splitlines()) for cell in row[1:]]
    files = [cell for cell in cells if cell.split(",")[0] in OUTCOMES]
    consistent = {row[0] for row in rows if "consistent" in row}
    counts = f"{len(kinds)} kinds of forgery give {len(files)} files", f"finds {len(files) - files.count('consistent')}"
    assert [text for text in (*counts, f"{len(consistent)} kinds are consistent") if text not in page] == []
