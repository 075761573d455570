"""Point masses, changes of wires and irregularity of a line file: model, derived values and errors."""

from typing import Any

import numpy as np
import pytest

from helpers.changed_lines import changed_line, changed_tables, refuse_line
from helpers.section_lines import section_tables
from helpers.toml_edit import write_toml
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.toml_file import read_model
from pantocheck.conformance.line.catenary_model import build_catenary, build_derived_line
from pantocheck.conformance.line.elements.point_mass import PointMasses
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.runs.static_quantities import first_modes
from pantocheck.model import Irregularity, PointMass, SpectralDensity, discretise, realise_irregularity

INSULATOR = {"x_m": 92.0, "wire": "contact_wire", "mass_kg": 12.0, "name": "section insulator"}
WORN = {"from_m": 60.0, "to_m": 100.0, "wear_share": 0.2}
SPLICE = {"from_m": 100.0, "to_m": 100.4, "mass_kg_m": 3.0, "bending_stiffness_N_m2": 900.0, "tension_N": 19e3}
DETAILS: dict[str, Any] = {
    "point_mass": [INSULATOR],
    "contact_wire.change": [WORN, SPLICE],
    "messenger_wire.change": [{"from_m": 30.0, "to_m": 70.0, "tension_N": 15e3}],
    "contact_wire.irregularity": {"x_m": [60.0, 90.0, 120.0], "height_m": [0.0, 0.004, 0.001]},
}


def test_details_reach_the_model() -> None:
    """The worn wire has 80 % of the mass and 49.5 % of the stiffness; the splice has its own values."""
    catenary = build_catenary(changed_line(DETAILS))
    line = discretise(catenary, 1.0)
    row = line.mesh.row_of["contact wire", "z"]

    def properties(position: float) -> list[float]:
        element = int(np.searchsorted(line.mesh.position, position)) - 1
        return [
            float(a[row, element])
            for a in (line.beams.tension, line.beams.mass_per_length, line.beams.bending_stiffness)
        ]

    assert properties(30.0) == [20e3, 1.35, 195.0]
    assert properties(80.0) == pytest.approx([20e3, 0.8 * 1.35, 0.49524 * 195.0], rel=1e-4)
    assert properties(100.2) == pytest.approx([19e3, 3.0, 900.0], rel=1e-12)
    assert catenary.point_masses == (PointMass(92.0, "contact wire", 12.0, PointMasses.__name__),)
    assert catenary.contact_wires[0].irregularity == Irregularity((60.0, 90.0, 120.0), (0.0, 0.004, 0.001))


def test_spectrum_is_realised_over_the_line() -> None:
    """Frequencies, densities and seed of the file, over its 180 m."""
    table = {"frequency_1_m": [0.02, 0.5], "density_m3": [1e-5, 1e-7], "seed": 5}
    catenary = build_catenary(changed_line({"contact_wire.irregularity": table}))
    expected = realise_irregularity(SpectralDensity((0.02, 0.5), (1e-5, 1e-7)), 180.0, 5)
    assert catenary.contact_wires[0].irregularity == expected


@pytest.mark.parametrize(
    "table",
    [
        {"x_m": [60.0, 90.0, 120.0], "height_m": [0.0, 0.004, 0.001]},
        {"frequency_1_m": [0.02, 0.5], "density_m3": [1e-5, 1e-7], "seed": 5},
    ],
)
def test_height_factor_multiplies_all_heights(table: dict[str, object]) -> None:
    """The same heights, larger by the factor; without the key, files keep their content and digest."""
    plain, larger = (changed_line({"contact_wire.irregularity": table | more}) for more in ({}, {"height_factor": 2.5}))
    heights = [np.array(build_catenary(line).contact_wires[0].irregularity.height) for line in (plain, larger)]
    np.testing.assert_array_equal(heights[1], 2.5 * heights[0])
    assert "height_factor" not in plain.model_dump()["contact_wire"]["irregularity"]


def test_point_mass_hangs_on_each_parallel_wire() -> None:
    """Twin contact wires carry one mass each; the messenger has none."""
    changes = {"contact_wire.number": 2, "contact_wire.spacing_m": 0.04, "point_mass": [INSULATOR]}
    masses = build_catenary(changed_line(changes)).point_masses
    assert [mass.wire for mass in masses] == ["contact wire 1", "contact wire 2"]


