"""Kinds of forged results: each changes the results of a run that fails, as a forger of a results.json would.

After `regrade`, verdicts, margins and remarks follow from the changed numbers: the forger knows the suite.
"""

import copy
import random
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
from pantocheck.conformance.grading.case_identity import describe_limit_change
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
Change = Callable[[Tree, random.Random], object]


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


def failing(results: Tree) -> list[Tree]:
    """Criteria that fail."""
    return [row for case in results["cases"] for row in case["criteria"] if row["verdict"] == "fail"]


def case_of(results: Tree) -> Tree:
    """The first case."""
    case: Tree = results["cases"][0]
    return case


def inside(row: Tree) -> float:
    """Value inside the limits of a criterion."""
    lower, upper = row["lower"], row["upper"]
    return float((lower + upper) / 2 if lower is not None and upper is not None else upper or lower)


def set_value(results: Tree, row: Tree, value: float) -> None:
    """Change a quantity, and the criterion and the verification criterion that grade it."""
    case = case_of(results)
    case["quantities"][str(row["pantograph"])][row["quantity"]] = value
    rows = [*case["criteria"], *((case["verification"] or {}).get("criteria") or [])]
    for other in rows:
        if (other["quantity"], other["pantograph"]) == (row["quantity"], row["pantograph"]):
            other["value"] = value


def improve_values(results: Tree, _: random.Random) -> None:
    """Put every failing value inside its limits."""
    for row in failing(results):
        set_value(results, row, inside(row))
    regrade(results)


def widen_limits(results: Tree, _: random.Random) -> None:
    """Move the limits so that no criterion fails."""
    for row in failing(results):
        for key, bound in (("lower", min), ("upper", max)):
            row[key] = None if row[key] is None else bound(row[key], row["value"])
    regrade(results)


def widen_with_digest(results: Tree, chance: random.Random) -> None:
    """The same with another digest of the limits, as a limits file would give."""
    widen_limits(results, chance)
    case_of(results)["limits_digest"] = f"sha256:{chance.randbytes(32).hex()}"


def state_widened_limits(results: Tree, chance: random.Random) -> None:
    """The same, and the change of the limits is stated as for a limits file of a user."""
    case, names = (
        load_case(list_library(library_folder())[case_of(results)["id"]]),
        {r["quantity"] for r in failing(results)},
    )
    widen_with_digest(results, chance)
    bounds = {row["quantity"]: {"lower": row["lower"], "upper": row["upper"]} for row in case_of(results)["criteria"]}
    changes = (
        describe_limit_change(limit, limit.model_copy(update=bounds[limit.quantity]))
        for limit in case.limits
        if limit.quantity in names
    )
    case_of(results)["limit_changes"] = [change for change in changes if change is not None]


def remove_failing(results: Tree, _: random.Random) -> None:
    """Delete the failing criteria."""
    case_of(results)["criteria"] = [row for row in case_of(results)["criteria"] if row["verdict"] != "fail"]
    regrade(results)


def keep_one_criterion(results: Tree, chance: random.Random) -> None:
    """Delete all criteria but one that passes."""
    passing = [row for row in case_of(results)["criteria"] if row["verdict"] == "pass"]
    case_of(results)["criteria"] = [chance.choice(passing)]
    regrade(results)


def demote(results: Tree, _: random.Random) -> None:
    """Give the failing criteria a trust that does not count."""
    for row in failing(results):
        row["trust"] = "provisional"
    regrade(results)


def raise_trust_of_run(results: Tree, _: random.Random) -> None:
    """Let no limit count."""
    results["trust"] = "primary"
    regrade(results)


def shift_verdicts(results: Tree, _: random.Random) -> None:
    """Change the words of the verdicts alone."""
    for row in failing(results):
        row["verdict"] = "pass"
    case_of(results).update(verdict="pass", criteria_verdict="pass")
    results.update(verdict="pass", criteria_verdict="pass")


def shrink_uncertainty(results: Tree, _: random.Random) -> None:
    """Divide every uncertainty by ten."""
    case = case_of(results)
    shrink(case["uncertainty"])
    shrink(case["uncertainty_components"])
    for row in [*case["criteria"], *((case["verification"] or {}).get("criteria") or [])]:
        shrink(row["components"])
        row["draws"] = [row["value"] + (draw - row["value"]) / 10 for draw in row.get("draws", ())]
    regrade(results)
    adopt_widths(case_of(results))


