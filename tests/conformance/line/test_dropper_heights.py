"""Lengths of droppers without load determine the heights of the contact wire."""

import tomllib
from pathlib import Path

import numpy as np
import pytest
import tomli_w

from helpers.line_table_files import export_tables
from helpers.section_lines import section_tables
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.line.line_import import import_line
from pantocheck.model.discretisation.dropper_lengths import compute_unloaded_lengths

SPANS = 6


def write_base(folder: Path, name: str) -> Path:
    """Line of the library with at most six spans."""
    tables = tomllib.loads((library_folder() / name / "line.toml").read_text(encoding="utf-8"))
    if "spans" in tables["geometry"]:
        tables["geometry"]["spans"] = SPANS
    (folder / "base.toml").write_text(tomli_w.dumps(tables), encoding="utf-8")
    return folder / "base.toml"


def write_lengths(folder: Path, line: LineFile, lengths: list[float]) -> Path:
    """Table of droppers with their positions and these lengths to a tenth of a millimetre."""
    places = [(number, x) for number, schedule in enumerate(line.dropper_schedules, 1) for x in schedule.x_m]
    rows = [f"{number},{x!r},{length:.4f}" for (number, x), length in zip(places, lengths, strict=True)]
    (folder / "lengths.csv").write_text("\n".join(["span,x_m,length_m", *rows]) + "\n")
    return folder / "lengths.csv"


@pytest.mark.parametrize("name", ["en50318-2018/ac-simple", "mass-drop-line"])
def test_heights_follow_from_the_lengths(tmp_path: Path, name: str) -> None:
    """Lengths of a mesh of half the length, rounded to 0.1 mm: the wire moves by 0.12 mm and by 0.06 mm.

    One line has a stagger and a pre-sag, the other one droppers with a mass per length and unequal spans.
    """
    base = write_base(tmp_path, name)
    line = LineFile.model_validate(tomllib.loads(base.read_text()))
    lengths = compute_unloaded_lengths(build_catenary(line), 0.125).tolist()
    supports, _ = export_tables(tmp_path, line)
    tree = import_line(base, supports, write_lengths(tmp_path, line, lengths), "unloaded")
    imported = LineFile.model_validate(tree)
    for span, original in zip(imported.layout.spans, line.layout.spans, strict=True):
        assert span.contact_wire_height == pytest.approx(original.contact_wire_height, abs=2e-4)
    assert compute_unloaded_lengths(build_catenary(imported), 0.25) == pytest.approx(lengths, abs=1e-4)
    assert np.concatenate([schedule.length_m for schedule in imported.dropper_schedules]) == pytest.approx(
        lengths, abs=6e-5
    )


def test_length_of_one_dropper_moves_the_wire_there(tmp_path: Path) -> None:
    """A dropper that is 10 mm longer lowers the wire by a part of 10 mm, most of all at this dropper."""
    base = write_base(tmp_path, "mass-drop-line")
    line = LineFile.model_validate(tomllib.loads(base.read_text()))
    lengths = compute_unloaded_lengths(build_catenary(line), 0.25).tolist()
    lengths[13] += 0.010
    supports, _ = export_tables(tmp_path, line)
    tree = import_line(base, supports, write_lengths(tmp_path, line, lengths), "unloaded")
    heights = np.concatenate([span.contact_wire_height for span in LineFile.model_validate(tree).layout.spans])
    assert np.argmin(heights) == 13
    assert -0.010 < heights[13] < -0.002


@pytest.mark.parametrize(
    ("text", "lengths", "message"),
    [
        ("span,x_m,length_m\n1,30,1\n2,30,1\n", "published", "span 1 has lengths, but neither pre-sags nor heights"),
        ("span,x_m,presag_m\n1,30,0\n2,30,0\n", "unloaded", "span 2 has no lengths"),
        (
            "span,x_m,presag_m,length_m\n1,30,0,1\n2,30,0,1\n",
            "unloaded",
            "presag_m is given, but the lengths determine",
        ),
        ("span,x_m,length_m\n1,30,0.1\n2,30,2.5\n", "unloaded", "column 'length_m': with the lengths of its droppers"),
    ],
)
def test_heights_that_are_not_determined_are_refused(tmp_path: Path, text: str, lengths: str, message: str) -> None:
    base = write_base(tmp_path, "en50318-2002")
    (tmp_path / "s.csv").write_text("number,span_m\n0,60\n1,60\n2,\n")
    (tmp_path / "d.csv").write_text(text)
    with pytest.raises(InputError, match=message):
        import_line(base, tmp_path / "s.csv", tmp_path / "d.csv", lengths)  # type: ignore[arg-type]


def test_lengths_of_several_tension_sections_are_refused(tmp_path: Path) -> None:
    (tmp_path / "base.toml").write_text(tomli_w.dumps(section_tables()))
    line = LineFile.model_validate(section_tables())
    supports, _ = export_tables(tmp_path, line)
    count = sum(len(schedule.x_m) for schedule in line.dropper_schedules)
    with pytest.raises(InputError, match="dropper lengths need a line with one tension section"):
        import_line(tmp_path / "base.toml", supports, write_lengths(tmp_path, line, [1.0] * count), "unloaded")
