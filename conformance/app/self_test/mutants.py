"""Systems with one deliberate fault each, of a kind that has occurred in practice."""

import tempfile
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np

from pantocheck.conformance.app.self_test.numerical_faults import TRUST, NumericalResult
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.verdicts import Verdict
from pantocheck.conformance.grading.case_evaluation import CaseEvaluation
from pantocheck.conformance.grading.case_grading import grade_case, grade_evaluation
from pantocheck.conformance.grading.case_verdict import judge_case
from pantocheck.conformance.grading.validity_warnings import WARNING_PREFIX
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.records.record import FORCE_CHANNELS, Record
from pantocheck.conformance.records.record_writing import write_record
from pantocheck.conformance.results.results_format import CaseResult
from pantocheck.conformance.runs.case_run import run_passage
from pantocheck.conformance.runs.record_folder import open_record_folder
from pantocheck.conformance.runs.reference_simulator import ReferenceSimulator
from pantocheck.conformance.runs.static_quantities import compute_static_quantities
from pantocheck.conformance.runs.system import Delivered, Outcome
from pantocheck.model import discretise, make_droppers_bilateral

RunMutant = Callable[[Case, Record], Outcome]
"""Outcome of a faulty system on a case, made from the record of the reference simulator."""

SAMPLE_CHANNELS = ("time", "position", "contact_height", "support_uplift", *FORCE_CHANNELS)


@dataclass(frozen=True)
class Mutant:
    """A system with a fault."""

    name: str
    """Short name."""
    fault: str
    """The fault in one sentence."""
    run: RunMutant
    """Run of the faulty system."""
    expected_check: Literal["coverage", "support passing", "roll-off", "dynamics", "limits", "record file"] | None
    """Check that must detect the fault; `limits`: the limits of the case; None: a mild fault, which may remain
    undetected.
    """


def _replace_channels(**changes: Callable[[Case, Record], Any]) -> RunMutant:
    """The record with some of its fields replaced."""
    return lambda case, record: Delivered(
        replace(record, **{name: change(case, record) for name, change in changes.items()})
    )


def _change_channels(record: Record, names: Iterable[str], change: Callable[[RealArray], RealArray]) -> dict[str, Any]:
    """Changed channels of a record, as far as it has them."""
    return {name: change(values) for name in names if (values := getattr(record, name)) is not None}


def _filter_force(order: int) -> RunMutant:
    """The record states the filter of the case, but its force passed a zero-phase filter of another order."""

    def run(case: Case, record: Record) -> Outcome:
        low_pass = case.file.filter.model_copy(update={"order": order})
        forces = _change_channels(
            record, FORCE_CHANNELS, lambda rows: np.array([low_pass(x, record.rate) for x in rows])
        )
        return Delivered(replace(record, **forces, filter_applied_Hz=low_pass.cutoff_Hz))

    return run


def _filter_force_and_height(cutoff: float) -> RunMutant:
    """Force and contact height passed the same zero-phase filter, which the record does not state."""

    def run(case: Case, record: Record) -> Outcome:
        low_pass = case.file.filter.change_cutoff(cutoff)
        names = (*FORCE_CHANNELS, "contact_height")
        changes = _change_channels(record, names, lambda rows: np.array([low_pass(x, record.rate) for x in rows]))
        return Delivered(replace(record, **changes))

    return run


def _scale_force(factor: float) -> RunMutant:
    return lambda _, record: Delivered(
        replace(record, **_change_channels(record, FORCE_CHANNELS, lambda forces: factor * forces))
    )


def _delay_force(seconds: float, **changes: Any) -> RunMutant:
    """The force is late against all other channels; its last samples move to the start."""

    def run(case: Case, record: Record) -> Outcome:
        samples = round(seconds * record.rate)
        forces = _change_channels(record, FORCE_CHANNELS, lambda forces: np.roll(forces, samples, axis=1))
        return Delivered(replace(record, **forces, **changes))

    return run


