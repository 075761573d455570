"""Mesh: stations at connectors, rows of wires, the element at a position."""

import numpy as np
import pytest

from helpers.lines import DROPPERS_2002, simple_line
from pantocheck.model import Kind, Wire
from pantocheck.model.description.catenary import Catenary
from pantocheck.model.fem.mesh import build_mesh, find_element


def test_mesh_has_stations_at_connectors_and_requested_positions() -> None:
    """Elements are at most 1 m long, and every dropper and the requested position is a station."""
    mesh = build_mesh(simple_line(), 1.0, (33.3,))
    assert np.diff(mesh.position).max() <= 1.0 + 1e-9
    for position in (*DROPPERS_2002, 33.3, 60.0, 120.0):
        assert mesh.position[mesh.station(position)] == pytest.approx(position, rel=0, abs=1e-9)
    assert build_mesh(simple_line(), 10.0).position.size == 2 + 1 + 2 * 9  # anchors, arm, droppers


def test_mesh_merges_equal_positions() -> None:
    """0.1 + 0.2 and 0.3 differ in the last bit; an element of 1e-17 m would make the stiffness singular."""
    mesh = build_mesh(simple_line(), 1.0, (0.1 + 0.2, 0.3))
    assert np.diff(mesh.position).min() > 1e-3


def test_mesh_names_the_nearest_station_of_a_position_without_one() -> None:
    """The message gives the position that was requested and the nearest one."""
    with pytest.raises(KeyError, match=r"no station at 60\.4 m; the nearest is at 60\.\d* m"):
        build_mesh(simple_line(), 1.0).station(60.4)


def test_mesh_rows_share_wires_of_one_kind_that_do_not_overlap() -> None:
    """Two stitch wires at different supports share a row, two parallel contact wires do not."""
    wires = [
        Wire(name, kind, start, end, 1e4, 1.0, 0.0)
        for name, kind, start, end in (
            ("left", Kind.CONTACT_WIRE, 0.0, 60.0),
            ("right", Kind.CONTACT_WIRE, 0.0, 60.0),
            ("first", Kind.STITCH_WIRE, 5.0, 15.0),
            ("second", Kind.STITCH_WIRE, 45.0, 55.0),
        )
    ]
    mesh = build_mesh(Catenary(tuple(wires)), 1.0)
    assert mesh.rows == 3
    assert mesh.row_of["first", "z"] == mesh.row_of["second", "z"]
    assert mesh.row_of["left", "z"] != mesh.row_of["right", "z"]


def test_station_is_known_to_a_micrometre() -> None:
    mesh = build_mesh(simple_line(), 1.0)
    for sign in (-1, 1):
        assert mesh.station(60.0 + sign * 0.9e-6) == mesh.station(60.0)
        with pytest.raises(KeyError, match="no station"):
            mesh.station(60.0 + sign * 1.1e-6)


def test_wire_overlaps_any_wire_of_its_row() -> None:
    """Three tension sections: the third overlaps the second, which shares a row with the first, and touches nothing."""
    ends = {"first": (0.0, 100.0), "second": (120.0, 200.0), "third": (180.0, 300.0), "fourth": (310.0, 400.0)}
    wires = tuple(Wire(name, Kind.CONTACT_WIRE, start, end, 1e4, 1.0, 0.0) for name, (start, end) in ends.items())
    mesh = build_mesh(Catenary(wires), 1.0)
    assert [mesh.row_of[name, "z"] for name in ends] == [0, 0, 1, 0]


@pytest.mark.parametrize(
    ("position", "element", "share"), [(0.0, 0, 0.0), (0.5, 0, 0.5), (1.0, 0, 1.0), (2.0, 1, 0.5), (3.0, 1, 1.0)]
)
def test_find_element_returns_index_and_share_of_the_length(position: float, element: int, share: float) -> None:
    """Elements of 1 m and 2 m; a station belongs to the element before it, the first station to the first element."""
    index, length, s = find_element(np.array([0.0, 1.0, 3.0]), position)
    assert (index, length, s) == (element, 1.0 + element, share)


def test_station_is_the_nearest_one() -> None:
    """Against the distances to all stations; up to 1e-6 m away, beyond the ends as well."""
    mesh = build_mesh(simple_line(), 3.7)
    for shift in (-9e-7, 0.0, 9e-7):
        for n, x in enumerate(mesh.position):
            assert mesh.station(x + shift) == n == np.abs(mesh.position - x - shift).argmin()
    with pytest.raises(KeyError, match="no station at"):
        mesh.station(float(mesh.position[:2].mean()))
