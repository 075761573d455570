"""Sliders of the explorer: their ranges, the changes that follow from them, and refused values."""

import pytest

from pantocheck.conformance.app.explorer.case_sliders import build_changes, find_slider, list_sliders
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.input_changes import parse_changes
from pantocheck.conformance.cases.library import list_library, load_case, select_cases
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.line.library_folder import library_folder

TRAINS = [case for case in select_cases(["*/*"]) if not case.is_static]


def load(case: Case, values: dict[str, float]) -> Case:
    """The case at a setting of its sliders."""
    return load_case(list_library(library_folder())[case.id], build_changes(list_sliders(case), values))


@pytest.mark.parametrize("case", TRAINS, ids=lambda case: case.id)
def test_both_ends_of_every_slider_are_valid_inputs(case: Case) -> None:
    """A slider whose end is refused would be of no use; each value of the case lies between both ends."""
    for slider in list_sliders(case):
        assert slider.low <= slider.value <= slider.high
        for value in (slider.low, slider.high):
            assert load(case, {slider.id: value}).digest != case.digest
        assert load(case, {slider.id: slider.value}).digest == case.digest


def test_main_inputs_have_sliders() -> None:
    (case,) = [case for case in TRAINS if case.id == "en50318-2018/ac-simple/320-twin"]
    assert [slider.label for slider in list_sliders(case)] == [
        *("speed", "contact wire tension", "messenger wire tension", "dropper axial stiffness EA"),
        *("damping of the line", "mean contact force", "contact stiffness", "pantograph spacing"),
    ]


def test_factor_multiplies_every_coefficient_of_the_damping() -> None:
    """Five kinds of components, each with two coefficients; the same digest as by `--set` of each key."""
    case = select_cases(["en50318-2002/250"])[-1]
    (damping,) = [slider for slider in list_sliders(case) if slider.is_factor]
    texts = [f"{key}={2.5 * value!r}" for key, value in damping.keys.items()]
    assert len(texts) > 2
    changed = load_case(list_library(library_folder())[case.id], parse_changes(texts))
    assert load(case, {damping.id: 2.5}).digest == changed.digest


def test_pantographs_with_different_forces_have_sliders_of_their_own() -> None:
    case = select_cases(["vovan2015/contact-force"])[-1]
    forces = [slider for slider in list_sliders(case) if slider.label.startswith("mean contact force")]
    assert [slider.value for slider in forces] == [use.target_mean_force_N for use in case.file.pantograph]
    changed = load(case, {forces[1].id: 200.0})
    assert [lift.target_mean_force for lift in changed.lift_forces] == [forces[0].value, 200.0]


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"speed_km_h": 1000.0}, "speed: 1000 km/h is outside of its range.\n  Choose 125 to 375 km/h."),
        ({"speed_km_h": float("nan")}, "nan km/h is outside"),
        ({"speed": 200.0}, "is not on this page.\n  Did you mean speed_km_h"),
    ],
)
def test_wrong_values_are_named(values: dict[str, float], message: str) -> None:
    with pytest.raises(InputError, match=message.replace(".", r"\.")):
        build_changes(list_sliders(select_cases(["en50318-2002/250"])[-1]), values)
    with pytest.raises(InputError):
        find_slider([], "speed_km_h")
