"""Results with the moving picture of a passage whose wires and forces are known in closed form."""

from typing import Any

import numpy as np

from helpers.example_results import SPEED, example
from pantocheck.conformance.results.motion_format import code_field

FRAMES, STEP_S = 101, 0.01
LOWEST_FRAME = 70
"""Frame of the smallest force."""


def with_passage() -> dict[str, Any]:
    """The example, whose first case has a bump of 50 mm that moves with its pantographs, and one slack dropper."""
    results = example()
    case = results["cases"][0]
    start, end = case["run"]["evaluated_m"]
    x = np.linspace(start, end, 61)
    frame = np.arange(FRAMES)
    place = start + SPEED * STEP_S * frame
    rise = 50 * np.exp(-(((x - place[:, None]) / 8) ** 2))
    force = np.where(frame == LOWEST_FRAME, 40.0, 120.0)[:, None]

    def wire(kind: str, height: float) -> dict[str, Any]:
        return {"kind": kind, "x_m": [start, end], "y_m": [height, height]}

    middle = (start + end) / 2
    case["line_shape"] = {
        "title": "straight wires",
        "first_span": 1,
        "last_span": 1,
        "supports_m": [start, end],
        "side": {
            "curves": [wire("contact_wire", 0.0), wire("messenger_wire", 1.2)],
            "droppers": {"x_m": [middle], "lower_m": [0.0], "upper_m": [1.2]},
            "points": [{"symbol": "steady arm", "x_m": start, "y_m": 0.0, "text": ""}],
        },
        "plan": None,
        "symbols": [{"name": "steady arm", "marker": "o", "filled": True}],
    }
    pantograph = {
        "start_m": start,
        "masses": ["frame", "head"],
        "height_mm": code_field(np.full((FRAMES, 2), 50.0), 0.1).model_dump(),
        "force_N": code_field(force, 0.05).model_dump(),
        "band_N": code_field(10 * np.sin(frame)[:, None], 0.01).model_dump(),
        "band_start_s": 2.0,
        "band_step_s": STEP_S,
    }
    case["motion"] = {
        "start_s": 2.0,
        "step_s": STEP_S,
        "speed_m_s": SPEED,
        "wires": [
            {"curve": curve, "x_m": x.tolist(), "rise_mm": code_field(rise / (1 + curve), 0.1).model_dump()}
            for curve in (0, 1)
        ],
        "dropper_m": [middle],
        "slack": code_field((frame >= 50).astype(float)[:, None], 1.0).model_dump(),
        "pantographs": [pantograph],
        "error_mm": 0.5,
    }
    return results