def _coarsen_mesh(element: float) -> RunMutant:
    def run(case: Case, record: Record) -> Outcome:
        discretisation = case.file.discretisation.model_copy(update={"element_m": element})
        file = case.file.model_copy(update={"discretisation": discretisation})
        return ReferenceSimulator().run_unrefined(replace(case, file=file))

    return run


def _run_bilateral_droppers(case: Case, record: Record) -> Outcome:
    discretisation = case.file.discretisation
    line = make_droppers_bilateral(discretise(build_catenary(case.line), discretisation.element_m))
    passage = run_passage(case, line, discretisation)
    return Delivered(passage.record, compute_static_quantities(case, line), passage.run)


def _truncate_record(case: Case, record: Record) -> Outcome:
    """The record ends in the middle of the analysis section."""
    n = int(np.searchsorted(record.position[0], np.mean(case.analysis_section)))
    return Delivered(replace(record, **_change_channels(record, SAMPLE_CHANNELS, lambda values: values[..., :n])))


def _truncate_file(case: Case, record: Record) -> Outcome:
    """The second half of the table is missing; the sidecar is complete."""
    with tempfile.TemporaryDirectory(prefix="pantocheck-") as name:
        table = Path(name) / "record.csv"
        write_record(table, record, case.id)
        content = table.read_bytes()
        table.write_bytes(content[: content.rfind(b"\n", 0, len(content) // 2) + 1])
        return open_record_folder(Path(name)).run(case)


MUTANTS: tuple[Mutant, ...] = (
    Mutant(
        "gain 1.05",
        "The force is 5 % too large, as from a wrongly calibrated load cell.",
        _scale_force(1.05),
        "dynamics",
    ),
    Mutant(
        "unfiltered",
        "The record states the filter of the case, but its force is unfiltered.",
        _replace_channels(filter_applied_Hz=lambda case, _: case.file.filter.cutoff_Hz),
        "roll-off",
    ),
    Mutant("filter order 2", "The order of the filter is 2 instead of 6.", _filter_force(2), "roll-off"),
    Mutant("time shift", "The force lags the other channels by 0.1 s.", _delay_force(0.1), "dynamics"),
    Mutant(
        "position shift",
        "The positions are shifted by 10 m against all other channels.",
        _replace_channels(position=lambda _, record: record.position + 10.0),
        "support passing",
    ),
    Mutant("no slackening", "Droppers push as well as they pull.", _run_bilateral_droppers, "limits"),
    Mutant("units x1000", "The force is in millinewtons.", _scale_force(1000), "dynamics"),
    Mutant(
        "uplift in mm",
        "The uplift of the supports is in millimetres.",
        _replace_channels(support_uplift=lambda _, record: None if (u := record.support_uplift) is None else 1000 * u),
        "limits",
    ),
    Mutant("coarse mesh", "An element spans the distance between droppers.", _coarsen_mesh(8.0), "limits"),
    Mutant("truncated record", "The record ends in the middle of the analysis section.", _truncate_record, "coverage"),
    Mutant("truncated file", "The second half of the table of samples is missing.", _truncate_file, "record file"),
)
"""Mutants that must be detected."""

MILD: tuple[Mutant, ...] = (
    Mutant("gain 1.02", "The force is 2 % too large.", _scale_force(1.02), None),
    Mutant("filter order 4", "The order of the filter is 4 instead of 6.", _filter_force(4), None),
    Mutant(
        "filter at 10 Hz",
        "Force and contact height passed the same filter at 10 Hz, which is not stated.",
        _filter_force_and_height(10.0),
        None,
    ),
    Mutant("time shift 5 ms", "The force lags by 5 ms.", _delay_force(0.005), None),
    Mutant(
        "time shift, force alone",
        "The force lags by 0.1 s, and the record has no contact height.",
        _delay_force(0.1, contact_height=None),
        None,
    ),
    Mutant("mesh of 4 m", "Elements are 4 m long.", _coarsen_mesh(4.0), None),
)
"""Smaller faults, which show the limit of detection."""


# Run of the mutants: each is graded like any system, and once more by the limits of the case alone.
@dataclass(frozen=True)
class MutantResult:
    """Result of a mutant on a case."""

    mutant: Mutant
    case: str
    """Id of the case."""
    verdict: Verdict
    """Verdict of the whole suite."""
    by_limits: Verdict
    """Verdict of the limits of the case alone."""
    outside: tuple[str, ...]
    """Quantities outside their limits."""
    checks: tuple[str, ...]
    """Checks of the record that failed."""
    detected: bool
    """Whether the expected check detects the fault; true for a mild fault, which may remain undetected."""
    reason: str
    """Reason of the verdict in the report."""


@dataclass(frozen=True)
class SelfTest:
    """Results of the reference simulator and of the mutants."""

    reference: dict[str, tuple[Verdict, str]]
    """Verdict of the reference simulator on each case, with the reason if it did not pass."""
    severe: tuple[MutantResult, ...]
    """Mutants that must be detected."""
    mild: tuple[MutantResult, ...]
    """Mutants that may remain undetected."""
    numerical: tuple[NumericalResult, ...] = ()
    """Numerical faults with both verdicts."""

    @property
    def passed(self) -> bool:
        """Whether the reference simulator passes and every severe fault is detected as expected."""
        accepted = all(verdict == "pass" for verdict, _ in self.reference.values())
        detected = [*(result.detected for result in self.severe), *(result.detected for result in self.numerical)]
        return accepted and all(detected)


def run_self_test(cases: Sequence[Case], progress: Callable[[str], None]) -> SelfTest:
    """Run the reference simulator and all mutants on cases that it passes; `progress` receives the name of each first.

    Raises:
        RuntimeError: The reference simulator delivers no record of a case, so that there is nothing to mutate.
    """
    reference: dict[str, tuple[Verdict, str]] = {}
    records: dict[str, Record] = {}
    for case in cases:
        progress("reference simulator")
        outcome = ReferenceSimulator().run_unrefined(case)
        if not isinstance(outcome, Delivered) or outcome.record is None:
            raise RuntimeError(f"{case.id}: the reference simulator delivered no record")
        records[case.id] = outcome.record
        result = grade_case(case, outcome, TRUST)
        reference[case.id] = result.verdict, _reason(result)

    def run_mutants(mutants: Sequence[Mutant]) -> Iterator[MutantResult]:
        for mutant in mutants:
            progress(mutant.name)
            for case in cases:
                yield _run_mutant(mutant, case, records[case.id])

    return SelfTest(reference, tuple(run_mutants(MUTANTS)), tuple(run_mutants(MILD)))


def _run_mutant(mutant: Mutant, case: Case, record: Record) -> MutantResult:
    try:
        outcome = mutant.run(case, record)
    except InputError as error:  # a file that the suite refuses to read ends like a case with an error
        reason = f"{error.where}: {error.found}"
        detected = mutant.expected_check == "record file"
        return MutantResult(mutant, case.id, "error", "skip", (), ("record file",), detected, reason)
    evaluation = CaseEvaluation(case, outcome if isinstance(outcome, Delivered) else Delivered())
    result = grade_evaluation(evaluation, TRUST) if isinstance(outcome, Delivered) else grade_case(case, outcome, TRUST)
    criteria = evaluation.grade_limits(TRUST)
    outside = tuple(criterion.quantity for criterion in criteria if criterion.verdict == "fail")
    checks = tuple(name for name, finding in evaluation.findings.items() if finding.kind in ("doubt", "contradiction"))
    # After an error the limits are not applied.
    detecting = {*checks, "limits"} if outside and result.verdict != "error" else {*checks}
    return MutantResult(
        mutant,
        case.id,
        result.verdict,
        judge_case((criterion.verdict for criterion in criteria), None),
        outside,
        checks,
        mutant.expected_check is None or (result.verdict in {"fail", "error"} and mutant.expected_check in detecting),
        _reason(result),
    )


def _reason(result: CaseResult) -> str:
    failed = [f"{item.quantity} {item.reason}" for item in result.criteria if item.verdict == "fail"]
    # Every system gets the warning of the extended band.
    warnings = [warning for warning in result.warnings if not warning.startswith(WARNING_PREFIX)]
    return result.reason or "; ".join([*failed, *warnings])
