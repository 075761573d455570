"""What follows from changed results: grades, values, curves and checks, made again as a forger with the suite can."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from pantocheck.conformance.cases.library import list_library, load_case
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.criterion import COMPONENT_NAMES, Criterion
from pantocheck.conformance.core.near_limit import ValueErrors
from pantocheck.conformance.core.packed_samples import PackedSamples, SignalSamples, pack_samples
from pantocheck.conformance.core.trust import Computed, Trust
from pantocheck.conformance.documents.recomputation import list_unknown_components
from pantocheck.conformance.documents.row_check import list_repeated, repeat_check
from pantocheck.conformance.documents.statement_check import extract_requirement
from pantocheck.conformance.grading.case_conformity import find_case_conformity
from pantocheck.conformance.grading.case_verdict import judge_case, read_participation
from pantocheck.conformance.grading.contact_loss_list import find_force_places, find_uplift_place
from pantocheck.conformance.grading.criterion_grading import build_criterion
from pantocheck.conformance.grading.results_building import key_by_owner, select_finite
from pantocheck.conformance.grading.start_agreement import list_verification_components
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.quantities.filters import Filter
from pantocheck.conformance.records.evaluated_signals import unpack_signals
from pantocheck.conformance.records.traces import build_pantograph_traces, round_series
from pantocheck.conformance.results.case_facts_format import ReadingFacts, RecordFacts
from pantocheck.conformance.results.results_format import CaseResult, Results
from pantocheck.conformance.results.scope import build_scope
from pantocheck.conformance.runs.record_checks import judge_record_state

Tree = dict[str, Any]


def regrade(results: Tree) -> None:
    """Make verdicts, margins and remarks follow from the numbers, as the suite would."""
    for case in results["cases"]:
        record = None if case["record"] is None else RecordFacts.model_validate(case["record"])
        stated = CaseResult.model_validate(case)
        for row in case["criteria"]:
            regrade_row(stated, row, results["trust"])
        rows = [Criterion.model_validate(row) for row in case["criteria"]]
        starts = case["conformity"] or {"starts": 0, "passing_starts": 0}
        readings = [ReadingFacts.model_validate(reading) for reading in case.get("readings", [])]
        found = find_case_conformity(rows, (starts["starts"], starts["passing_starts"]), readings)
        case["conformity"] = None if found is None else found.model_dump()
        case["criteria_verdict"] = judge_case((row["verdict"] for row in case["criteria"]), record)
        if case["verification"] is not None and case["verification"]["criteria"]:
            for row in case["verification"]["criteria"]:
                regrade_row(stated, row, "computed")
            verdicts = (row["verdict"] for row in case["verification"]["criteria"])
            case["verification"]["verdict"] = judge_case(verdicts, record)
    stated = Results.model_validate(results)
    decided = read_participation(stated).decide_run(stated)
    results.update(decided.model_copy(update={"scope": build_scope(decided.cases)}).to_dict())


def regrade_row(case: CaseResult, row: Tree, trust: Trust | Computed) -> None:
    """Grade one criterion of a case again."""
    stated = Criterion.model_validate(row)
    start = None if case.record is None else case.record.start
    unknown = list_unknown_components(
        case, stated, list_verification_components(start) if trust == "computed" else COMPONENT_NAMES
    )
    missing = stated.reason if stated.value is None else None
    errors = ValueErrors(
        *(stated.discretisation_error, stated.spread, stated.components, stated.limit_uncertainty),
        *(tuple(stated.draws), unknown),
    )
    again = build_criterion(extract_requirement(stated), stated.value, missing, trust, errors, doubt=stated.doubt)
    row.update(again.model_copy(update={"readings": stated.readings}).model_dump(mode="json"))


def case_of(results: Tree) -> Tree:
    """The first case."""
    case: Tree = results["cases"][0]
    return case


def adopt_widths(case: Tree) -> None:
    """State the uncertainty of every criterion among those of the quantities."""
    for row in case["criteria"]:
        if row["uncertainty"] is not None:
            case["uncertainty"][str(row["pantograph"])][row["quantity"]] = row["uncertainty"]


def change_signal(signals: Tree, path: Sequence[str | int], change: Callable[[RealArray], RealArray]) -> None:
    """Change the samples of one embedded signal, at a path of keys."""
    *parents, key = path
    for parent in parents:
        signals = signals[parent]
    signals[key] = pack_samples(change(PackedSamples.model_validate(signals[key]).unpack())).model_dump()


def follow_signals(case: Tree) -> None:
    """Make quantities, readings, curves and places that follow from the embedded signals again."""
    samples = SignalSamples.model_validate(case["signals"])
    signals = unpack_signals(samples, Filter.model_validate(case["run"]["filter"]))
    for owner, values in key_by_owner(select_finite(signals.evaluation.values)).items():
        case["quantities"][owner].update(values)
    for row in [*case["criteria"], *((case["verification"] or {}).get("criteria") or [])]:
        value = case["quantities"].get(str(row["pantograph"]), {}).get(row["quantity"])
        if value is not None and row["value"] is not None:
            row["draws"] = [draw + value - row["value"] for draw in row.get("draws", ())]
            row["value"] = value
    for reading in case.get("readings", []):
        if reading["reason"] is None:
            stated = ReadingFacts.model_validate(reading)
            again = unpack_signals(samples, stated.filter, stated.evaluated_m)
            for owner, values in key_by_owner(select_finite(again.evaluation.values)).items():
                reading["quantities"][owner].update(values)
    supports = [support for trace in case["traces"].values() for support in trace["supports_m"]]
    traces = build_pantograph_traces(signals.pantographs, sorted(set(supports)))
    case["traces"] = {key: trace.model_dump(mode="json") for key, trace in traces.items()}
    extremes = find_force_places(signals.pantographs)
    if signals.time is not None:
        extremes |= find_uplift_place(signals.line, signals.time)
        for curve, row in zip(case["uplift"], signals.line.uplift, strict=True):
            indices = np.rint((np.array(curve["time_s"]) - signals.time[0]) * samples.rate_Hz).astype(int)
            curve["uplift_mm"] = round_series(1e3 * row[np.clip(indices, 0, row.size - 1)])
    for key, places in extremes.items():
        case["places"][key].update({name: place.model_dump(mode="json") for name, place in places.items()})


def follow_checks(case: Tree) -> None:
    """Make the rows of the consistency checks and the state of the record follow from the embedded signals."""
    made = load_case(list_library(library_folder())[case["id"]])
    signals = unpack_signals(SignalSamples.model_validate(case["signals"]), made.file.filter)
    repeated = {check.name: check for check in list_repeated(made)}
    for row in case["record"]["checks"]:
        if row["check"] in repeated:
            finding = repeat_check(repeated[row["check"]], made, signals)
            row.update(outcome=finding.kind, text=finding.text, basis=finding.basis.model_dump(mode="json"))
    rows = RecordFacts.model_validate(case["record"]).checks
    case["record"]["state"], case["record"]["reason"] = judge_record_state(rows)
