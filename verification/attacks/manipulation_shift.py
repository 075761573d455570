"""Manipulations that shift pantographs, supports or channels along the track or in time."""

import random

import numpy as np

from verification.attacks.manipulation_dossier import STEMS, Dossier, channel_kind


def shift_positions(dossier: Dossier, chance: random.Random) -> str | None:
    """Shift the positions of one or all pantographs."""
    names = dossier.names("position")
    if not names:
        return None
    names = chance.choice((names, [chance.choice(names)]))
    shift = chance.choice((-60.0, -20.0, -5.0, -1.0, 1.0, 5.0, 20.0, 40.0, 60.0, 120.0))
    dossier.columns |= {name: dossier.columns[name] + shift for name in names}
    return f"shift positions of {'one pantograph' if len(names) == 1 else 'all'} by {abs(shift):g} m"


def shift_supports(dossier: Dossier, chance: random.Random) -> str | None:
    """Shift the position of one or all supports in the sidecar."""
    supports = dossier.sidecar.get("support_position_m")
    if not supports:
        return None
    shift = chance.choice((-60.0, -5.0, -1.0, -0.4, -0.001, 0.001, 0.4, 1.0, 5.0, 60.0))
    chosen = chance.choice((range(len(supports)), [chance.randrange(len(supports))]))
    dossier.sidecar["support_position_m"] = [x + shift if i in chosen else x for i, x in enumerate(supports)]
    return f"shift {'one support' if len(chosen) == 1 else 'all supports'} by {abs(shift):g} m"


def shift_track(dossier: Dossier, chance: random.Random) -> str | None:
    """Shift pantographs and supports together, as from another origin of the track."""
    shift = chance.choice((-120.0, -60.0, -20.0, 20.0, 60.0, 120.0))
    supports = dossier.sidecar.get("support_position_m")
    dossier.columns |= {name: dossier.columns[name] + shift for name in dossier.names("position")}
    if supports:
        dossier.sidecar["support_position_m"] = [x + shift for x in supports]
    return f"shift the track by {abs(shift):g} m"


def shift_time(dossier: Dossier, chance: random.Random) -> str | None:
    """Shift one channel in time; samples beyond the end are repeated."""
    if (name := dossier.choose(chance, *STEMS)) is None:
        return None
    shift = chance.choice((-200, -50, -10, -2, 2, 10, 50, 200))
    column = dossier.columns[name]
    dossier.columns[name] = column[np.clip(np.arange(len(column)) + shift, 0, len(column) - 1)]
    return f"shift {channel_kind(name)} in time by {abs(shift)} samples"


def shift_clock(dossier: Dossier, chance: random.Random) -> str | None:
    """Change the zero of time; without effect on any quantity."""
    for name in dossier.names("time"):
        dossier.columns[name] = dossier.columns[name] + chance.choice((-3.0, 0.5, 100.0))
    return "shift the clock"
