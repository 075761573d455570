"""Damping files of the study: commands of docs/damping-study.md write each of them."""

import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.drops.damping_results import FitOptions, build_damping_results, write_damping_toml
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.results.damping_format import DampingResults
from pantocheck.conformance.results.identified_modes import read_modes

MODES = Path(__file__).parents[3] / "data" / "vovan2015" / "stand-in-modes.json"
"""Modes that `pantocheck drop identify` finds in the drops of the stand-in; docs/damping-study.md renews them."""
ELEMENT = 0.75


def read_damping(name: str) -> dict[str, Any]:
    text = (library_folder() / "vovan2015" / "damping" / f"{name}.toml").read_text(encoding="utf-8")
    return tomllib.loads(text)["damping"]


@pytest.fixture(scope="module")
def fit() -> DampingResults:
    (case,) = select_cases(["vovan2015/mass-drop/stand-in"])
    return build_damping_results(
        read_modes(MODES), build_catenary(case.line), ELEMENT, "modes.json", FitOptions("common", free=())
    )


def test_modes_are_those_of_the_stand_in() -> None:
    """Identification is within 1 % of the damping ratio of every mode; it reaches 0.3 %."""
    bands = read_damping("stand-in")["modal"]
    modes = [mode for mode in read_modes(MODES) if mode.certain]
    assert len(modes) == 45
    for mode in modes:
        (ratio,) = (band["damping_ratio"] for band in bands if band["from_Hz"] <= mode.frequency_Hz < band["to_Hz"])
        assert mode.damping_ratio == pytest.approx(ratio, rel=0.01)


@pytest.mark.parametrize("name", ["updated", "updated-modal"])
def test_fit_writes_the_updated_models(fit: DampingResults, name: str) -> None:
    """Numbers to 1e-5, which covers other libraries of linear algebra; the note also names what the fit leaves open."""
    written = tomllib.loads(write_damping_toml(fit, fit.modal if name == "updated-modal" else ()))["damping"]
    expected = read_damping(name)
    assert [len(table.pop("modal", ())) for table in (written, expected)] == [2 * (name == "updated-modal")] * 2
    assert written.keys() == expected.keys()
    note = expected.pop("note")
    assert written["note"].startswith(f"{note}. The damping of the wires does not explain group 1")
    for key, table in expected.items():
        assert written[key] == (pytest.approx(table, rel=1e-5) if isinstance(table, dict) else table)


def test_modal_bands_are_the_medians_of_two_groups(fit: DampingResults) -> None:
    bands = read_damping("updated-modal")["modal"]
    assert bands == [pytest.approx(band.model_dump(), rel=1e-5) for band in fit.modal]
    modes = read_modes(MODES)
    medians = [np.median([mode.damping_ratio for mode in modes if mode.group == group]) for group in (1, 2)]
    assert [band["damping_ratio"] for band in bands] == pytest.approx(medians, rel=1e-6)


def test_fit_has_a_real_residual(fit: DampingResults) -> None:
    """Rayleigh damping cannot follow a constant damping ratio: 13 %, against 0.06 % for Rayleigh damping put in."""
    assert 0.1 < fit.residual < 0.16
