"""Line files accept the published data of the reference lines."""

from typing import Any

import pytest
from pydantic import ValidationError

from pantocheck.conformance.line.elements.damping import Damping
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.pantograph.pantograph_file import PantographFile

PROVENANCE = {"trust": "secondary", "source": "pcmui"}

AC_SIMPLE = {
    "title": "AC simple",
    "geometry": {"span_m": 55.0, "spans": 24, "encumbrance_m": 1.2, "stagger_contact_wire_m": 0.2, **PROVENANCE},
    "contact_wire": {
        "tension_N": 22e3,
        "mass_kg_m": 1.35,
        "bending_stiffness_N_m2": 195.0,
        "area_mm2": 150.0,
        **PROVENANCE,
    },
    "messenger_wire": {"tension_N": 16e3, "mass_kg_m": 1.08, "bending_stiffness_N_m2": 131.7, **PROVENANCE},
    "droppers": {
        "x_m": [4.5, 10.25, 16.0, 21.75, 27.5, 33.25, 39.0, 44.75, 50.5],
        "presag_m": [0.0, 0.024, 0.041, 0.052, 0.055, 0.052, 0.041, 0.024, 0.0],
        "length_m": [1.017, 0.896, 0.810, 0.758, 0.741, 0.758, 0.810, 0.896, 1.017],
        "axial_stiffness_EA_N": 200e3,
        "mass_kg_m": 0.117,
        "clamp_on_messenger_kg": 0.195,
        "clamp_on_contact_kg": 0.165,
        **PROVENANCE,
    },
    "steady_arm": {"length_m": 1.22, "mass_kg_m": 0.73, "clamp_kg": 0.2, "static_share": "none", **PROVENANCE},
    "messenger_support": {"stiffness_N_m": 500e3, "damping_N_s_m": 1000.0, **PROVENANCE},
    "damping": {"contact_wire": {"mass_coefficient_1_s": 0.0125, "stiffness_coefficient_s": 1e-4}, **PROVENANCE},
}

STITCH = {"length_m": 18.0, "tension_N": 3500.0, "mass_kg_m": 0.31, "clamp_kg": 0.38, **PROVENANCE}


def test_simple_stitched_and_twin_lines_fit() -> None:
    assert LineFile.model_validate(AC_SIMPLE).geometry.stagger_contact_wire_m == 0.2
    assert LineFile.model_validate(AC_SIMPLE | {"stitch_wire": STITCH}).stitch_wire is not None
    twin = AC_SIMPLE["contact_wire"] | {"number": 2, "spacing_m": 0.04}
    assert LineFile.model_validate(AC_SIMPLE | {"contact_wire": twin}).contact_wire.number == 2


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


def test_three_mass_pantograph_fits() -> None:
    chain = {
        "masses_kg": [6.0, 9.0, 7.5],
        "stiffness_N_m": [160.0, 15500.0, 7000.0],
        "damping_N_s_m": [100.0, 0.1, 45.0],
        "provisional": ["damping_N_s_m"],
        **PROVENANCE,
    }
    contact = {"stiffness_N_m": 50e3, **PROVENANCE}
    pantograph = PantographFile.model_validate({"title": "2018", "chain": chain, "contact": contact})
    assert pantograph.chain.uplift_mass == 0
