"""Passage of a case: working height of the pantographs."""

from dataclasses import replace

import pytest

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.simulation.case_run import build_passage
from pantocheck.conformance.simulation.catenary_model import build_catenary
from pantocheck.conformance.simulation.static_quantities import sample_span
from pantocheck.model import discretise
from pantocheck.model.statics.elasticity import static_uplift


def test_working_height_is_the_mean_static_height_in_the_first_evaluated_span(two_pantograph_case: Case) -> None:
    """The frame spring is unstretched at the working height: its preload is 50 N/m times this height.

    The height is the mean static uplift of the contact wire plus the compression of the contact spring, 50 kN/m. The
    first span ends at an anchor, so that its mean uplift differs by millimetres from that of the second span.
    """
    geometry = two_pantograph_case.line.geometry.shorten(4)
    sections = {"evaluated_spans": (1, 2), "spacing_m": (20.0,), "run_out_m": 0.0}
    case = replace(
        two_pantograph_case,
        line=two_pantograph_case.line.model_copy(update={"geometry": geometry}),
        file=two_pantograph_case.file.model_copy(update=sections),
    )
    line, forces = discretise(build_catenary(case.line), 2.0), (120.0, 150.0)
    passage = build_passage(case, line, case.file.discretisation, forces)
    for pantograph, force in zip(passage.pantographs, forces, strict=True):
        first, second = (static_uplift(line, sample_span(*geometry.span(n)), force).mean() for n in (1, 2))
        assert abs(first - second) > 1e-3
        assert pantograph.static_force == force
        assert (pantograph.force[0] - force) / 50.0 == pytest.approx(first + force / 50e3)
