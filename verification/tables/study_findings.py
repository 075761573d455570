"""Table of the findings of docs/damping-study.md, from the results of the study.

pantocheck run 'vovan2015/*' --jobs 2 --formats json --out study
python -m verification.tables.study_findings study/results.json
"""

import argparse
from pathlib import Path
from typing import Any

from pantocheck.conformance.pages.criteria_table import describe_counts, list_findings
from pantocheck.conformance.quantities.limit_text import format_bounds
from pantocheck.conformance.results.results_reading import read_results

HEADINGS = ("section", "finding", "printed", "computed", "bounds", "role", "outcome", "sensitivity")


def build_table(results: dict[str, Any]) -> str:
    """Markdown table of the findings; those that are not reproduced state their sensitivity."""
    cells = [HEADINGS, ("---",) * len(HEADINGS)]
    for _, row in list_findings(results):
        finding = row["finding"]
        value = "-" if row["value"] is None else f"{row['value']:.3g}"
        bounds = format_bounds(row["lower"], row["upper"])
        texts = (finding["section"], finding["sentence"], finding["printed"], f"{value} {row['unit']}".strip(), bounds)
        sensitivity = finding["sensitivity"] if finding["outcome"] == "not_reproduced" else ""
        words = (finding["role"].replace("_", " "), finding["outcome"].replace("_", " "), sensitivity or "")
        cells.append((*texts, *words))
    return "\n".join(f"| {' | '.join(row)} |" for row in cells)


def main() -> None:
    """Print the numbers by outcome and the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("results", type=Path, help="results.json of the study")
    results = read_results(parser.parse_args().results).to_dict()
    print(" ".join(describe_counts(results)))
    print(build_table(results))


if __name__ == "__main__":
    main()
