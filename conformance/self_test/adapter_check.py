"""Check of an adapter: short cases run on it, one of them on the reference simulator too, and gaps are named."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.grading.case_grading import grade_case
from pantocheck.conformance.input_files.documentation_pages import DocumentationPage
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.results.outcome import Delivered, Errored, Skipped
from pantocheck.conformance.results.record_facts import RecordFacts, RecordState
from pantocheck.conformance.results.results_format import CaseResult
from pantocheck.conformance.self_test.adapter_cases import build_short_case
from pantocheck.conformance.self_test.adapter_finding import AdapterFinding, FindingState
from pantocheck.conformance.self_test.further_messages import check_line_at_rest, check_two_pantographs
from pantocheck.conformance.self_test.record_zeros import describe_other_height, describe_other_position
from pantocheck.conformance.systems.reference_simulator import ReferenceSimulator
from pantocheck.conformance.systems.system import System

USUAL_DIFFERENCE = 0.1
"""Relative difference from the reference simulator that needs no explanation: the string example differs by less."""

UNIT_FACTORS = (1e-3, 1e-2, 1e-1, 1e1, 1e2, 1e3)
"""Ratios of two values by which a wrong unit is recognised: N and kN, m and mm, cm, dm."""

UNIT_TOLERANCE = 0.3
"""Relative tolerance of such a ratio: different simulators differ by less, different units by more."""

ADAPTER_QUANTITIES = (
    "mean_force_N",
    "std_force_N",
    "rms_20_50_N",
    "contact_height_range_mm",
    "max_uplift_at_support_mm",
)
"""Quantities that are compared with the reference simulator."""


@dataclass(frozen=True)
class AdapterValue:
    """Quantity of the adapter beside that of the reference simulator."""

    name: str
    value: float
    reference: float

    @property
    def difference(self) -> float:
        """Difference relative to the reference simulator."""
        return (self.value - self.reference) / abs(self.reference) if self.reference else 0.0


@dataclass(frozen=True)
class AdapterCheck:
    """Findings of the check, and the compared values."""

    findings: tuple[AdapterFinding, ...]
    values: tuple[AdapterValue, ...] = ()

    @property
    def passed(self) -> bool:
        """Whether nothing is missing or wrong."""
        return all(finding.state in ("ok", "note") for finding in self.findings)


def check_adapter(system: System) -> AdapterCheck:
    """Run short cases on an adapter and list all that is missing or wrong.

    The line at rest and two pantographs follow a short case that ended without an error.

    Args:
        system: The adapter.
    """
    case, simulator = build_short_case(), ReferenceSimulator()
    outcome = system.run(case)
    if isinstance(outcome, Errored):
        return AdapterCheck((AdapterFinding("wrong", "short case", outcome.reason),))
    further = (check_line_at_rest(system), check_two_pantographs(system))
    if isinstance(outcome, Skipped):
        return AdapterCheck((AdapterFinding("missing", "short case", outcome.reason), *further))
    check = _check_delivery(case, outcome, simulator)
    return replace(check, findings=(*check.findings, *further))


def _check_delivery(case: Case, delivered: Delivered, simulator: ReferenceSimulator) -> AdapterCheck:
    if delivered.record is None:
        text = "'delivered' without a record. Write a table of samples and a sidecar, and name both in the answer."
        return AdapterCheck((AdapterFinding("missing", "record", text),))
    result = grade_case(case, delivered, "secondary")
    if result.record is None:
        return AdapterCheck((AdapterFinding("wrong", "record", result.reason or "it cannot be graded"),))
    reference = grade_case(case, simulator.run_unrefined(case), "secondary")
    values = tuple(_compare(result, reference))
    findings = (
        AdapterFinding("ok", "short case", "a record was delivered, and its files have the stated digests."),
        *_check_statements(case, delivered, result.record),
        *_check_zeros(case, delivered, delivered.record),
        *_check_channels(result, reference),
        *_check_units(values),
        *_check_state(result.record),
        *_check_values(values),
    )
    return AdapterCheck(findings, values)


def _check_statements(case: Case, delivered: Delivered, record: RecordFacts) -> Iterator[AdapterFinding]:
    """Statements of the sidecar that no channel can replace."""
    if delivered.case_digest is None:
        text = "the sidecar has no case_digest. Copy it from the case: it shows that the record is of this version."
        yield AdapterFinding("missing", "case digest", text)
    if delivered.start is None:
        start = case.start_table
        text = (
            "the sidecar has no table [start]. State place_m, ramp_m and state of your simulation. The case has "
            f'place_m = {start.place_m:g}, ramp_m = {start.ramp_m:g}, state = "{start.state}".'
        )
        yield AdapterFinding("missing", "start", text)
    elif record.start == "differs":
        yield AdapterFinding("note", "start", record.start_text or "differs from that of the case.")
    else:
        yield AdapterFinding("ok", "start", "stated, as in the case.")
    unknown = [key for key in ("dt_s", "element_m") if getattr(delivered.run, key) is None]
    if unknown:
        yield AdapterFinding("note", "run", f"the sidecar has no {' and '.join(unknown)} in [run]; reports print them.")


def _check_zeros(case: Case, delivered: Delivered, record: Record) -> Iterator[AdapterFinding]:
    """Zeros of position and height: another one of the height changes no verdict."""
    if (text := describe_other_position(case, record, delivered.start)) is not None:
        yield AdapterFinding("wrong", "position", text)
    if (text := describe_other_height(case, record)) is not None:
        yield AdapterFinding("note", "height", text)


def _check_channels(result: CaseResult, reference: CaseResult) -> Iterator[AdapterFinding]:
    """Quantities that the reference simulator has and the adapter lacks, by their reason."""
    lacking: dict[str, list[str]] = {}
    for owner, quantities in reference.quantities.items():
        for name in quantities.keys() - result.quantities.get(owner, {}).keys():
            reason = result.skipped.get(owner, {}).get(name)
            if reason is not None:
                lacking.setdefault(reason, []).append(name)
    for reason, names in sorted(lacking.items()):
        yield AdapterFinding("missing", "channels", f"{reason}. Criteria on {', '.join(sorted(names))} are skipped.")
    if not lacking:
        yield AdapterFinding("ok", "channels", "force, height and uplift allow every quantity up to 50 Hz.")


def _compare(result: CaseResult, reference: CaseResult) -> Iterator[AdapterValue]:
    for owner in ("1", "0"):
        for name in ADAPTER_QUANTITIES:
            value, other = (one.quantities.get(owner, {}).get(name) for one in (result, reference))
            if isinstance(value, float) and isinstance(other, float):
                yield AdapterValue(name, value, other)


def _check_units(values: tuple[AdapterValue, ...]) -> Iterator[AdapterFinding]:
    """Values that differ from the reference simulator by the factor of a unit."""
    for value in values:
        ratio = value.value / value.reference if value.reference else 0.0
        factor = next((f for f in UNIT_FACTORS if abs(ratio / f - 1) < UNIT_TOLERANCE), None)
        if factor is not None:
            text = (
                f"{value.name} is {factor:g} times that of the reference simulator. Check the unit in the column name."
            )
            yield AdapterFinding("wrong", "units", text)


def _check_state(record: RecordFacts) -> Iterator[AdapterFinding]:
    """Consistency checks of the record."""
    states: dict[RecordState, FindingState] = {"verified": "ok", "unverified": "missing", "contradicted": "wrong"}
    yield AdapterFinding(states[record.state], "record", f"{record.state}: {record.reason}.")


def _check_values(values: tuple[AdapterValue, ...]) -> Iterator[AdapterFinding]:
    """Large differences from the reference simulator, which need an explanation but no correction."""
    far = [value.name for value in values if abs(value.difference) > USUAL_DIFFERENCE]
    if far:
        text = (
            f"more than {USUAL_DIFFERENCE:.0%} from the reference simulator: {', '.join(far)}. Compare the conventions "
            f"in {DocumentationPage.SYSTEMS}: start, zero of heights, working height of the pantograph, filter."
        )
        yield AdapterFinding("note", "values", text)
