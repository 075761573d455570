"""Impossible combinations of elements are refused."""

from typing import Any

import pytest
from pydantic import ValidationError

from pantocheck.conformance.core.toml_file import read_toml
from pantocheck.conformance.line.elements.damping import Damping
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.pantograph.pantograph_file import PantographFile

PROVENANCE = {"trust": "secondary", "source": "pcmui"}
AC_SIMPLE = read_toml(library_folder() / "en50318-2018" / "ac-simple" / "line.toml", "line")
STITCH = {"length_m": 18.0, "tension_N": 3500.0, "mass_kg_m": 0.31, "clamp_kg": 0.38, **PROVENANCE}


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"stitch_wire": STITCH | {"length_m": 56.0}}, "must not overlap"),
        ({"messenger_wire": AC_SIMPLE["messenger_wire"] | {"number": 2}}, "two messenger wires carry one contact wire"),
        ({"steady_arm": {"static_share": "none", **PROVENANCE}}, "neither a stiffness nor a length"),
    ],
)
def test_impossible_lines_are_refused(change: dict[str, Any], message: str) -> None:
    with pytest.raises(ValidationError, match=message):
        LineFile.model_validate(AC_SIMPLE | change)


def test_modal_damping_bands_must_not_overlap() -> None:
    band = {"from_Hz": 0.8, "to_Hz": 1.2, "damping_ratio": 0.006}
    next_band = {"from_Hz": 1.2, "to_Hz": 2.5, "damping_ratio": 0.005}
    assert len(Damping.model_validate({"modal": [band, next_band], **PROVENANCE}).modal) == 2
    with pytest.raises(ValidationError, match="overlap"):
        Damping.model_validate({"modal": [band, next_band | {"from_Hz": 1.1}], **PROVENANCE})


def test_uplift_force_acts_on_the_lowest_mass_by_default() -> None:
    pantograph = read_toml(library_folder() / "en50318-2018" / "pantograph.toml", "pantograph")
    del pantograph["chain"]["uplift_force_on"]
    assert PantographFile.model_validate(pantograph).chain.uplift_mass == 0
