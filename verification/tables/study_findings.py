"""Table of the findings of docs/damping-study.md, from the results of the study.

pantocheck run 'vovan2015/*' --jobs 2 --formats json --out study
python -m verification.tables.study_findings study/results.json
"""

import argparse
from pathlib import Path

from pantocheck.conformance.pages.findings_table import describe_counts, list_findings
from pantocheck.conformance.quantities.limit_text import format_bounds
from pantocheck.conformance.results.results_format import Results
from pantocheck.conformance.results.results_reading import read_results

HEADINGS = (
    "section", "statement", "finding", "printed", "computed", "bounds", "role", "outcome", "sensitivity"
)  # fmt: skip


def build_table(results: Results) -> str:
    """Markdown table of the findings; those that are not reproduced state their sensitivity."""
    cells = [HEADINGS, ("---",) * len(HEADINGS)]
    for _, row, finding in list_findings(results):
        value = "-" if row.value is None else f"{row.value:.3g}"
        words = (finding.role.replace("_", " "), finding.outcome.replace("_", " "))
        fails = finding.outcome in ("not_reproduced", "inferred_not_met")
        texts = (finding.section, finding.statement, finding.sentence, finding.printed)
        numbers = (f"{value} {row.unit}".strip(), format_bounds(row.lower, row.upper))
        cells.append((*texts, *numbers, *words, finding.sensitivity if fails else ""))
    return "\n".join(f"| {' | '.join(row)} |" for row in cells)


def main() -> None:
    """Print the numbers by outcome and the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("results", type=Path, help="results.json of the study")
    results = read_results(parser.parse_args().results)
    print(" ".join(describe_counts(results)))
    print(build_table(results))


if __name__ == "__main__":
    main()
