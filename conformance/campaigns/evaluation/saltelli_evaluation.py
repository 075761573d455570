"""Evaluation of the designs of Saltelli (2010): Sobol indices, and the independent designs among them."""

from collections.abc import Iterator, Sequence

import numpy as np

from pantocheck.conformance.array_types import IntegerArray
from pantocheck.conformance.campaigns.design_axes import SampleAxis
from pantocheck.conformance.campaigns.evaluation.campaign_columns import CampaignColumns, EvaluatedValue
from pantocheck.conformance.campaigns.evaluation.sobol_indices import estimate_sobol_indices
from pantocheck.conformance.results.campaign_format import Estimate, InputShare, SobolIndices

FEWEST_DESIGNS = 8
"""Fewest complete designs from which indices are estimated."""


def select_independent(columns: CampaignColumns, axis: SampleAxis) -> CampaignColumns:
    """Runs of the sets A and B, whose inputs are independent; the other sets repeat their inputs."""
    return columns.select(np.flatnonzero(_place(columns, axis)[1] < 2))


def build_indices(
    columns: CampaignColumns, values: Sequence[EvaluatedValue], grid_keys: Sequence[str], axis: SampleAxis
) -> Iterator[SobolIndices]:
    """Sobol indices of each value at each point of the grid, over the designs whose runs are all finished."""
    for name, numbers in columns.group(grid_keys).items():
        design, kind = (parts[numbers] for parts in _place(columns, axis))
        for value in values:
            table = np.full((axis.sampling.runs, len(axis.keys) + 2), np.nan)
            table[design, kind] = columns.values[value.column][numbers]
            complete = table[~np.isnan(table).any(axis=1)]
            if len(complete) < FEWEST_DESIGNS or np.ptp(complete) == 0:
                continue
            shares = estimate_sobol_indices(complete[:, 0], complete[:, 1], complete[:, 2:])
            yield SobolIndices(
                label=value.title,
                group=name,
                runs=len(complete),
                shares=[
                    InputShare(
                        input=key,
                        first=Estimate.model_validate(dict(zip(_PARTS, shares.first[:, i].tolist(), strict=True))),
                        total=Estimate.model_validate(dict(zip(_PARTS, shares.total[:, i].tolist(), strict=True))),
                    )
                    for i, key in enumerate(axis.keys)
                ],
            )


_PARTS = ("value", "low", "high")


def _place(columns: CampaignColumns, axis: SampleAxis) -> tuple[IntegerArray, IntegerArray]:
    """Number of the design in its set and number of the set of every run, from 0; the axis changes fastest."""
    place, sets = (columns.designs - 1) % len(axis), len(axis.keys) + 2
    return place // sets, place % sets
