"""Force laws: published values, rules of profiles, forces of a case, and refusals."""

import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from helpers.toml_edit import change_keys, write_toml
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.input_changes import parse_changes
from pantocheck.conformance.cases.library import load_case, select_cases
from pantocheck.conformance.cases.lift_force import AppliedForces, TunedForce, list_mean_force_rules
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.toml_file import read_model
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.pantograph.pantograph_file import PantographFile
from pantocheck.conformance.pantograph.pantograph_model import build_pantograph
from pantocheck.model.description.pantograph import frequencies

PROVENANCE = {"trust": "secondary", "source": "own"}
MEAN_LAW = {"kind": "mean_force", "constant_N": 50.0, "linear_N_h_km": 0.1, **PROVENANCE}


def read_library_file(name: str) -> dict[str, Any]:
    return tomllib.loads((library_folder() / name).read_text(encoding="utf-8"))


def write_case(folder: Path, law: dict[str, Any] | None, **changes: Any) -> Path:
    """Copy of the force-law case beside its pantograph with another law; changes are by dotted key."""
    pantograph, case = read_library_file("pantographs/dsa380.toml"), read_library_file("force-law/300.toml")
    change_keys(pantograph, {"force_law": law})
    change_keys(case, {"pantograph.0.model": "dsa380.toml", **changes})
    write_toml(folder / "dsa380.toml", pantograph)
    return write_toml(folder / "case.toml", case)


def applied_law(**aerodynamic: Any) -> dict[str, Any]:
    law = read_library_file("pantographs/dsa380.toml")["force_law"]
    law["aerodynamic_force"] |= aerodynamic
    return law


@pytest.mark.parametrize(
    ("name", "published"),
    [("dsa380", (0.01157, 6.5585, 12.3066)), ("dsa250", (0.3340, 5.6198, 9.6899))],
)
def test_pantographs_have_the_frequencies_of_the_printed_parameters(name: str, published: tuple[float, ...]) -> None:
    """Base fixed, head free, undamped; printed with four decimals, 5e-5 Hz."""
    file = read_model(library_folder() / "pantographs" / f"{name}.toml", PantographFile, "pantograph")
    assert np.abs(frequencies(build_pantograph(file, 100.0, 0.0)) - published).max() < 6e-5


@pytest.mark.parametrize(("speed", "aerodynamic"), [(200.0, 38.14), (300.0, 85.81), (400.0, 152.48)])
def test_applied_forces_of_the_dsa380(tmp_path: Path, speed: float, aerodynamic: float) -> None:
    """0.00095 v^2 + 0.0017 v - 0.2 by hand, exact to two decimals; static force 70 N."""
    (force,) = load_case(write_case(tmp_path, applied_law(), speed_km_h=speed)).lift_forces
    assert isinstance(force, AppliedForces)
    assert force.static_force == 70.0
    assert force.aerodynamic_force == pytest.approx(aerodynamic, abs=1e-9)
    assert force.uplift_force == pytest.approx(70.0 + aerodynamic, abs=1e-9)


def test_limit_of_the_force_law_case_is_the_sum_of_its_forces() -> None:
    (case,) = select_cases(["force-law/300"])
    (limit,), (force,) = case.limits, case.lift_forces
    assert limit.lower == pytest.approx(force.uplift_force - 0.5, abs=1e-9)
    assert limit.upper == pytest.approx(force.uplift_force + 0.5, abs=1e-9)


def test_sources_and_trust_are_the_published_ones() -> None:
    (case,) = select_cases(["force-law/300"])
    provenance = {item.group: (item.trust, item.source) for item in case.inputs}
    prints = ("wang2016", "fenet", "swjtu_code")
    assert provenance["pantograph 1.chain"] == ("secondary", prints)
    assert provenance["pantograph 1.force_law"] == ("secondary", prints)
    assert provenance["pantograph 1.force_law.aerodynamic_force"] == ("secondary", ("wang2016",))
    assert provenance["pantograph 1.contact"] == ("provisional", ("untraced",))


@pytest.mark.parametrize(
    ("profile", "constant", "above"),
    [("acceptance-ac", 70.0, 200.0), ("acceptance-dc-3kv", 110.0, 0.0), ("acceptance-dc-1500v", 140.0, 0.0)],
)
def test_rule_of_a_profile_is_a_law_of_the_mean_force(
    tmp_path: Path, profile: str, constant: float, above: float
) -> None:
    """0.00097 v^2 plus a constant, of secondary trust; 87.3 N at 300 km/h."""
    case = load_case(write_case(tmp_path, {"kind": "mean_force_rule", "profile": profile}))
    assert case.lift_forces == (TunedForce(pytest.approx(constant + 87.3, abs=1e-9)),)
    law = list_mean_force_rules()[profile]
    assert (law.trust, law.above_km_h) == ("secondary", above)
    assert law.source.startswith("acceptance rule: mean force at most 0.00097 v^2")


