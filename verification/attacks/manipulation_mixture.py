"""Manipulations that mix the channels of two pantographs, two supports or two runs."""

import random

import numpy as np

from verification.attacks.manipulation_dossier import STEMS, Dossier


def repeat_pantograph(dossier: Dossier, chance: random.Random) -> str | None:
    """Write the data of one pantograph as those of the other."""
    source = chance.choice((1, 2))
    stems = chance.choice((("force",), ("force", "contact_height"), STEMS[:3]))
    for stem in stems:
        first, second = (f"{stem}_{number}_{'N' if stem == 'force' else 'm'}" for number in (source, 3 - source))
        if first in dossier.columns and second in dossier.columns:
            dossier.columns[second] = dossier.columns[first]
    return f"pantograph {source} as the other: {', '.join(stems)}"


def split_train(dossier: Dossier, chance: random.Random) -> str | None:
    """Deliver the pantographs of a train with other spacing, as if from separate runs."""
    if "position_2_m" not in dossier.columns or "position_1_m" not in dossier.columns:
        return None
    spacing = chance.choice((0.0, 40.0, 60.0, 100.4, 160.0))
    dossier.columns["position_2_m"] = dossier.columns["position_1_m"] - spacing
    return f"spacing of {spacing:g} m in the table"


def swap_pantographs(dossier: Dossier, chance: random.Random) -> str | None:
    """Exchange channels of the two pantographs."""
    stems = chance.choice((("force",), ("force", "contact_height"), ("position",), STEMS[:3]))
    for stem in stems:
        first, second = (f"{stem}_{number}_{'N' if stem == 'force' else 'm'}" for number in (1, 2))
        if first in dossier.columns and second in dossier.columns:
            pair = dossier.columns[second], dossier.columns[first]
            dossier.columns[first], dossier.columns[second] = pair
    return f"swap pantographs: {', '.join(stems)}"


def swap_supports(dossier: Dossier, chance: random.Random) -> str | None:
    """Exchange the uplift of two supports."""
    names = dossier.names("uplift")
    if len(names) < 2:
        return None
    first, second = chance.sample(names, 2)
    dossier.columns[first], dossier.columns[second] = dossier.columns[second], dossier.columns[first]
    return "swap two supports"


def merge_records(dossier: Dossier, chance: random.Random) -> str | None:
    """Take a part from the run of a weaker pantograph, whose values are within the limits."""
    if dossier.other is None:
        return None
    part = chance.choice(("uplift", "force", "contact_height", "force_1", "force_2", "first half", "second half"))
    other = dossier.other.columns
    n = min(len(column) for column in (*dossier.columns.values(), *other.values())) if dossier.columns else 0
    for name, column in dossier.columns.items():
        if name not in other:
            continue
        if part.endswith("half"):
            middle = n // 2
            halves = (other[name][:middle], column[middle:n])
            halves = halves if part.startswith("first") else (column[:middle], other[name][middle:n])
            dossier.columns[name] = np.concatenate(halves)
        else:
            dossier.columns[name] = (other[name] if name.startswith(part) else column)[:n]
    return f"from another run: {part}"
