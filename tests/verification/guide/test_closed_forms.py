"""Topics of the guide: every number agrees with its closed form, and a wrong number is noticed."""

from collections.abc import Callable

import numpy as np
import pytest

from pantocheck.model import discretise
from verification.guide.comparisons import build_study, compare_absolute, compare_relative
from verification.guide.guide_format import Topic
from verification.guide.guide_tasks import TOPICS
from verification.guide.topics import string_droppers, wire_at_rest, wire_modes
from verification.guide.topics.closed_forms import point_flexibility, wire_sag

CHEAP = ("wire-sag", "wire-elasticity", "wire-frequencies", "dropper-lengths", "time-integration", "balances")
"""Topics of less than a second; the whole guide has the others."""


@pytest.mark.parametrize("name", CHEAP)
def test_every_number_of_a_topic_agrees(name: str) -> None:
    topic = TOPICS[name]()
    assert topic.comparisons or topic.convergence
    assert [row.key for row in topic.comparisons if not row.agrees] == []
    assert [(row.key, row.orders) for row in topic.convergence if not row.agrees] == []
    keys = [row.key for row in (*topic.comparisons, *topic.convergence)]
    assert len(keys) == len(set(keys))
    assert all(chart.alternative and chart.caption for chart in topic.charts)


def _change(monkeypatch: pytest.MonkeyPatch, module: object, **factors: float) -> None:
    """Multiply a closed form of a topic."""
    for name, factor in factors.items():
        original: Callable[..., np.ndarray] = getattr(module, name)
        monkeypatch.setattr(module, name, lambda *arguments, f=factor, g=original: f * g(*arguments))


def _disagreeing(topic: Topic) -> set[str]:
    return {row.key for row in (*topic.comparisons, *topic.convergence) if not row.agrees}


@pytest.mark.parametrize(
    ("name", "module", "form"),
    [
        ("wire-sag", wire_at_rest, "wire_sag"),
        ("wire-elasticity", wire_at_rest, "point_flexibility"),
        ("wire-frequencies", wire_modes, "pinned_frequencies"),
        ("dropper-lengths", string_droppers, "_string_lengths"),
    ],
)
def test_closed_form_that_is_wrong_by_a_thousandth_is_noticed(
    name: str, module: object, form: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    _change(monkeypatch, module, **{form: 1.001})
    assert _disagreeing(TOPICS[name]())


def test_elements_of_twice_the_bending_stiffness_are_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    original = wire_at_rest.build_wire
    monkeypatch.setattr(
        wire_at_rest,
        "build_wire",
        lambda length, bending_stiffness=195.0: original(length, 20e3, 2 * bending_stiffness),
    )
    assert _disagreeing(TOPICS["wire-elasticity"]()) == {"at-15m", "at-22.37m", "at-30m", "at-41.13m"}


def test_comparisons_and_orders_state_their_agreement() -> None:
    relative = compare_relative("a", "length", "m", (101.0, 100.0), 0.02, "")
    assert (relative.deviation, relative.agrees) == (pytest.approx(0.01), True)
    absolute = compare_absolute("a", "length", "m", (-101.0, -100.0), 0.5, "")
    assert (absolute.deviation, absolute.agrees) == (-1.0, False)
    # Errors 4 h^2, then 2 h^4: the last order is not the theoretical one.
    study = build_study("a", "error", "h", [(1.0, 4.0), (0.5, 1.0), (0.25, 0.25)], (2.0, 0.1), "")
    assert (study.orders, study.agrees) == ([2.0, 2.0], True)
    assert not build_study("a", "error", "h", [(1.0, 4.0), (0.5, 1.0), (0.25, 0.5)], (2.0, 0.1), "").agrees


def test_closed_forms_solve_their_equations() -> None:
    """EI w'''' - T w'' = -m g by fourth differences; flexibility of a string as the bending stiffness vanishes."""
    x = np.linspace(0.0, 20.0, 401)
    w, h = wire_sag(x, 20.0, 20e3, 1.35, 2e4), 0.05
    second = np.diff(w, 2)[1:-1] / h**2
    fourth = np.diff(w, 4) / h**4
    # Differences of h^2 on end layers of 1 m: 0.05^2 / 12 of the bending part.
    np.testing.assert_allclose(2e4 * fourth - 20e3 * second, -1.35 * 9.81, rtol=1e-2)
    assert np.abs(w[[0, -1]]).max() < 1e-15
    place = np.array([3.0, 10.0])
    assert point_flexibility(place, 20.0, 20e3, 1e-12) == pytest.approx(place * (20 - place) / 20 / 20e3, rel=1e-6)
    line = discretise(wire_at_rest.build_wire(20.0), 0.125)
    exact = wire_sag(line.mesh.position, 20.0, 20e3, 1.35, 195.0)
    np.testing.assert_allclose(line.state.deflection[0, :, 0], exact, atol=2e-5 * np.abs(exact).max())
