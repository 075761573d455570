"""Manipulations that mix the channels of two pantographs, two supports or two runs."""

import random

import numpy as np
from scipy.signal import butter, sosfilt, sosfiltfilt

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


# Manipulations of one support or one pantograph that keep the channels as consistent as possible.
PAIR = ("force_{}_N", "contact_height_{}_m")
"""Columns of a pantograph that its equations of motion connect."""


def change_support(dossier: Dossier, chance: random.Random) -> str | None:
    """Hold, clip or scale the uplift of one support, often that of the largest uplift."""
    names = dossier.names("uplift")
    if not names:
        return None
    worst = max(names, key=lambda name: float(np.nanmax(dossier.columns[name])))
    name = chance.choice((worst, chance.choice(names)))
    uplift, kind, share = (
        dossier.columns[name],
        chance.choice(("hold", "clip", "scale")),
        chance.choice((0.5, 0.8, 0.95)),
    )
    if kind == "hold":  # from a share of the largest uplift until it falls below that share for the last time
        above = np.flatnonzero(uplift >= share * np.nanmax(uplift))
        uplift = uplift.copy()
        uplift[above[0] : above[-1]] = uplift[above[0]]
    elif kind == "clip":
        uplift = np.minimum(uplift, share * np.nanmax(uplift))
    else:
        uplift = share * uplift
    dossier.columns[name] = uplift
    return f"{kind} the uplift of one support at {share:g}"


def _smooth(column: np.ndarray, cutoff: float, phase: str) -> np.ndarray:
    """Filter of order 6 at 1000 samples per second."""
    if phase == "zero":
        return np.asarray(sosfiltfilt(butter(3, cutoff, fs=1000.0, output="sos"), column))
    return np.asarray(sosfilt(butter(6, cutoff, fs=1000.0, output="sos"), column - column[0])) + column[0]


def smooth_one(dossier: Dossier, chance: random.Random) -> str | None:
    """Filter the force of one pantograph, the front one or the rear one, without a statement."""
    return _smooth_columns(dossier, chance, (PAIR[0],), (5.0, 10.0, 15.0, 20.0), [chance.choice((1, 2))])


def smooth_together(dossier: Dossier, chance: random.Random) -> str | None:
    """Filter force and contact height of one or both pantographs in the same way."""
    numbers = chance.choice(([1], [2], [1, 2]))
    kind = _smooth_columns(dossier, chance, PAIR, (1.0, 2.0, 5.0, 8.0, 10.0, 12.0), numbers)
    if kind is not None and chance.random() < 0.3:
        dossier.sidecar["filter_applied_Hz"] = 20.0
        return f"{kind}, stated as 20 Hz"
    return kind


def _smooth_columns(
    dossier: Dossier, chance: random.Random, stems: tuple[str, ...], cutoffs: tuple[float, ...], numbers: list[int]
) -> str | None:
    names = [stem.format(number) for number in numbers for stem in stems]
    if any(name not in dossier.columns or len(dossier.columns[name]) < 100 for name in names):
        return None
    cutoff, phase = chance.choice(cutoffs), chance.choice(("zero", "causal"))
    dossier.columns |= {name: _smooth(dossier.columns[name], cutoff, phase) for name in names}
    channels = "force and height" if len(stems) > 1 else "force"
    where = "both" if len(numbers) > 1 else f"pantograph {numbers[0]}"
    return f"filter {channels} of {where} at {cutoff:g} Hz, {phase} phase"


def copy_pantograph(dossier: Dossier, chance: random.Random) -> str | None:
    """Replace force, or force and height, of one pantograph by those of the other at the same place."""
    source = chance.choice((1, 2))
    stems = chance.choice((PAIR[:1], PAIR))
    names = [stem.format(number) for stem in stems for number in (1, 2)]
    if any(name not in dossier.columns for name in ("time_s", "position_1_m", "position_2_m", *names)):
        return None
    place, time = dossier.columns[f"position_{source}_m"], dossier.columns["time_s"]
    if not np.all(np.diff(place) > 0):
        return None
    moment = np.interp(dossier.columns[f"position_{3 - source}_m"], place, time)
    for stem in stems:
        column = np.interp(moment, time, dossier.columns[stem.format(source)])
        dossier.columns[stem.format(3 - source)] = column
    return f"pantograph {source} as the other at the same place: {'force and height' if len(stems) > 1 else 'force'}"
