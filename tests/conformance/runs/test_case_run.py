"""Passage of a case: working height of the pantographs."""

from dataclasses import replace

import pytest

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.case_file import Discretisation
from pantocheck.conformance.core.step_log import ShareCallback
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.runs import case_run
from pantocheck.conformance.runs.case_run import build_passage, run_passage
from pantocheck.conformance.runs.static_quantities import sample_span
from pantocheck.model import DiscretisedLine, History, Passage, discretise, simulate_passage
from pantocheck.model.statics.elasticity import static_uplift


def test_working_height_is_the_mean_static_height_in_the_first_evaluated_span(two_pantograph_case: Case) -> None:
    """The frame spring is unstretched at the working height: its preload is 50 N/m times this height."""
    # The height is the mean static uplift of the contact wire plus the compression of the contact spring, 50 kN/m. The
    # first span ends at an anchor, so that its mean uplift differs by millimetres from that of the second span.
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


def test_computing_time_begins_after_a_first_step(two_pantograph_case: Case, monkeypatch: pytest.MonkeyPatch) -> None:
    """A passage without a step would leave the compilation of the time step to the run that is timed."""
    steps = []

    def simulate(line: DiscretisedLine, passage: Passage, progress: ShareCallback | None = None) -> History:
        steps.append(round(passage.duration / passage.time_step))
        return simulate_passage(line, passage, progress)

    monkeypatch.setattr(case_run, "integrate_passage", simulate)
    line, discretisation = discretise(build_catenary(two_pantograph_case.line), 5.0), Discretisation(time_step_s=0.004)
    run_passage(two_pantograph_case, line, discretisation)
    duration = (two_pantograph_case.end - two_pantograph_case.start) / two_pantograph_case.speed
    assert steps == [1, round(duration / discretisation.time_step_s)]
