"""Table of the findings of docs/damping-study.md, from the results of the study.

    pantocheck run 'vovan2015/*' --jobs 2 --formats json --out study
    python -m verification.tables.study_findings study/results.json --renew docs/damping-study.md

Prints the table, and with `--renew` replaces the table between the two marks of a page.
"""

import argparse
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from pantocheck.conformance.quantities.limit_text import format_bounds
from pantocheck.conformance.reports.certificate.findings_table import count_sentences, list_findings
from pantocheck.conformance.results.results_reading import read_results

BEGIN, END = "<!-- findings: written by verification/tables/study_findings.py -->", "<!-- end of findings -->"
HEADINGS = ("section", "finding", "printed", "computed", "bounds", "role", "outcome")


def build_table(results: dict[str, Any]) -> str:
    """Markdown table of the findings, with their numbers by outcome and the reasons of contradicted ones."""
    rows = [(case["id"], row, row["finding"]) for case, row in list_findings(results)]
    cells = [HEADINGS, ("---",) * len(HEADINGS)]
    for _, row, finding in rows:
        value = "-" if row["value"] is None else f"{row['value']:.3g}"
        bounds = format_bounds(row["lower"], row["upper"])
        texts = (finding["section"], finding["sentence"], finding["printed"], f"{value} {row['unit']}".strip(), bounds)
        cells.append((*texts, finding["role"].replace("_", " "), finding["outcome"].replace("_", " ")))
    table = "\n".join(f"| {' | '.join(row)} |" for row in cells)
    return "\n\n".join([" ".join(count_sentences(results)), table, *_explain(rows)])


def _explain(rows: list[tuple[str, dict[str, Any], dict[str, Any]]]) -> Iterator[str]:
    """One sentence per finding that is not reproduced and has a sensitivity."""
    reasons = [
        f"* {finding['sentence']} {finding['sensitivity']}"
        for _, _, finding in rows
        if finding["outcome"] == "not_reproduced" and finding["sensitivity"]
    ]
    if reasons:
        yield "Sensitivity of findings that are not reproduced:"
        yield "\n".join(reasons)


def renew_page(page: str, table: str) -> str:
    """Page with the table between its marks replaced."""
    before, rest = page.split(BEGIN)
    _, after = rest.split(END)
    return f"{before}{BEGIN}\n\n{table}\n\n{END}{after}"


def main() -> None:
    """Print the table and renew the page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("results", type=Path, help="results.json of the study")
    parser.add_argument("--renew", type=Path, help="page whose table is replaced")
    arguments = parser.parse_args()
    table = build_table(read_results(arguments.results).to_dict())
    print(table)
    if arguments.renew is not None:
        page = arguments.renew.read_text(encoding="utf-8")
        arguments.renew.write_text(renew_page(page, table), encoding="utf-8")


if __name__ == "__main__":
    main()
