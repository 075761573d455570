"""Model and passage of a line with listed spans and supports: identity with the short form."""

import tomllib
from typing import Any

import numpy as np
import pytest

from helpers.listed_spans import list_spans, list_supports
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.runs.case_run import build_passage, list_start_forces, record_passage
from pantocheck.model import discretise, simulate_passage

LINES = sorted(
    path.relative_to(library_folder()).as_posix()
    for path in library_folder().rglob("*line.toml")
    if path.parent.name != "profiles"
)


def read_forms(name: str) -> tuple[LineFile, LineFile]:
    """A line of the library as published, and with all its spans and supports listed."""
    tables: dict[str, Any] = tomllib.loads((library_folder() / name).read_text("utf-8"))
    listed = list_spans(tables) if "spans" in tables["geometry"] else tables
    return LineFile.model_validate(tables), LineFile.model_validate(list_supports(listed))


@pytest.mark.parametrize("name", LINES)
def test_listed_spans_and_supports_give_the_same_model_bit_by_bit(name: str) -> None:
    """Every position, mass, height and stagger of the model is equal."""
    short, listed = read_forms(name)
    assert build_catenary(listed) == build_catenary(short)


def test_listed_supports_give_the_same_passage_bit_by_bit() -> None:
    """Two pantographs on seven spans: forces, heights and uplifts, to the last bit."""
    case = select_cases(["en50318-2018/ac-simple/275-twin"])[-1]
    changes = {"evaluated_spans": (5, 5), "compared_spans": None, "spacing_m": (60.0,), "run_out_m": 10.0}
    records = []
    for line in read_forms("en50318-2018/ac-simple/line.toml"):
        short = line.model_copy(update={"geometry": line.geometry.shorten(7)})
        shortened = Case(case.file.model_copy(update=changes), short, case.pantographs, ())
        discretised, coarse = discretise(build_catenary(short), 2.0), case.file.discretisation.scale(4.0)
        passage = build_passage(shortened, discretised, coarse, list_start_forces(shortened))
        records.append(record_passage(shortened, passage, simulate_passage(discretised, passage)))
    for name in ("force", "contact_height", "support_uplift"):
        np.testing.assert_array_equal(*(getattr(record, name) for record in records))
