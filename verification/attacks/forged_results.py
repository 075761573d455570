"""Kinds of forged results: each changes the results of a run that fails, as a forger of a results.json would.

After `regrade`, verdicts, margins and remarks follow from the changed numbers: the forger knows the suite.
"""

import copy
import random
from collections.abc import Callable
from typing import Any

from pantocheck.conformance.cases.library import list_library, load_case
from pantocheck.conformance.grading.case_identity import describe_limit_change
from pantocheck.conformance.line.library_folder import library_folder
from verification.attacks.consistent_results import Tree, adopt_widths, case_of, change_signal, follow_signals, regrade

Change = Callable[[Tree, random.Random], object]


def failing(results: Tree) -> list[Tree]:
    """Criteria that fail."""
    return [row for case in results["cases"] for row in case["criteria"] if row["verdict"] == "fail"]


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
