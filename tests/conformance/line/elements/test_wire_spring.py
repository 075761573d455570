"""Spring between the wires: a new element from its key to the static uplift."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from helpers.section_lines import section_line
from pantocheck.conformance.app.self_test.adapter_check import build_short_case
from pantocheck.conformance.cases.case import list_case_features
from pantocheck.conformance.core.features import list_features
from pantocheck.conformance.line.catenary_model import build_catenary, build_derived_line
from pantocheck.conformance.line.elements.wire_spring import WireSpringTable
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.line.line_shape import list_connections
from pantocheck.model import Catenary, discretise, static_uplift
from pantocheck.model.discretisation.discretised_line import make_droppers_bilateral

PLACE, FORCE = 150.0, 100.0


def spring_line(stiffness: float, x: float = PLACE) -> LineFile:
    """Line of the short case with a spring in the middle of its third span."""
    spring = WireSpringTable(x_m=x, stiffness_N_m=stiffness)
    return build_short_case().line.model_copy(update={"wire_spring": (spring,)})


@cache
def uplift(stiffness: float | None) -> float:
    """Static uplift under a force 3 m beside the spring; taut droppers, so that the line is linear [m]."""
    line = build_short_case().line if stiffness is None else spring_line(stiffness)
    built = make_droppers_bilateral(discretise(build_catenary(line), 0.5, (PLACE, PLACE + 3.0)))
    return float(static_uplift(built, np.array([PLACE + 3.0]), FORCE)[0])


def test_uplift_follows_the_law_of_a_single_spring() -> None:
    """Woodbury: a spring k lowers the uplift by u0 - u = c k / (1 + f k), with the flexibility f at its ends.

    So 1 / (u0 - u) is linear in 1 / k: two stiffnesses determine c and f, and with them every other one.
    """
    stiffness = np.array([1e3, 1e4, 5e4, 1e6])
    inverse = [1 / (uplift(None) - uplift(k)) for k in stiffness]
    line = np.polyfit(1 / stiffness[[0, -1]], [inverse[0], inverse[-1]], 1)
    assert inverse == pytest.approx(np.polyval(line, 1 / stiffness), rel=1e-4)
    assert line.min() > 0


def test_spring_at_a_dropper_adds_its_stiffness() -> None:
    """Independent check: a taut dropper and a spring at one place are one dropper with the sum of their stiffnesses.

    The residual flexibility of the wires is left out by a dropper of 1 kN/m, which is soft beside it.
    """
    line = build_short_case().line
    soft = line.model_copy(update={"droppers": line.droppers.model_copy(update={"stiffness_N_m": 1e3})})
    catenary = build_catenary(soft)
    dropper = catenary.droppers[len(catenary.droppers) // 2]
    sprung = build_catenary(
        soft.model_copy(update={"wire_spring": (WireSpringTable(x_m=dropper.position, stiffness_N_m=500.0),)})
    )
    stiffer = replace(
        catenary,
        droppers=tuple(replace(d, stiffness=1500.0) if d is dropper else d for d in catenary.droppers),
    )

    def lift(catenary: Catenary) -> float:
        built = make_droppers_bilateral(discretise(catenary, 0.5, (dropper.position + 3.0,)))
        return float(static_uplift(built, np.array([dropper.position + 3.0]), FORCE)[0])

    assert lift(sprung) == pytest.approx(lift(stiffer), rel=1e-4)
    assert lift(sprung) < lift(catenary) - 1e-4


def test_spring_reaches_programs_drawing_and_features() -> None:
    line = spring_line(5e4)
    built = discretise(build_catenary(line), 1.0)
    [derived] = build_derived_line(line, built).wire_springs
    assert (derived.position_m, derived.contact_wire, derived.stiffness_N_m) == (PLACE, 1, 5e4)
    assert len(list_connections(built.catenary)) == len(built.catenary.droppers) + 1
    case = build_short_case()
    assert "wire_springs" in list_features(line)
    assert "wire_springs" in list_case_features(replace(case, line=line))
    assert "wire_springs" not in list_case_features(case)


def test_spring_in_an_overlap_or_beyond_the_line_is_refused() -> None:
    tables = section_line().model_dump(exclude_none=True)
    start, end = section_line().overlaps[0]
    for x, reason in (((start + end) / 2, "lies in the overlap"), (1e4, "is not on the line")):
        with pytest.raises(ValueError, match=reason):
            LineFile.model_validate(tables | {"wire_spring": [{"x_m": x, "stiffness_N_m": 5e4}]})
