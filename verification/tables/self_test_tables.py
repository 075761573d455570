"""Verdict on every mutant and numerical fault of the self-test; prints tables of docs/self-test.md.

python -m verification.tables.self_test_tables
"""

import argparse
from collections.abc import Iterable, Sequence

from pantocheck.conformance.app.commands.system_self_test_command import DEFAULT_CASES, NUMERICAL_CASES
from pantocheck.conformance.app.self_test.mutants import MutantResult, run_self_test
from pantocheck.conformance.app.self_test.numerical_faults import NumericalResult, run_numerical_faults
from pantocheck.conformance.cases.library import select_cases


def list_severe(results: Iterable[MutantResult]) -> list[tuple[str, ...]]:
    """Rows of the mutants that must be detected, the heading first."""
    heading = ("mutant", "fault", "case", "verdict", "detected by", "limits alone", "quantities outside their limits")
    rows = [(*_describe(row), row.mutant.expected_check or "-", row.by_limits, _join(row.outside)) for row in results]
    return [heading, *rows]


def list_mild(results: Iterable[MutantResult]) -> list[tuple[str, ...]]:
    """Rows of the mutants that may remain undetected, the heading first."""
    heading = ("mutant", "fault", "case", "verdict", "failed check", "quantities outside their limits")
    return [heading, *((*_describe(row), ", ".join(row.checks) or "none", _join(row.outside)) for row in results)]


def list_numerical(results: Iterable[NumericalResult]) -> list[tuple[str, ...]]:
    """Rows of the numerical faults, the heading first."""
    heading = ("fault", "case", "EN 50318 criteria", "verification", "verified quantities outside their limits")
    names = {row: row.fault.name if row.fault.must_be_detected else f"{row.fault.name} (optional)" for row in results}
    rows = [(name, f"`{row.case}`", row.criteria, row.verification, _join(row.outside)) for row, name in names.items()]
    return [heading, *rows]


def _describe(row: MutantResult) -> tuple[str, ...]:
    return row.mutant.name, row.mutant.fault, f"`{row.case}`", row.verdict


def _join(quantities: Sequence[str]) -> str:
    return ", ".join(f"`{name}`" for name in quantities) or "none"


def print_table(rows: list[tuple[str, ...]]) -> None:
    """Print a table in Markdown."""
    heading, *others = rows
    print("\n".join(f"| {' | '.join(row)} |" for row in (heading, ["---"] * len(heading), *others)), end="\n\n")


def main() -> None:
    """Run and print."""
    argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter).parse_args()
    cases = select_cases(DEFAULT_CASES)
    self_test = run_self_test(cases, lambda _: None)
    print_table(list_severe(self_test.severe))
    print_table(list_numerical(run_numerical_faults([*cases, *select_cases(NUMERICAL_CASES)], lambda _: None)))
    print_table(list_mild(self_test.mild))


if __name__ == "__main__":
    main()
