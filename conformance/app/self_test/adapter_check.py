"""Check of an adapter: short cases run on it, one of them on the reference simulator too, and gaps are named."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Literal

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.core.texts import DocumentationPage
from pantocheck.conformance.grading.case_grading import grade_case
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.sidecar_tables import StartTable
from pantocheck.conformance.results.case_facts_format import RecordFacts, RecordState
from pantocheck.conformance.results.results_format import CaseResult
from pantocheck.conformance.runs.derived_values import build_derived
from pantocheck.conformance.runs.reference_simulator import ReferenceSimulator
from pantocheck.conformance.runs.system import Delivered, Errored, Skipped, System

FindingState = Literal["ok", "missing", "wrong", "note"]


@dataclass(frozen=True)
class AdapterFinding:
    """One line of the check: its state, its subject, and a text with the next step."""

    state: FindingState
    subject: str
    text: str


# Cases of the adapter check: a short passage, the same with two pantographs, and its line at rest.
BASE_CASE = "en50318-2002/250"
"""Case of the library that is shortened: a level line in one plane, one pantograph, fixed uplift force."""

SHORT_SPANS = 5
"""Spans of the short line."""

SHORT_SECTION = (3, 4)
"""Spans of the analysis section, with one span before and one behind it."""

TWIN_SPACING_M = 20.0
"""Distance of two pantographs [m]: both start before the section, and the last one runs 10 m beyond it."""


def build_short_case() -> Case:
    """Case of a few seconds: the EN 50318:2002 line at 250 km/h on five spans."""
    (case,) = select_cases([BASE_CASE])
    file = case.file.model_copy(
        update={
            "id": "check-adapter/short",
            "title": f"{case.file.title}, shortened to {SHORT_SPANS} spans",
            "evaluated_spans": SHORT_SECTION,
            "compared_spans": None,
        }
    )
    line = case.line.model_copy(update={"geometry": case.line.geometry.shorten(SHORT_SPANS)})
    return replace(case, file=file, line=line)


def build_twin_case() -> Case:
    """Short case with a second pantograph of the same kind."""
    case = build_short_case()
    changes = {
        "id": "check-adapter/twin",
        "title": f"{case.file.title}, two pantographs {TWIN_SPACING_M:g} m apart",
        "pantograph": 2 * case.file.pantograph,
        "spacing_m": (TWIN_SPACING_M,),
    }
    return replace(case, file=case.file.model_copy(update=changes), pantographs=2 * case.pantographs)


def build_case_at_rest() -> Case:
    """Line of the short case without a train."""
    case = build_short_case().without_limits()
    changes = {
        "id": "check-adapter/at-rest",
        "title": f"{case.line.title}, at rest",
        "speed_km_h": None,
        "evaluated_spans": None,
        "pantograph": (),
    }
    return replace(case, file=case.file.model_copy(update=changes), pantographs=())


# Messages of a run that an adapter must answer beside those of one pantograph: the line at rest, two pantographs.
REST_SUBJECT, TWIN_SUBJECT = "line at rest", "two pantographs"
"""Subjects of the findings."""


def check_line_at_rest(system: System) -> AdapterFinding:
    """Send a check of the line at rest, and name the answer: values, a refusal or an error."""
    case = build_case_at_rest()
    outcome = system.run(case)
    if not isinstance(outcome, Delivered):
        return _describe_no_delivery(
            REST_SUBJECT,
            outcome,
            "Checks of the line at rest are skipped.",
            "In this message, speed_km_h and derived.train are null, and pantographs is empty. `run` sends it before "
            "cases that require it, and does not run them after an error. Answer with values in `static`, or 'skipped'",
        )
    result = grade_case(case, outcome, "secondary")
    if result.verdict == "error":
        return AdapterFinding("wrong", REST_SUBJECT, f"{result.reason}.")
    if not outcome.static:
        text = "'delivered' without a value. Put the quantities into `static`, or answer 'skipped'."
        return AdapterFinding("missing", REST_SUBJECT, text)
    return AdapterFinding("ok", REST_SUBJECT, f"values were delivered: {', '.join(sorted(outcome.static))}.")


def check_two_pantographs(system: System) -> AdapterFinding:
    """Send the short case with two pantographs, and name the answer: a record of both, a refusal or an error."""
    case = build_twin_case()
    outcome = system.run(case)
    if not isinstance(outcome, Delivered):
        return _describe_no_delivery(
            TWIN_SUBJECT,
            outcome,
            "Cases with several pantographs are skipped.",
            "Answer with a record of all pantographs, or 'skipped'",
        )
    if outcome.record is None:
        return AdapterFinding("missing", TWIN_SUBJECT, "'delivered' without a record. Write one, or answer 'skipped'.")
    result = grade_case(case, outcome, "secondary")
    if result.record is None:
        text = (
            f"{result.reason}. Write position, force and contact height of every pantograph, in running order, or "
            "answer 'skipped'."
        )
        return AdapterFinding("wrong", TWIN_SUBJECT, text)
    if result.record.state == "contradicted":
        return AdapterFinding("wrong", TWIN_SUBJECT, f"the record is contradicted: {result.record.reason}.")
    return AdapterFinding("ok", TWIN_SUBJECT, "a record of both pantographs was delivered.")


def _describe_no_delivery(subject: str, outcome: Skipped | Errored, consequence: str, remedy: str) -> AdapterFinding:
    """Finding on an answer without a delivery; a refusal is not a fault of the adapter."""
    if isinstance(outcome, Skipped):
        return AdapterFinding("note", subject, f"refused: {outcome.reason}. {consequence}")
    return AdapterFinding("wrong", subject, f"error: {outcome.reason}. {remedy}.")


# Delivery of the short case, beside that of the reference simulator.
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
        yield AdapterFinding("ok", "start", "the sidecar states the start of the case.")
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
    states: dict[RecordState, FindingState] = {"consistent": "ok", "unconfirmed": "missing", "contradicted": "wrong"}
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


# Zeros of the position and of the contact height of a record, against those of its case.
PLACE_TOLERANCE_M = 1.0
"""Distance by which a first sample may lie before the start [m]: a rounded place, or one step of a slow record."""

HEIGHT_TOLERANCE_M = 0.1
"""Difference of heights at the start that needs no other zero [m].

The contact height of the short case varies by 0.05 m. Usual other zeros, the rail and the messenger wire, are more than
1 m away."""


def describe_other_position(case: Case, record: Record, stated: StartTable | None) -> str | None:
    """Text on positions that begin before the start of the record, by default that of its case; None if they do not."""
    first, place = float(record.position[-1, 0]), (stated or case.start_table).place_m
    if first >= place - PLACE_TOLERANCE_M:
        return None
    source = "the start of the case is" if stated is None else "[start] states"
    return (
        f"the first sample of the last pantograph is at {first:.4g} m, but {source} {place:g} m. Count positions from "
        "x = 0 of the line, its first anchor, and not from the start of the run."
    )


def describe_other_height(case: Case, record: Record) -> str | None:
    """Text on a contact height with another zero than that of the case; None for the same zero or without a height."""
    train = build_derived(case).train
    if record.contact_height is None or train is None:
        return None
    first, expected = float(record.contact_height[0, 0]), train.pantographs[0].start_wire_height_m
    if abs(first - expected) <= HEIGHT_TOLERANCE_M:
        return None
    return (
        f"the contact height begins at {first:.4g} m, the case starts with {expected:.3g} m (start_wire_height_m): "
        "its zero differs, or its unit. Another zero changes no verdict: the range and the checks use changes of the "
        "height alone. A comparison of heights needs the zero of the case."
    )