def test_mean_force_of_own_coefficients_follows_the_speed(tmp_path: Path) -> None:
    path = write_case(tmp_path, MEAN_LAW, speed_km_h=160.0)
    assert load_case(path).lift_forces == (TunedForce(66.0),)


def test_changed_speed_and_law_of_the_command_line_apply(tmp_path: Path) -> None:
    """The force follows the speed of `--set`: 70 + 38.14 N, and 60 + 38.14 N with another static force."""
    path = write_case(tmp_path, applied_law())
    for changes, force in ((), 155.81), (("speed_km_h=200",), 108.14), (
        ("speed_km_h=200", "pantograph.force_law.static_force_N=60.0"), 98.14,
    ):  # fmt: skip
        (lift,) = load_case(path, parse_changes(changes)).lift_forces
        assert lift.uplift_force == pytest.approx(force, abs=1e-9)


def test_digest_depends_on_the_coefficients_and_not_on_their_source(tmp_path: Path) -> None:
    def digest(law: dict[str, Any]) -> str:
        return load_case(write_case(tmp_path, law)).digest

    assert digest(MEAN_LAW) == digest(MEAN_LAW | {"source": "another"})
    assert digest(MEAN_LAW) != digest(MEAN_LAW | {"constant_N": 50.001})


def test_pantograph_without_a_law_has_no_key_for_it(case_250: Case) -> None:
    """Digests of cases written before the key existed depend on it."""
    assert "force_law" not in case_250.pantographs[0].model_dump(mode="json")
    assert case_250.law_forces == {}


@pytest.mark.parametrize(
    ("law", "changes", "message"),
    [
        (applied_law(on=4), {}, r"key force_law.aerodynamic_force.on: there is no mass 4"),
        (applied_law(on="knee"), {}, "there is no mass 'knee'"),
        (applied_law(on=[0.0, 1.0, 0.0]), {}, "key force_law.aerodynamic_force.on: found a list"),
        (applied_law(up_to_km_h=250.0), {}, r"pantograph\[1\].force_from: the force law is valid above 0 km/h up to "),
        (MEAN_LAW | {"above_km_h": 300.0}, {}, "not at 300 km/h"),
        (MEAN_LAW | {"above_km_h": 90.0, "up_to_km_h": 90.0}, {}, "force_law.up_to_km_h: 90 km/h is not greater than"),
        (MEAN_LAW | {"constant_N": -80.0}, {}, "the force law gives -50 N at 300 km/h"),
        (MEAN_LAW | {"constant_N": 1999.0}, {}, "the force law gives 2029 N at 300 km/h"),
        (MEAN_LAW | {"constants_N": 1.0}, {}, r"key force_law.constants_N: unknown key"),
        ({"kind": "mean_force_rule", "profile": "acceptance-dc"}, {}, "no profile 'acceptance-dc' of the library has"),
        ({"kind": "mean_force_rule", "profile": "line-test"}, {}, "no profile 'line-test' of the library has"),
        (None, {}, r"the pantograph file has no table \[force_law\]"),
        (
            MEAN_LAW,
            {"pantograph.0.uplift_force_N": 120.0},
            r"key pantograph\[1\].force_from: is given together with uplift_force_N",
        ),
        (MEAN_LAW, {"pantograph.0.force_from": "rule"}, r"pantograph\[1\].force_from: found 'rule', expected 'law'"),
        (MEAN_LAW, {"pantograph.0.force_from": None}, 'or force_from = "law" for the force law of the pantograph'),
    ],
)
def test_wrong_law_is_refused(
    tmp_path: Path, law: dict[str, Any] | None, changes: dict[str, Any], message: str
) -> None:
    with pytest.raises(InputError, match=message):
        load_case(write_case(tmp_path, law, **changes))


def test_law_without_force_at_the_speed_is_refused_at_the_next_number(tmp_path: Path) -> None:
    """A law is valid at the upper end of its range, not at the lower one."""
    (force,) = load_case(write_case(tmp_path, MEAN_LAW | {"up_to_km_h": 300.0})).lift_forces
    assert force == TunedForce(80.0)
    (force,) = load_case(write_case(tmp_path, MEAN_LAW | {"above_km_h": 299.9})).lift_forces
    assert force == TunedForce(80.0)
