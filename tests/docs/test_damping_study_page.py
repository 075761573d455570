"""Page on the damping study: its table holds every finding of the library, with the outcomes of its numbers."""

import csv
from pathlib import Path

from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.cases.limits import Limit
from pantocheck.conformance.core.findings import judge_finding
from pantocheck.conformance.core.verdicts import judge
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.quantities.limit_text import format_bounds

DOCS = Path(__file__).parents[2] / "docs"
PAGE = (DOCS / "damping-study.md").read_text(encoding="utf-8")
Row = dict[str, str]


def read_rows() -> list[Row]:
    with (DOCS / "tables" / "study-findings.csv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def list_limits() -> list[Limit]:
    return [limit for case in select_cases(["vovan2015/*"]) for limit in case.limits if limit.finding is not None]


def describe(limit: Limit) -> tuple[str, str, str, str, str]:
    finding = limit.finding
    bounds = format_bounds(limit.lower, limit.upper)
    return finding.section, finding.sentence, finding.printed, bounds, finding.role.replace("_", " ")


def test_table_and_counts_hold_every_finding_of_the_library_once() -> None:
    rows = [tuple(row[name] for name in ("section", "finding", "printed", "bounds", "role")) for row in read_rows()]
    assert sorted(rows) == sorted(map(describe, list_limits()))
    assert len({row[1] for row in rows}) == len(rows)
    outcomes = [row["outcome"] for row in read_rows()]
    names = ("imposed", "reproduced", "not reproduced", "inferred met", "inferred not met")
    numbers = ", ".join(f"{outcomes.count(name)} {name}" for name in names)
    assert f"Findings: {numbers}." in PAGE


def test_outcomes_follow_from_the_printed_values() -> None:
    """A value is rounded to three digits: no finding of the study is so close to its bound."""
    limits = {limit.finding.sentence: limit for limit in list_limits()}
    for row in read_rows():
        limit, value = limits[row["finding"]], float(row["computed"].split()[0])
        outcome = judge_finding(limit.finding.role, judge(value, limit.lower, limit.upper))
        assert row["outcome"] == outcome.replace("_", " "), row["finding"]


def test_commands_of_the_page_are_those_of_the_damping_files() -> None:
    """tests/conformance/line/elements/test_damping_files.py fits with these options."""
    (fit,) = (line for line in PAGE.splitlines() if line.startswith("pantocheck drop fit"))
    assert (
        "modes/modes.json --line vovan2015/mass-drop/stand-in --element 0.75 --wires common --free none --out fit"
        in fit
    )
    names = {path.stem for path in (library_folder() / "vovan2015" / "damping").glob("*.toml")}
    written = {name for name in names if f"reference_cases/vovan2015/damping/{name}.toml\n" in PAGE}
    assert written == {"stand-in", "updated", "updated-modal"}
    assert names - written == {"benchmark", "initial", "printed"}  # transcribed from their sources
