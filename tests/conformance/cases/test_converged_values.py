"""Converged values of the library: complete, current, confirmed, and usable as limits."""

import tomllib
from pathlib import Path

import pytest

from helpers.toml_edit import write_toml
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.converged_file import FOLDER, ConvergedFile, find_converged
from pantocheck.conformance.cases.library import list_library, load_case
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.toml_file import read_model
from pantocheck.conformance.grading.case_verification import EXTREMES, VERIFIED_QUANTITIES, build_requirements
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.quantities.registry import QUANTITIES

PATHS = sorted((library_folder() / FOLDER).rglob("*.toml"))
IDS = [path.relative_to(library_folder() / FOLDER).with_suffix("").as_posix() for path in PATHS]
AGREEMENT_PCT = 1.0
"""Condition for a stored value."""


@pytest.fixture(params=IDS)
def case(request: pytest.FixtureRequest) -> Case:
    return load_case(list_library(library_folder())[request.param])


@pytest.fixture
def converged(case: Case) -> ConvergedFile:
    return find_converged(case.id)


def test_values_belong_to_the_current_case_and_are_complete(case: Case, converged: ConvergedFile) -> None:
    assert (converged.case, converged.case_digest) == (case.id, case.digest)
    assert len(converged.uplift_force_N) == len(case.pantographs)
    stated = {(entry.owner, entry.quantity) for entry in (*converged.value, *converged.omitted)}
    scopes = {"static"} if case.is_static else {"static", "line", "pantograph"}
    assert stated == {
        (owner, name)
        for name in VERIFIED_QUANTITIES
        if QUANTITIES[name].scope in scopes
        for owner in (range(1, len(case.pantographs) + 1) if QUANTITIES[name].scope == "pantograph" else (0,))
    }


def test_second_formulation_confirms_every_value(converged: ConvergedFile) -> None:
    """Within 1 %, extremes of their distance from the mean; the interval contains both values."""
    means = {entry.owner: entry.value for entry in converged.value if entry.quantity == "mean_force_N"}
    for entry in converged.value:
        difference, scale = entry.second_value - entry.value, abs(entry.value)
        if entry.quantity in EXTREMES:
            scale = abs(entry.value - means[entry.owner])
        assert abs(entry.difference_pct) <= AGREEMENT_PCT
        # Both values have six digits.
        assert 100 * difference / scale == pytest.approx(entry.difference_pct, abs=0.002), entry
        assert abs(difference) <= entry.half_width + 2e-5 * abs(entry.value), entry


def test_limits_follow_from_the_values(case: Case, converged: ConvergedFile) -> None:
    """The narrowest tolerance, 1 % of the mean, exceeds the widest interval of a tolerance: the values are sharp."""
    requirements = build_requirements(converged, case.is_static)
    assert requirements
    half_widths = {(entry.owner, entry.quantity): entry.half_width for entry in converged.value}
    for requirement in requirements:
        half = (requirement.upper - requirement.lower) / 2
        assert half_widths[requirement.pantograph, requirement.quantity] < 0.25 * half, requirement


def test_case_file_is_not_mistaken_for_values() -> None:
    assert find_converged("en50318-2002/none") is None
    assert find_converged("../en50318-2002/250") is None
    assert not set(list_library(library_folder())) & {f"{FOLDER}/{name}" for name in IDS}


@pytest.mark.parametrize(
    ("changes", "found"),
    [
        ({"trust": "primary"}, "computed"),
        ({"value": [{"quantity": "std_force_N", "value": 1.0, "half_width": 0.1}]}, "pantograph"),
        ({"value": [{"quantity": "elasticity_mm_N", "pantograph": 1, "value": 1.0, "half_width": 0.1}]}, "pantograph"),
        ({"value": [{"quantity": "elasticity_mm_N", "value": 1.0, "half_width": -0.1}]}, "half_width"),
        ({"value": [{"quantity": "elasticity_mm_N", "value": 1.0, "half_width": 0.1} for _ in "ab"]}, "occurs twice"),
    ],
)
def test_wrong_file_is_refused(tmp_path: Path, changes: dict[str, object], found: str) -> None:
    content = tomllib.loads(PATHS[0].read_text(encoding="utf-8")) | changes
    for entry in changes.get("value", []):  # type: ignore[attr-defined]
        entry |= {"second_value": 1.0, "difference_pct": 0.0}
    path = write_toml(tmp_path / "250.toml", content)
    with pytest.raises(InputError, match=found):
        read_model(path, ConvergedFile, "converged values")
