"""Table `head` of a pantograph file: combinations that the model does not have are refused with key and hint."""

from typing import Any

import pytest

from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.toml_file import validate_model
from pantocheck.conformance.pantograph.pantograph_file import PantographFile
from pantocheck.conformance.pantograph.pantograph_model import build_pantograph

CHAIN = {
    "names": ["frame", "head"], "masses_kg": [6.0, 1.5], "stiffness_N_m": [160.0, 7e3], "damping_N_s_m": [9.0, 5.0]
}  # fmt: skip
SQUARE = [[1.0, 0.0], [0.0, 1.0]]
MODELS: dict[str, dict[str, Any]] = {
    "chain": CHAIN,
    "matrices": {
        "mass_kg": SQUARE, "stiffness_N_m": SQUARE, "damping_N_s_m": SQUARE, "head": [0.0, 1.0],
        "uplift_force_on": [1.0, 0.0],
    },
    "transfer_function": {"poles_1_s": [[-1.0, 0.0]], "residues_m_N_s": [[1e-3, 0.0]]},
}  # fmt: skip
FRONT = {"position_m": 0.3, "mass_kg": 3.0, "stiffness_N_m": 1e4}
REAR = FRONT | {"position_m": -0.3}
TURN = {"inertia_kg_m2": 0.1, "stiffness_N_m_rad": 50.0, "damping_N_m_s_rad": 1.0}
STOP = {"compression_m": 0.03, "stiffness_N_m": 1e5}
RUB = {"force_N": 5.0}


def read_head(model: str, head: dict[str, Any]) -> PantographFile:
    tables = {"title": "Rig", model: MODELS[model], "contact": {"stiffness_N_m": 5e4}, "head": head}
    return validate_model(tables, PantographFile, "pantograph 'rig.toml'")


@pytest.mark.parametrize(
    ("model", "head", "message"),
    [
        ("chain", {"strip": [REAR, FRONT]}, "key head.strip: the strips are not in order"),
        ("chain", {"strip": [{"position_m": 0.3, "stiffness_N_m": 1e4}]}, "a mass needs a spring"),
        ("chain", {"strip": [FRONT | {"shape": [0.0, 1.0]}]}, r"key head.strip\[0\].shape: does not fit the model"),
        ("chain", {"pitch": TURN}, "key head.pitch: needs the strips of a chain"),
        ("chain", {"stop": [STOP | {"direction": [1.0, -1.0]}]}, r"stop\[0\]: needs between, and no direction"),
        ("chain", {"stop": [{"between": [1, 2], "stiffness_N_m": 1e5}]}, "extension_m: missing"),
        ("chain", {"stop": [STOP | {"between": ["head", "strip 1"]}]}, "(?s)no mass 'strip 1'.*frame, head, base"),
        ("chain", {"stop": [STOP | {"between": ["head", 2]}]}, r"key head.stop\[0\].between: names one part twice"),
        ("chain", {"strip": [FRONT, REAR], "friction": [RUB | {"between": ["strip 2"] * 2}]}, "one part twice"),
        ("matrices", {"friction": [RUB | {"between": ["base", 1]}]}, r"friction\[0\]: needs direction, and no between"),
        ("matrices", {"strip": [FRONT, REAR]}, "Give a shape of 2 values, and neither mass nor spring"),
        ("matrices", {"pitch": TURN}, "key head.pitch: needs the strips of a chain"),
        ("transfer_function", {"strip": [FRONT, REAR]}, "(?s)key head: found beside a transfer function"),
    ],
)  # fmt: skip
def test_combination_that_the_model_does_not_have_is_refused(model: str, head: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        read_head(model, head)


@pytest.mark.parametrize(
    "stop", [{"between": ["base", "frame"]}, {"between": ["head", "strip 2"]}, {"between": [1, "head"]}]
)
def test_stops_between_two_parts_are_accepted(stop: dict[str, Any]) -> None:
    assert read_head("chain", {"strip": [FRONT, REAR], "stop": [STOP | stop]}).strips == 2


def test_friction_of_matrices_does_not_turn_with_the_head() -> None:
    """The roll is an unknown behind those of the matrices."""
    file = read_head("matrices", {"roll": TURN, "friction": [RUB | {"direction": [1.0, -1.0]}]})
    (joint,) = build_pantograph(file, 120.0, 0.0).joints
    assert joint.direction.tolist() == [1.0, -1.0, 0.0]