def adopt_widths(case: Tree) -> None:
    """State the uncertainty of every criterion among those of the quantities."""
    for row in case["criteria"]:
        if row["uncertainty"] is not None:
            case["uncertainty"][str(row["pantograph"])][row["quantity"]] = row["uncertainty"]


def shrink(tree: Any) -> None:
    """Divide all numbers of nested dictionaries and lists by ten."""
    for key, value in tree.items() if isinstance(tree, dict) else enumerate(tree):
        if isinstance(value, dict | list):
            shrink(value)
        else:
            tree[key] = value / 10


def strip_uncertainty(results: Tree, _: random.Random) -> None:
    """Remove the uncertainty."""
    case = case_of(results)
    case.update(uncertainty={}, uncertainty_components={}, uncertainty_basis={})
    for row in [*case["criteria"], *((case["verification"] or {}).get("criteria") or [])]:
        row.update(components={}, uncertainty=None, draws=[])
    regrade(results)


def deny_uncertainty(results: Tree, chance: random.Random) -> None:
    """Remove the uncertainty, and state that it is not known."""
    names = list(case_of(results)["uncertainty_basis"])
    strip_uncertainty(results, chance)
    case_of(results)["uncertainty_basis"] = dict.fromkeys(names, "not known: the record holds one run")


def flatten_curves(results: Tree, _: random.Random) -> None:
    """Draw the mean in place of the force."""
    for trace in case_of(results)["traces"].values():
        for key in ("force_N", "force_20_N"):
            trace[key] = [trace["mean_N"]] * len(trace[key])


def damp_curves(results: Tree, _: random.Random) -> None:
    """Draw the force with half of its dynamic part."""
    for trace in case_of(results)["traces"].values():
        trace["force_20_N"] = [trace["mean_N"] + (x - trace["mean_N"]) / 2 for x in trace["force_20_N"]]


def thin_spectrum(results: Tree, _: random.Random) -> None:
    """Remove lines of the spectrum, so that the bands cannot be computed from it."""
    for trace in case_of(results)["traces"].values():
        for key, values in trace["spectrum"].items():
            trace["spectrum"][key] = values[:10] + values[11:]
    case_of(results)["quantities"]["1"]["rms_20_50_N"] /= 2


def lower_uplift(results: Tree, _: random.Random) -> None:
    """Lower the uplift and the criterion that grades it."""
    for row in case_of(results)["criteria"]:
        if row["quantity"] == "max_uplift_at_support_mm":
            set_value(results, row, 0.9 * row["value"])
            break
    regrade(results)


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


def invent(results: Tree, chance: random.Random) -> None:
    """Scale every force, so that all numbers stay consistent."""
    factor = 1 - 1e-3 * chance.random()
    case = case_of(results)
    for number in case["signals"]["pantographs"]:
        change_signal(case["signals"], ("pantographs", number, "force_N"), lambda force: factor * force)
    follow_signals(case)
    regrade(results)
    adopt_widths(case_of(results))


def of_case(**changes: Any) -> Change:
    """Change of keys of the first case."""
    return lambda results, _: case_of(results).update(copy.deepcopy(changes))


def of_run(**changes: Any) -> Change:
    """Change of keys of the run of the first case."""
    return lambda results, _: case_of(results)["run"].update(copy.deepcopy(changes))


def of_results(**changes: Any) -> Change:
    """Change of keys of the results."""
    return lambda results, _: results.update(copy.deepcopy(changes))


def inform_only(results: Tree, _: random.Random) -> None:
    """Show the case for information, so that it does not count."""
    results["information"] = [case_of(results)["id"]]
    regrade(results)


def invent_steps(results: Tree, _: random.Random) -> None:
    """State more steps of the procedure."""
    case_of(results)["steps"] = ["pantograph_model", "static_check", "reference_models", "line_test"]
    regrade(results)


def improve_scope(results: Tree, _: random.Random) -> None:
    """State every step of the procedure as done."""
    for step in results["scope"]:
        step["state"] = "done"


def raise_input_trust(results: Tree, _: random.Random) -> None:
    """State every input as read in the document that defines it."""
    for group in case_of(results)["inputs"]:
        group.update(trust="primary", source="EN 50318:2002")


