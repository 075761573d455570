"""Check of results by a new run of the built-in simulator."""

import platform as host
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from importlib.metadata import version

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.catalogue import LIBRARY, Catalogue
from pantocheck.conformance.cases.library import load_entry
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.documents.authenticity_check import DocumentCheck, judge_details
from pantocheck.conformance.documents.number_comparison import NumberComparison, NumberTree, compare_numbers
from pantocheck.conformance.documents.version_differences import list_suite_differences
from pantocheck.conformance.execution.runner import run_case
from pantocheck.conformance.results.results_format import CaseResult, Results
from pantocheck.conformance.runs.reference_simulator import ReferenceSimulator
from pantocheck.conformance.studies.damping_sensitivity import add_damping_study

OTHER_PLATFORM = 1e-6
"""Largest relative difference of a new run on another processor or with other versions of the numerical packages.

The same run without the vector instructions of the processor differs by less than 1e-9 (docs/verify.md)."""

MOST_NUMBERS = 10
"""Largest number of differing numbers that are listed."""

NUMBER_PARTS = (
    *("quantities", "uncertainty", "uncertainty_components", "spread"),
    *("derived", "traces", "uplift", "charts", "tables"),
)
"""Parts of a result with the computed numbers. Limits and verdicts follow from them and are checked without a run."""

TEXT_PARTS = (
    *("warnings", "notes", "model_uncertainty", "skipped", "uncertainty_basis", "record", "run"),
    "line_shape",
)
"""Parts with texts or rounded numbers, compared where the numbers are equal bit for bit."""


@dataclass(frozen=True)
class Rerun:
    """New run of one case."""

    case: str
    comparison: NumberComparison


def check_rerun(results: Results, catalogue: Catalogue = LIBRARY) -> list[DocumentCheck]:
    """Run the cases of results again and compare all computed numbers.

    Args:
        results: Results of the built-in simulator.
        catalogue: Cases at hand; others are named and not run.

    Raises:
        InputError: Another system made the results.
    """
    simulator = ReferenceSimulator()
    if (results.system.kind, results.system.name) != (simulator.kind, simulator.name):
        raise InputError(
            "option --rerun",
            f"the system '{results.system.name}' is not the built-in simulator",
            "Run this system again with 'pantocheck run --system', or give its record with --record.",
        )
    computed = [case for case in results.cases if case.quantities]
    entries = {case.id: catalogue.find_id(case.id) for case in computed}
    tolerance = 0.0 if _is_same_platform(results) else OTHER_PLATFORM
    reruns = [
        _rerun(load_entry(entry), case, results, simulator, tolerance)
        for case in computed
        if (entry := entries[case.id]) is not None
    ]
    return [*_judge(results, reruns, tolerance), *_name_skipped([name for name in entries if entries[name] is None])]


def _rerun(case: Case, stated: CaseResult, results: Results, simulator: ReferenceSimulator, tolerance: float) -> Rerun:
    with_study = add_damping_study(case) if stated.tables else case
    result = run_case(with_study, simulator, results.trust)
    keys = (*NUMBER_PARTS, *(() if tolerance else TEXT_PARTS))
    return Rerun(stated.id, compare_numbers(_select_parts(stated, keys), _select_parts(result, keys), tolerance))


def _select_parts(result: CaseResult, keys: Sequence[str]) -> NumberTree:
    """Parts of a result that a new run repeats; the computing time is left out."""
    untimed = result.model_copy(update={"run": result.run.model_copy(update={"wall_s": None})})
    return {key: untimed.model_dump(mode="json", include={key}).get(key) for key in keys}


def _judge(results: Results, reruns: list[Rerun], tolerance: float) -> Iterator[DocumentCheck]:
    if not reruns:
        return
    numbers, largest = sum(run.comparison.count for run in reruns), max(run.comparison.largest for run in reruns)
    differences = [f"{run.case}: {text}" for run in reruns for text in run.comparison.differences]
    agreement = "bit for bit" if largest == 0 else f"within {tolerance:g} (largest relative difference {largest:.1e})"
    proved = f"A new run of the built-in simulator gives the same {numbers} values, {agreement}."
    contradicted = f"A new run of the built-in simulator gives other values ({len(differences)} of {numbers})."
    if differences and (versions := list_suite_differences(results)):
        yield DocumentCheck("incomplete", contradicted, (*versions, *differences[:MOST_NUMBERS]))
    else:
        yield judge_details(proved, contradicted, differences[:MOST_NUMBERS])


def _name_skipped(skipped: list[str]) -> Iterator[DocumentCheck]:
    if skipped:
        text = "These cases were not run again: neither the installed library nor a given folder has them."
        yield DocumentCheck("open", text, tuple(skipped))


def _is_same_platform(results: Results) -> bool:
    """Whether the numerical packages and the kind of processor are those of the results."""
    stated = results.platform
    versions = {name: version(name) for name in ("numpy", "scipy", "numba")}
    machine = (stated.machine, stated.system) == (host.machine(), host.system())
    return machine and all(getattr(stated, name) == number for name, number in versions.items())
