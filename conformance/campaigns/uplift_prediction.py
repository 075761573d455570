"""Prediction of uplift forces from pilot runs, so that most other runs of a campaign are tuned after one passage.

The pilots follow from the design alone and run first, so that the results do not depend on the order of the runs. The
uplift force that gives the required mean contact force is fitted to them, linear in the varied inputs.
"""

from collections import defaultdict
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from pantocheck.conformance.campaigns.campaign_design import CampaignDesign, Inputs
from pantocheck.conformance.campaigns.campaign_run import RunRow
from pantocheck.conformance.core.array_types import RealArray

PILOTS_PER_INPUT = 2
"""Pilots of a case for each coefficient of the fit."""

RUNS_PER_PILOT = 4
"""Fewest runs of a case over its pilots: with fewer runs, waiting for the pilots costs more than it saves."""

LARGEST_ERROR_N = 0.2
"""Largest error of the fit at a pilot that is left out [N]; one correction reduces it below the tolerance of 0.02 N."""

FORCE_DECIMALS = 6
"""Decimals of a predicted force in newtons: rounding errors of a fit on another machine do not change it."""

GOLDEN_RATIO = (5**0.5 - 1) / 2


@dataclass(frozen=True)
class UpliftPrediction:
    """Fits of the uplift forces of all pantographs, by the id of the case."""

    fits: Mapping[str, tuple[tuple[str, ...], RealArray]]
    """Keys of the inputs, and coefficients of 1 and of these inputs, (1 + keys, pantographs) [N per unit]."""

    def predict(self, case_id: str, inputs: Inputs) -> tuple[float, ...]:
        """Uplift forces for the inputs of a run [N]; empty: not known."""
        if case_id not in self.fits:
            return ()
        keys, coefficients = self.fits[case_id]
        forces = np.array([1.0, *(inputs[key] for key in keys)]) @ coefficients
        return tuple(round(float(force), FORCE_DECIMALS) for force in forces)


def choose_pilots(design: CampaignDesign) -> frozenset[int]:
    """Numbers of the pilots of a design; none if an input has no order, or if the campaign is short."""
    runs_of_case: dict[str, list[int]] = defaultdict(list)
    keys: tuple[str, ...] | None = ()
    for run in design.list_runs():
        if run.system == "builtin":
            runs_of_case[run.case_id].append(run.number)
            keys = keys if keys is None else _list_numbers(run.inputs)
    if keys is None:
        return frozenset()
    wanted = PILOTS_PER_INPUT * (1 + len(keys))
    # Multiples of the golden ratio spread over every axis of a grid, and so do their first ones.
    return frozenset(
        numbers[int(i * GOLDEN_RATIO % 1 * len(numbers))]
        for numbers in runs_of_case.values()
        if len(numbers) >= RUNS_PER_PILOT * wanted
        for i in range(1, wanted + 1)
    )


def fit_uplift(pilots: Iterable[RunRow]) -> UpliftPrediction:
    """Fit the uplift forces of the pilots of each case; a case whose fit is not accurate has none."""
    rows_of_case: dict[str, list[RunRow]] = defaultdict(list)
    for row in pilots:
        rows_of_case[row.run.case_id].append(row)
    fits = {}
    for case_id, rows in rows_of_case.items():
        keys = _list_numbers(rows[0].run.inputs) or ()
        if not all(row.balance_forces for row in rows):
            continue
        inputs = np.array([[float(row.run.inputs[key]) for key in keys] for row in rows]).reshape(len(rows), -1)
        centre, scale = inputs.mean(axis=0), np.maximum(np.ptp(inputs, axis=0), 1e-300)
        columns = np.column_stack([np.ones(len(rows)), (inputs - centre) / scale])
        forces = np.array([row.balance_forces for row in rows])
        inverse = np.linalg.pinv(columns)
        fitted, own = inverse @ forces, np.clip(1 - np.diag(columns @ inverse), 1e-9, None)
        if np.abs((forces - columns @ fitted) / own[:, None]).max() <= LARGEST_ERROR_N:
            slopes = fitted[1:] / scale[:, None]
            fits[case_id] = (keys, np.vstack([fitted[0] - centre @ slopes, slopes]))
    return UpliftPrediction(fits)


def _list_numbers(inputs: Mapping[str, Any]) -> tuple[str, ...] | None:
    """Keys of the inputs without seeds, if all of them are numbers."""
    ordered = {key: value for key, value in inputs.items() if not key.endswith(".seed")}
    numbers = all(isinstance(value, int | float) and not isinstance(value, bool) for value in ordered.values())
    return tuple(ordered) if numbers else None
