"""Kinds of forged results that raise statements: state of the record, origin, remarks, date and probability."""

import copy
import random

from pantocheck.conformance.results.results_format import Results
from verification.attacks.consistent_results import Tree, case_of, regrade
from verification.attacks.forged_results import CHANGES, Change, failing, of_case, of_results

CONFIRMED = "every consistency check that applies confirms the record"
"""Reason of a consistent record."""


def raise_state(results: Tree, _: random.Random) -> None:
    """State the record as consistent; its checks still say something else."""
    case_of(results)["record"].update(state="consistent", reason=CONFIRMED)
    regrade(results)


def raise_state_and_checks(results: Tree, _: random.Random) -> None:
    """The same, and every check as confirmed; notes and warnings still name those that were not."""
    for row in case_of(results)["record"]["checks"]:
        row.update(outcome="confirmed", text="")
    raise_state(results, _)


def hide_doubts(results: Tree, _: random.Random) -> None:
    """The same, and the notes and warnings of the checks are removed, too: the record is said to have been checked."""
    case, texts = case_of(results), {row["text"] for row in case_of(results)["record"]["checks"] if row["text"]}
    for key in ("notes", "warnings"):
        case[key] = [text for text in case[key] if text not in texts]
    raise_state_and_checks(results, _)


def accept_unconfirmed(results: Tree, _: random.Random) -> None:
    """Accept the unconfirmed records of the system by its name."""
    results["accepted_unconfirmed"] = [results["system"]["name"]]
    regrade(results)


def repeat_case(results: Tree, _: random.Random) -> None:
    """List a case twice."""
    results["cases"].append(copy.deepcopy(case_of(results)))
    regrade(results)


def raise_probability(results: Tree, _: random.Random) -> None:
    """State the conformity of every value as certain."""
    for row in case_of(results)["criteria"]:
        row["conformity"] = 1.0
    case_of(results)["conformity"] = {"probability": 1.0, "starts": 7, "passing_starts": 7}
    results["conformity"] = 1.0


STATE_CHANGES: dict[str, Change] = {
    "state of the record raised": raise_state,
    "state and checks raised": raise_state_and_checks,
    "state, checks and remarks raised": hide_doubts,
    "unconfirmed records accepted": accept_unconfirmed,
}
"""Kinds of forged results of an unconfirmed record, by name."""

EVERY_CHANGE: dict[str, Change] = (
    CHANGES
    | STATE_CHANGES
    | {
        "case repeated": repeat_case,
        "note added": lambda r, _: case_of(r)["notes"].append("Verified by an independent assessor."),
        "start in the future": of_results(started="2099-01-01T00:00:00Z"),
        "probability raised": raise_probability,
        "decision rule": of_results(decision="guarded"),
        "trust of the limits raised": lambda r, _: [row.update(trust="primary") for row in case_of(r)["criteria"]],
        "place of a criterion": lambda r, _: case_of(r)["criteria"][0].update(where={"record": "A"}),
        "reason of a criterion": lambda r, _: [row.update(reason=None) for row in failing(r)],
        "second formulation": lambda r, _: case_of(r)["verification"].update(confirmed_by="a measured line"),
        "source of the verification": lambda r, _: [
            row.update(source="a measured line") for row in case_of(r)["verification"]["criteria"]
        ],
        "weakened limit stated": of_case(limit_changes=["mean force: the limit is stricter"]),
        "digest of the limits alone": of_case(limits_digest="sha256:" + "0" * 64),
    }
)
"""All kinds of forged results by name."""


def forge_results(results: Tree, name: str, seed: int) -> Tree:
    """Results with one kind of forgery."""
    forged = copy.deepcopy(results)
    EVERY_CHANGE[name](forged, random.Random(f"{seed} {name}"))
    return Results.model_validate(forged).to_dict()
