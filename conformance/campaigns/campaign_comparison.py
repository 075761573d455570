"""Comparison of two campaigns: differences of the values of runs with equal inputs."""

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from pantocheck.conformance.campaigns.campaign_columns import EvaluatedValue
from pantocheck.conformance.campaigns.campaign_store import CampaignStore
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.results.campaign_format import ValueComparison


@dataclass(frozen=True)
class RunPair:
    """Values of two runs with equal inputs."""

    place: str
    """Case and inputs in words."""
    here: dict[str, float]
    there: dict[str, float]
    """Quantities of this campaign and of the other one, by column."""


def pair_runs(store: CampaignStore, other: CampaignStore, values: Sequence[EvaluatedValue]) -> list[RunPair]:
    """Pair the runs of two campaigns that have the same case, inputs and system.

    The system does not count if the campaigns have no system in common: then their systems are compared.

    Args:
        store, other: Finished runs of both campaigns.
        values: Values that are kept.

    Raises:
        InputError: No run of one campaign has the inputs of a run of the other.
    """
    systems = [{row.run.system for row in each.rows()} for each in (store, other)]
    with_system = bool(systems[0] & systems[1])
    columns = [value.column for value in values]
    there = {key: quantities for key, _, quantities in _list_runs(other, with_system, columns)}
    pairs = [
        RunPair(place, quantities, there[key])
        for key, place, quantities in _list_runs(store, with_system, columns)
        if key in there
    ]
    if not pairs:
        hint = "Compare campaigns of the same cases with equal inputs."
        raise InputError("option --compare", "no run has the inputs of a run of the other campaign", hint)
    return pairs


def compare_values(pairs: Sequence[RunPair], values: Sequence[EvaluatedValue]) -> Iterator[ValueComparison]:
    """Differences of each value, this campaign minus the other one."""
    for value in values:
        common = [pair for pair in pairs if value.column in pair.here and value.column in pair.there]
        if common:
            difference = np.array([pair.here[value.column] - pair.there[value.column] for pair in common])
            largest = int(np.argmax(np.abs(difference)))
            yield ValueComparison(
                label=value.title,
                runs=len(common),
                mean=float(difference.mean()),
                rms=float(np.sqrt(np.mean(difference**2))),
                largest=float(difference[largest]),
                place=common[largest].place,
            )


def _list_runs(
    store: CampaignStore, with_system: bool, columns: Sequence[str]
) -> Iterator[tuple[str, str, dict[str, float]]]:
    """Key, place in words and some quantities of the runs that have a result."""
    for row in store.rows():
        if row.quantities:
            run = row.run
            key = json.dumps([run.case_id, run.system if with_system else None, run.inputs], sort_keys=True)
            place = ", ".join([run.case_id, *(f"{name} = {value}" for name, value in run.inputs.items())])
            yield key, place, {name: row.quantities[name] for name in columns if name in row.quantities}
