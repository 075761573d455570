"""Figures of measured lines: coordinates, sections on the map, and the trace of a place."""

import re

import numpy as np
import pytest

from helpers.example_network import build_network, build_place
from pantocheck.conformance.pages.html import render_html
from pantocheck.conformance.pages.network_figures import _locate, draw_trace, list_coordinates
from pantocheck.conformance.pages.network_page import build_network_page


def test_a_kilometre_is_placed_between_its_neighbours_and_true_to_scale() -> None:
    """Two places 0.009 degrees apart, one to the north: 1.0008 km on a sphere of 6371 km."""
    results = build_network()
    places = [
        place.model_copy(update={"latitude_deg": 47.0 + 0.009 * i, "longitude_deg": 8.0, "from_km": float(i)})
        for i, place in enumerate(results.known_places[:2])
    ]
    tracks = list_coordinates(results.model_copy(update={"known_places": tuple(places)}))
    points = _locate(tracks, "0", "1", np.array([0.0, 0.5, 1.0, 1.5]), (47.0045, 8.0))
    assert points[:3, 1] == pytest.approx([-0.5004, 0.0, 0.5004], abs=1e-4)
    assert np.isnan(points[3]).all()  # beyond the last place with coordinates
    assert np.isnan(_locate(tracks, "other", "1", np.array([0.5]), (47.0, 8.0))).all()
    assert not list_coordinates(results.model_copy(update={"known_places": tuple(places[:1])}))


def test_page_without_coordinates_has_no_map() -> None:
    results = build_network()
    few = results.model_copy(update={"groups": results.groups[:40], "places": results.places[:2]})
    assert ">Map<" in render_html(build_network_page(few))
    bare = tuple(place.model_copy(update={"latitude_deg": None}) for place in few.known_places)
    assert ">Map<" not in render_html(build_network_page(few.model_copy(update={"known_places": bare})))


def test_trace_reaches_its_smallest_force_at_the_place() -> None:
    """The dip lies at the dashed line, in the middle of the axes from 34 to 332 px."""
    svg = draw_trace(build_place(0))
    points = re.search(r'points="([^"]+)"', svg)
    assert points is not None
    x, y = np.array([pair.split(",") for pair in points.group(1).split()], dtype=float).T
    assert x[np.argmax(y)] == pytest.approx((34 + 332) / 2, abs=2.0)
    assert "24.920 km" in svg
