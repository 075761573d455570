"""Damping of another line of the same materials: intervals contain its truth, and the condition is checked."""

from pathlib import Path

import numpy as np
import pytest

from helpers.command_line import pantocheck
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.drops.damping_results import FitOptions, build_damping_results
from pantocheck.conformance.drops.damping_transfer import transfer_damping
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.line.elements.damping import ComponentDamping
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.results.damping_format import DampingResults
from pantocheck.conformance.results.identified_modes import read_modes

MODES = Path(__file__).parents[2] / "data" / "vovan2015" / "stand-in-modes.json"
ELEMENT = 2.25
EDGES, RATIOS = (1.265, 2.138), (0.00201, 0.00171, 0.00155)
"""Material damping of the stand-in by group, on every line of these wires."""


@pytest.fixture(scope="module")
def measured() -> LineFile:
    (case,) = select_cases(["vovan2015/mass-drop/stand-in"])
    return case.line


@pytest.fixture(scope="module")
def other(measured: LineFile) -> LineFile:
    """Line of Table 1: spans of 54 m in place of 63 m, 16 kN in the messenger wire in place of 14 kN, a pre-sag."""
    (case,) = select_cases(["vovan2015/contact-force"])
    geometry = case.line.geometry.model_copy(update={"spans": 6})
    return case.line.model_copy(update={"geometry": geometry, "damping": measured.damping})


@pytest.fixture(scope="module")
def fitted(measured: LineFile) -> DampingResults:
    return build_damping_results(
        read_modes(MODES), build_catenary(measured), ELEMENT, "modes.json", FitOptions(wires="common")
    )


def test_intervals_contain_the_material_damping_of_both_lines(
    fitted: DampingResults, measured: LineFile, other: LineFile
) -> None:
    """Rayleigh damping misses a constant ratio by 13 %; the interval is about twice as wide, and no wider."""
    for line in (measured, other):
        found = transfer_damping(fitted, measured, line, ELEMENT)
        truth = np.array(RATIOS)[np.searchsorted(EDGES, found.frequency)]
        assert found.violations == ()
        assert found.frequency.size > 30
        assert np.mean(np.abs(found.ratio - truth) <= found.half_width) >= 0.95
        assert np.all(found.half_width < 0.3 * found.ratio)


def test_condition_names_other_materials_and_other_dampers(
    fitted: DampingResults, measured: LineFile, other: LineFile
) -> None:
    wire = other.contact_wire.model_copy(update={"mass_kg_m": 1.1})
    unknown = other.messenger_wire.model_copy(update={"area_mm2": None})
    damping = other.damping.model_copy(update={"droppers": ComponentDamping(stiffness_coefficient_s=0.05)})
    line = other.model_copy(update={"contact_wire": wire, "messenger_wire": unknown, "damping": damping})
    texts = transfer_damping(fitted, measured, line, ELEMENT).violations
    assert [text.split(":")[0] for text in texts[:2]] == ["contact wire", "messenger wire"]
    assert "mass over area differs by -17.5 %" in texts[0]
    assert "other components have up to" in texts[2]
    short = other.model_copy(update={"geometry": other.geometry.model_copy(update={"span_m": 20.0, "spans": 3})})
    droppers = short.droppers.model_copy(update={"x_m": (5.0, 15.0), "presag_m": (0.0, 0.0)})
    stiff = short.contact_wire.model_copy(update={"tension_N": 3e5})
    taut = short.messenger_wire.model_copy(update={"tension_N": 3e5})
    change = {"droppers": droppers, "contact_wire": stiff, "messenger_wire": taut}
    with pytest.raises(InputError, match="no mode from"):
        transfer_damping(fitted, measured, short.model_copy(update=change), ELEMENT)


def test_command_writes_the_table_of_another_line(tmp_path: Path) -> None:
    result = pantocheck(
        "drop", "fit", MODES, "--line", "vovan2015/mass-drop/stand-in", "--element", ELEMENT, "--wires", "common",
        "--transfer", "vovan2015/mass-drop/stand-in", "--out", tmp_path,
    )  # fmt: skip
    assert "intervals of at least 95 %" in result.output
    rows = (tmp_path / "transfer.csv").read_text(encoding="utf-8").splitlines()
    assert rows[0] == "frequency_Hz,damping_ratio,half_width_at_least_95"
    assert len(rows) > 30