def widen_verification(results: Tree, _: random.Random) -> None:
    """Move the verification limits so that no criterion fails."""
    for row in case_of(results)["verification"]["criteria"]:
        row["lower"], row["upper"] = row["value"] - 1.0, row["value"] + 1.0
    regrade(results)


CHANGES: dict[str, Change] = {
    "words of the verdicts": shift_verdicts,
    "verdict of the run alone": of_results(verdict="pass"),
    "value of a failing criterion": lambda r, _: [row.update(value=inside(row)) for row in failing(r)],
    "margin of a failing criterion": lambda r, _: [row.update(margin=0.5) for row in failing(r)],
    "failing quantities, regraded": improve_values,
    "limits widened, regraded": widen_limits,
    "limits widened, other digest": widen_with_digest,
    "limits widened and stated": state_widened_limits,
    "failing criteria deleted": remove_failing,
    "one criterion left": keep_one_criterion,
    "failing criteria without trust": demote,
    "trust of the run": raise_trust_of_run,
    "case for information": inform_only,
    "verification deleted": of_case(verification=None),
    "verification limits widened": widen_verification,
    "uncertainty divided by ten": shrink_uncertainty,
    "uncertainty deleted": strip_uncertainty,
    "uncertainty stated as not known": deny_uncertainty,
    "remarks on close limits deleted": lambda r, _: [row.update(close=[]) for row in case_of(r)["criteria"]],
    "curves deleted": of_case(traces={}),
    "curves of the uplift deleted": of_case(uplift=[]),
    "signals deleted": lambda r, _: case_of(r).pop("signals"),
    "curves flattened": flatten_curves,
    "20 Hz curve damped": damp_curves,
    "20 Hz curve deleted": lambda r, _: [t.update(force_20_N=None) for t in case_of(r)["traces"].values()],
    "histogram deleted": lambda r, _: [t.update(histogram=None) for t in case_of(r)["traces"].values()],
    "spectrum thinned, band halved": thin_spectrum,
    "uplift lowered, regraded": lower_uplift,
    "warnings deleted": of_case(warnings=[]),
    "notes deleted": of_case(notes=[]),
    "state of the record deleted": of_case(record=None),
    "name of the system": lambda r, _: r["system"].update(name="Vendor simulator"),
    "version of the system": lambda r, _: r["system"].update(version="9.0"),
    "digest of the suite": lambda r, c: r["suite"].update(digest=f"sha256:{c.randbytes(32).hex()}"),
    "version of the suite": lambda r, _: r["suite"].update(version="9.9.9"),
    "software of the pages": lambda r, _: r["renderer"].update(matplotlib="3.0.0"),
    "nature of the report": of_results(statement="certificate of a notified body"),
    "digest of the inputs": of_case(input_digest="sha256:" + "0" * 64),
    "id of the case": of_case(id="en50318-2002/300"),
    "title of the case": of_case(title="EN 50318:2018 reference model"),
    "speed": of_run(speed_km_h=300.0),
    "filter": lambda r, _: case_of(r)["run"]["filter"].update(cutoff_Hz=10.0),
    "analysis section": of_run(evaluated_m=(0.0, 1000.0)),
    "edition": of_case(edition="EN 50318:2018", superseded_by=None),
    "steps of the procedure": invent_steps,
    "state of the procedure": improve_scope,
    "origin as own case": of_case(library="own"),
    "origin as modified copy": of_case(library="modified"),
    "trust and source of the inputs": raise_input_trust,
    "source of a limit": lambda r, _: [row.update(source="EN 50318:2018") for row in case_of(r)["criteria"]],
    "unit of a quantity": lambda r, _: [row.update(unit="kN") for row in case_of(r)["criteria"][:1]],
    "definition of skipped quantities": of_case(skipped={"1": {"rms_20_50_N": "not needed"}}),
    "time step and element length": of_run(dt_s=1e-5, element_m=0.01),
    "time of the run": of_results(started="2020-01-01T00:00:00Z"),
    "administrative data": of_results(administration={"issuer": "Notified body", "report_number": "1"}),
    "all forces scaled, regraded": invent,
}
"""Kinds of forged results by name, without those of `raised_statements.py`."""
