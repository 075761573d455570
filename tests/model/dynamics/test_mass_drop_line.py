"""Mass-drop line, whose spans differ: natural frequencies, and droppers of every span."""

import numpy as np
import pytest

from pantocheck.conformance.core.toml_file import read_model
from pantocheck.conformance.line.catenary_model import build_catenary, build_derived_line
from pantocheck.conformance.line.elements.dropper import COARSE
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.model import discretise
from pantocheck.model.fem import beams
from pantocheck.model.modal.modes import compute_modes

FREQUENCIES = (
    *(0.83619334, 0.85727738, 0.89731567, 0.92256271, 0.96641081, 1.0308617),
    *(1.6763127, 1.7198057, 1.7982759, 1.8443961, 1.931619, 2.0549647),
)
"""First two groups of natural frequencies of the mass-drop line, from the independent model of its records [Hz]."""


@pytest.fixture(scope="module")
def mass_drop_line() -> LineFile:
    return read_model(library_folder() / "mass-drop-line" / "line.toml", LineFile, "line")


def test_frequencies_are_those_of_the_spans_as_built(mass_drop_line: LineFile) -> None:
    """The independent model is 0.05 % to 0.21 % higher; six equal spans of 63 m are 1.7 % to 8.2 % too low."""
    frequencies = compute_modes(discretise(build_catenary(mass_drop_line), 1.0), len(FREQUENCIES)).frequency
    difference = np.array(FREQUENCIES) / frequencies - 1
    assert 0.4e-3 < difference.min() < difference.max() < 2.1e-3


def test_frequencies_of_the_records_are_those_of_elements_that_are_too_stiff_under_point_forces(
    mass_drop_line: LineFile, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The independent model has cubic elements of 0.75 m without residual flexibility.

    With the same elements, all frequencies are 0.006 % to 0.010 % lower: the share of the dropper masses that 2 cm of
    length make.
    """
    monkeypatch.setattr(beams, "element_flexibility", lambda length, *_: np.zeros((length.size, 7)))
    frequencies = compute_modes(discretise(build_catenary(mass_drop_line), 0.75), len(FREQUENCIES)).frequency
    np.testing.assert_allclose(np.array(FREQUENCIES) / frequencies - 1, 8e-5, rtol=0, atol=3e-5)


def test_derived_droppers_are_those_of_each_span(mass_drop_line: LineFile) -> None:
    derived = build_derived_line(mass_drop_line, discretise(build_catenary(mass_drop_line), COARSE))
    assert derived.span_limits_m == (0.0, 63.0, 126.0, 184.5, 247.5, 301.5, 364.5)
    spans = zip(derived.span_limits_m, mass_drop_line.dropper_schedules, strict=False)
    for (start, schedule), positions, lengths in zip(
        spans, derived.droppers.position_m, derived.droppers.length_m, strict=True
    ):
        assert positions == tuple(start + x for x in schedule.x_m)
        assert len(lengths) == len(schedule.x_m)


def test_shorter_span_has_longer_droppers_at_its_middle(mass_drop_line: LineFile) -> None:
    """The messenger sags by q L^2 / 8 T under equal load q: less in the span of 54 m than in the spans of 63 m."""
    derived = build_derived_line(mass_drop_line, discretise(build_catenary(mass_drop_line), COARSE))
    shortest = [min(lengths) for lengths in derived.droppers.length_m]
    load = 9.81 * (1.334 + 1.06 + 8.5 / 60 * (0.165 + 0.195 + 0.117 * 1.0))
    sag = np.array([load * span**2 / (8 * 15e3) for span in mass_drop_line.geometry.span_lengths])
    # The load acts at droppers, and the steady arms carry the wire near the supports: a tenth of the sag.
    assert 1.4 - np.array(shortest) == pytest.approx(sag, rel=0.1)
