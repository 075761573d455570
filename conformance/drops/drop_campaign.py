"""Simulated campaigns of mass drops: every combination of mass, place and tensions, with several noise records."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.input_changes import InputChange, build_change
from pantocheck.conformance.cases.library import find_disagreements
from pantocheck.conformance.cases.study_tables import DropTest, WireName
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.measured_table import Axis
from pantocheck.conformance.drops.drop_record import DropRecord
from pantocheck.conformance.drops.drop_simulation import SHORT_NAME, SimulatedDrop, require_mass_drop, simulate_drop
from pantocheck.conformance.line.catenary_model import build_catenary

WIRE_NAMES: dict[str, WireName] = {"CW": "contact_wire", "MW": "messenger_wire"}
"""Wire of a case file by its short name in a record."""


@dataclass(frozen=True)
class DropCampaign:
    """Factors of a campaign; an empty factor keeps the values of the case."""

    masses: tuple[float, ...] = ()
    """Masses [kg]."""
    places: tuple[tuple[WireName, float], ...] = ()
    """Wire and position of the mass [-, m]."""
    contact_tensions: tuple[float, ...] = ()
    messenger_tensions: tuple[float, ...] = ()
    """Tensions of one contact wire and of the messenger wire [N]."""
    repeats: int = 1
    """Number of records of each drop, which differ in their noise."""


@dataclass(frozen=True)
class SensorChain:
    """Sensors of a campaign."""

    axes: tuple[Axis, ...]
    """Axes of each sensor."""
    noise: float
    """RMS of the white noise of each channel [SI unit of the record]."""
    seed: int
    """Seed of the noise of the campaign."""


def list_tension_changes(campaign: DropCampaign) -> tuple[tuple[InputChange, ...], ...]:
    """Changes of the line of a case for every combination of tensions; one empty combination without tensions."""
    factors = (
        ("contact", campaign.contact_tensions),
        ("messenger", campaign.messenger_tensions),
    )
    changes = [
        [build_change(f"line.{wire}_wire.tension_N", tension, f"option --{wire}-tension") for tension in tensions]
        for wire, tensions in factors
        if tensions
    ]
    return tuple(product(*changes))


def list_drops(case: Case, campaign: DropCampaign) -> tuple[DropTest, ...]:
    """Drops of a case for every combination of mass and place.

    Raises:
        InputError: A place is not on the line.
    """
    drops = require_mass_drop(case).drop
    masses = campaign.masses or tuple(dict.fromkeys(drop.mass_kg for drop in drops))
    places = campaign.places or tuple(dict.fromkeys((drop.wire, drop.x_m) for drop in drops))
    if not (campaign.masses or campaign.places):
        return drops
    release = drops[0].release_s
    chosen = tuple(
        DropTest(mass_kg=mass, wire=wire, x_m=x, release_s=release) for mass, (wire, x) in product(masses, places)
    )
    if wrong := [*find_disagreements(_replace_drops(case, chosen), "options --mass and --place")]:
        raise wrong[0]
    return chosen


def require_axes(case: Case, axes: tuple[Axis, ...]) -> None:
    """Require that the model of a line has the axes of the sensors.

    Raises:
        InputError: The model has no motion along an axis.
    """
    if "x" in axes:
        raise InputError(
            "option --axes",
            "the model has no motion along the track (x)",
            "Give z, or z,y on a line with stagger.",
        )
    if "y" in axes and not build_catenary(case.line).has_lateral_field:
        raise InputError(
            f"case '{case.id}', option --axes",
            "the line has no stagger, so that its model has no lateral motion (y)",
            "Give --axes z, or a line with stagger.",
        )


def simulate_records(
    case: Case, drop: DropTest, sensors: SensorChain, records: range, progress: Callable[[float], None] | None = None
) -> Iterator[tuple[DropRecord, SimulatedDrop]]:
    """Simulate one drop of a campaign; yield its records, which differ in their noise.

    Args:
        case, drop, sensors: Line, drop, and axes and noise of the sensors.
        records: Numbers of the records in the campaign, from 0. Noise depends on the seed and on the number only.
        progress: Function that receives the completed share of the simulation, 0 to 1.
    """
    simulation = simulate_drop(_replace_drops(case, (drop,)), 1, progress, axes=sensors.axes)
    clean = simulation.record
    for repeat, number in enumerate(records, 1):
        noise = np.random.default_rng((sensors.seed, number)).standard_normal(clean.signals.shape)
        name = _name_drop(case, drop) + (f", record {repeat}" if len(records) > 1 else "")
        yield replace(clean, name=name, signals=clean.signals + sensors.noise * noise), simulation


def _replace_drops(case: Case, drops: tuple[DropTest, ...]) -> Case:
    """Case with other drops and without noise."""
    mass_drop = require_mass_drop(case).model_copy(update={"drop": drops, "noise_rms": 0.0})
    return replace(case, file=case.file.model_copy(update={"mass_drop": mass_drop}))


def _name_drop(case: Case, drop: DropTest) -> str:
    line = case.line
    tensions = f"CW {line.contact_wire.tension_N:g} N, MW {line.messenger_wire.tension_N:g} N"
    return f"{case.id} {drop.mass_kg:g} kg {SHORT_NAME[drop.wire]} {drop.x_m:g} m, {tensions}"
