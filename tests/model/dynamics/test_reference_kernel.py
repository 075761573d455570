"""Reference kernel on whole simulations: all laws of the fast kernels, its refusals, and its choice."""

from collections.abc import Callable
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from helpers.lines import DAMPED, PANTOGRAPH_2002, Array, fix_along_track, simple_line
from helpers.step_differences import THREE_MASSES
from helpers.structured_heads import structured, zigzag_line
from pantocheck.model import Kind, ModalBand, Passage, discretise, simulate_passage
from pantocheck.model.description.failures import ImpossiblePassage
from pantocheck.model.description.irregularity import Irregularity
from pantocheck.model.dynamics.core_choice import CORE_VARIABLE, UnusableCore, choose_core
from pantocheck.model.dynamics.drop_values import MassDropSetup
from pantocheck.model.dynamics.kernel_arrays import build_kernel_arrays
from pantocheck.model.dynamics.mass_drop import simulate_mass_drop

PAIR = (PANTOGRAPH_2002, THREE_MASSES)
PLAIN = simple_line(spans=3, span=40.0, droppers=(5.0, 15.0, 25.0, 35.0), damping=DAMPED)
WAY = Passage(PAIR, (24.03, 12.03), 80.0, 0.3, 2e-3, watched=(("contact", 40.0), ("messenger", 35.0)), ramp=0.1)


def with_law(**law: Any) -> Passage:
    """Passage with another contact law of both heads."""
    return replace(WAY, pantographs=tuple(replace(base, **law) for base in PAIR))


def pass_by(catenary: Any, way: Passage) -> Callable[[], dict[str, Array]]:
    """Simulation of a passage; recorded quantities."""

    def simulate() -> dict[str, Array]:
        line = catenary if hasattr(catenary, "mesh") else discretise(catenary, 2.5)
        history = simulate_passage(replace(line), way)
        parts = {"force": history.strip_force, "height": history.height}
        return parts | {f"motion {i}": history.motion[..., i] for i in range(3)}

    return simulate


def drop_mass() -> dict[str, Array]:
    """Simulation of a mass drop; recorded quantities."""
    setup = MassDropSetup(40.0, "contact", 20.0, 0.01, 0.1, 0.5, 2e-3, (("contact", 20.0), ("messenger", 35.0)))
    decay = simulate_mass_drop(PLAIN, 2.5, setup)
    last = np.array([-1.0 if decay.last_slack is None else decay.last_slack])
    return {"last slack": last} | {f"motion {i}": decay.motion[..., i] for i in range(3)}


BUMPS = Irregularity(tuple(np.arange(0.0, 120.0, 1.5)), tuple(2e-3 * np.sin(np.arange(80.0))))
ROUGH = replace(PLAIN, wires=(replace(PLAIN.wires[0], irregularity=BUMPS), PLAIN.wires[1]))
LONG = simple_line(spans=8, damping=dict.fromkeys(Kind, DAMPED[Kind.DROPPER]))
CURVED = replace(WAY, pantographs=tuple(map(structured, PAIR)), watched=())
SIMULATIONS = {
    "ramp and irregularity": pass_by(ROUGH, WAY),
    "damper on an irregularity": pass_by(ROUGH, with_law(contact_damping=60.0)),
    "constraint on an irregularity": pass_by(ROUGH, with_law(contact_stiffness=np.inf)),
    "Hertz": pass_by(ROUGH, with_law(contact_stiffness=np.inf, hertz_coefficient=1.2e7)),
    "Hertz and a spring": pass_by(ROUGH, with_law(hertz_coefficient=1.2e7)),
    "curved strips with joints": pass_by(zigzag_line(), CURVED),
    "held stretches": pass_by(fix_along_track(PLAIN), WAY),
    "modal damping": pass_by(replace(PLAIN, modal_damping=(ModalBand(0.8, 1.5, 0.02),)), WAY),
    "window": pass_by(
        LONG, replace(WAY, start=(120.03, 100.03), watched=(("contact", 60.0), ("contact", 125.0)), kept_behind=30.0)
    ),
    "mass drop": drop_mass,
}


@pytest.mark.parametrize("name", SIMULATIONS)
def test_fast_kernels_give_the_values_of_the_reference_kernel(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """To 1e-8 of the largest value: sweeps stop at 1e-9 N of about 100 N, which a rigid contact passes on tenfold."""
    computed = SIMULATIONS[name]()
    monkeypatch.setenv(CORE_VARIABLE, "reference")
    expected = SIMULATIONS[name]()
    for quantity, values in expected.items():
        assert np.isnan(values).tobytes() == np.isnan(computed[quantity]).tobytes(), quantity
        if values.size:
            largest = float(np.nanmax(np.abs(values)))
            assert largest > 0
            assert float(np.nanmax(np.abs(computed[quantity] - values))) <= 1e-8 * largest, quantity


def test_reference_kernel_refuses_what_it_does_not_simulate(monkeypatch: pytest.MonkeyPatch) -> None:
    """No fast kernel runs silently in its place."""
    monkeypatch.setenv(CORE_VARIABLE, "reference")
    assert choose_core().name == "reference (full matrices)"
    with pytest.raises(UnusableCore, match="reference kernel is demanded"):
        build_kernel_arrays(discretise(PLAIN, 2.5), 2e-3)
    monkeypatch.setattr(
        "pantocheck.model.dynamics.simulation.start_interfaces", lambda *_: [SimpleNamespace(coupling=None)]
    )
    with pytest.raises(ImpossiblePassage, match="reference kernel does not move"):
        simulate_passage(discretise(PLAIN, 2.5), WAY)
