"""System whose force is a sine of one period per span about a mean, in place of a simulation."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from pantocheck.conformance.extension import CaseSkipped, CaseSystem, DeliveredPassage, SystemFactory

MEAN_FORCE_N, SPAN_M, STEP_S = 119.0, 60.0, 0.002


def open_system(text: str) -> CaseSystem:
    """System with the amplitude in the text behind the colon: `--system acme-sine:20`."""
    amplitude_N = float(text or 20.0)

    def run(case: Mapping[str, Any]) -> DeliveredPassage | CaseSkipped:
        if case["speed_km_h"] is None:
            return CaseSkipped("the line at rest is not computed")
        speed, last = case["speed_km_h"] / 3.6, case["pantographs"][-1]
        time_s = np.arange(0.0, (last["end_m"] - last["start_m"]) / speed, STEP_S)
        position_m = np.array([p["start_m"] + speed * time_s for p in case["pantographs"]])
        force_N = MEAN_FORCE_N + amplitude_N * np.sin(2 * np.pi * position_m / SPAN_M)
        return DeliveredPassage(time_s, position_m, force_N)

    return CaseSystem(name="ACME sine", version="1.0", run=run)


factory = SystemFactory(open=open_system)
