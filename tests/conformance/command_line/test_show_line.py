"""`pantocheck show`: the line at rest, and its drawing."""

from pathlib import Path
from xml.etree import ElementTree

from typer.testing import CliRunner

from pantocheck.conformance.command_line.app import app


def test_drawing_is_a_valid_svg_and_deterministic(tmp_path: Path) -> None:
    files = [tmp_path / name for name in ("one.svg", "two.svg")]
    for file in files:
        result = CliRunner().invoke(app, ["show", "en50318-2018/ac-stitched/static", "--drawing", str(file)])
        assert result.exit_code == 0, result.output
    assert files[0].read_bytes() == files[1].read_bytes()
    root = ElementTree.fromstring(files[0].read_text())
    assert root.tag.endswith("svg")


def test_line_at_rest_and_apparent_mass_are_printed() -> None:
    result = CliRunner().invoke(app, ["show", "en50318-2002/250", "--at-rest"])
    assert result.exit_code == 0, result.output
    for text in (
        "dropper_length_bending_m",
        "Elasticity along the span",
        "Apparent mass at the head",
        "doppler_factor",
    ):
        assert text in result.output
    assert "en50318-2002/300" not in result.output


def test_required_cases_are_not_shown() -> None:
    result = CliRunner().invoke(app, ["show", "en50318-2018/ac-simple/275"])
    assert result.exit_code == 0
    assert "ac-simple/static" not in result.output.split("Inputs")[0]


def test_cases_with_several_lines_are_not_drawn(tmp_path: Path) -> None:
    """The lines have files of the same name in different folders."""
    file = tmp_path / "line.svg"
    result = CliRunner().invoke(app, ["show", "en50318-2018/*/static", "--drawing", str(file)])
    assert result.exit_code == 2
    assert "the cases have different lines" in result.output
    assert not file.exists()
