"""Model of a line with listed spans: identity with the short form."""

import tomllib

import pytest

from helpers.listed_spans import list_spans
from pantocheck.conformance.cases.library_folder import library_folder
from pantocheck.conformance.cases.line_file import LineFile
from pantocheck.conformance.simulation.catenary_model import build_catenary


@pytest.mark.parametrize("name", ["en50318-2002", "en50318-2018/ac-simple", "en50318-2018/ac-stitched", "vovan2015"])
def test_listed_equal_spans_give_the_same_model_bit_by_bit(name: str) -> None:
    """Every position, mass and stagger of the model is equal; five spans hold every kind of span and support."""
    tables = tomllib.loads((library_folder() / name / "line.toml").read_text("utf-8"))
    lines = [LineFile.model_validate(content) for content in (tables, list_spans(tables))]
    short, listed = (line.model_copy(update={"geometry": line.geometry.shorten(5)}) for line in lines)
    assert build_catenary(listed) == build_catenary(short)