def test_derived_values_state_the_details() -> None:
    """A program receives stretches from end to end, masses and heights; they give the mass of the wire."""
    file = changed_line(DETAILS)
    derived = build_derived_line(file, discretise(build_catenary(file), 1.0))
    stretches = derived.contact_wire.stretches
    assert [(s.from_m, s.to_m) for s in stretches] == [(0.0, 60.0), (60.0, 100.0), (100.0, 100.4), (100.4, 180.0)]
    assert [s.tension_N for s in derived.messenger_wire.stretches] == [16e3, 15e3, 16e3]
    mass = sum(s.mass_kg_m * (s.to_m - s.from_m) for s in stretches)
    assert mass == pytest.approx(1.35 * (180 - 0.2 * 40 - 0.4) + 3.0 * 0.4, rel=1e-6)
    assert derived.contact_wire.irregularity is not None
    assert derived.contact_wire.irregularity.height_m == (0.0, 0.004, 0.001)
    assert derived.point_masses[0].model_dump() == {
        "position_m": 92.0, "wire": "contact_wire", "number": 1, "mass_kg": 12.0, "mass_coefficient_1_s": 0.0125,
    }  # fmt: skip


def test_line_without_details_has_no_new_keys() -> None:
    """The inputs and derived values of existing files stay as they were, so that their digests do."""
    file = changed_line({})
    derived = build_derived_line(file, discretise(build_catenary(file), 2.0)).model_dump()
    assert {"change", "irregularity"}.isdisjoint(file.model_dump()["contact_wire"])
    assert "point_mass" not in file.model_dump()
    assert "point_masses" not in derived
    assert {"stretches", "irregularity"}.isdisjoint(derived["contact_wire"])


def test_first_spans_of_a_line_keep_their_details_only() -> None:
    """The modes are those of ten spans; details of later spans are left out of them."""
    later = {
        "point_mass": [INSULATOR | {"x_m": 640.0}],
        "contact_wire.change": [WORN | {"from_m": 590.0, "to_m": 650.0}],
    }
    modes = [first_modes(changed_line(details, 12), 5.0).frequency for details in ({}, later)]
    assert modes[1] == pytest.approx(modes[0], rel=0.01)


def test_mass_in_an_overlap_is_refused(tmp_path: Any) -> None:
    """Two sections have wires there, and the table does not say which of them carries the mass."""
    tables = section_tables() | {"point_mass": [INSULATOR | {"x_m": 250.0}]}
    write_toml(tmp_path / "line.toml", tables)
    with pytest.raises(InputError, match=r"point_mass\[1\].x_m: 250 m lies in the overlap from"):
        read_model(tmp_path / "line.toml", LineFile, "line")


@pytest.mark.parametrize(
    ("changes", "messages"),
    [
        ({"point_mass": [INSULATOR | {"x_m": 180.0}]}, ["point_mass[1].x_m", "180 m is not on the line"]),
        ({"point_mass": [INSULATOR | {"wire": "dropper"}]}, ["point_mass[1].wire", "'contact_wire'"]),
        ({"contact_wire.change": [WORN, WORN | {"from_m": 90.0}]}, ["contact_wire.change[2].from_m", "90 m lies in"]),
        ({"contact_wire.change": [WORN | {"mass_kg_m": 1.0}]}, ["change[1].mass_kg_m", "given twice"]),
        ({"contact_wire.change": [WORN | {"to_m": 60.0}]}, ["change[1].to_m", "60 m is not after from_m = 60 m"]),
        ({"messenger_wire.change": [WORN]}, ["messenger_wire.change[1].wear_share"]),
        (
            {"contact_wire.irregularity": {"x_m": [0.0, 5.0, 5.0], "height_m": [0.0, 0.1]}},
            ["irregularity.height_m", "2 values for 3", "irregularity.x_m[3]", "5 follows 5"],
        ),
        (
            {"contact_wire.irregularity": {"frequency_1_m": [0.1, 40.0], "density_m3": [1e-6, 1e-7], "seed": 1}},
            ["irregularity.frequency_1_m", "40 1/m is too high for a line of 180 m", "up to 16.7 1/m"],
        ),
    ],
)  # fmt: skip
def test_impossible_details_are_refused(changes: dict[str, Any], messages: list[str], tmp_path: Any) -> None:
    """Each problem names its key, what was found and what is possible."""
    found = refuse_line(tmp_path, changed_tables(changes))
    assert [message for message in messages if message not in found] == []
