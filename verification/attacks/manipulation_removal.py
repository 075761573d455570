"""Manipulations that remove channels, supports, pantographs, samples or keys of the sidecar."""

import random

import numpy as np

from verification.attacks.manipulation_dossier import STEMS, Dossier, channel_kind


def drop_column(dossier: Dossier, chance: random.Random) -> str | None:
    """Remove one column."""
    if (name := dossier.choose(chance, *STEMS, "time")) is None:
        return None
    del dossier.columns[name]
    return f"drop column of {channel_kind(name)}"


def drop_channel(dossier: Dossier, chance: random.Random) -> str | None:
    """Remove all columns of a kind of channel."""
    stem = chance.choice(STEMS)
    for name in dossier.names(stem):
        del dossier.columns[name]
    return f"drop channel {stem}"


def _remove_support(dossier: Dossier, number: int) -> None:
    """Remove a support from sidecar and table, and number the others anew."""
    rows = {int(name.split("_")[1]): dossier.columns.pop(name) for name in dossier.names("uplift")}
    supports = dossier.sidecar.get("support_position_m", [])
    kept = [i for i in rows if i != number and i <= len(supports)]
    dossier.sidecar["support_position_m"] = [supports[i - 1] for i in kept]
    dossier.columns |= {f"uplift_{new}_m": rows[old] for new, old in enumerate(kept, 1)}


def drop_support(dossier: Dossier, chance: random.Random) -> str | None:
    """Remove a support without a trace."""
    names = [name for name in dossier.names("uplift") if name.endswith("_m")]
    if len(names) < 2:
        return None
    worst = max(names, key=lambda name: float(np.nanmax(dossier.columns[name])))
    name = chance.choice((worst, chance.choice(names)))
    _remove_support(dossier, int(name.split("_")[1]))
    return "drop the support of the largest uplift" if name == worst else "drop a support"


def drop_pantograph(dossier: Dossier, chance: random.Random) -> str | None:
    """Remove a pantograph from the table, with or without the number in the sidecar."""
    number = chance.choice((1, 2))
    if not dossier.names(f"force_{3 - number}_"):
        return None
    for stem in STEMS[:3]:
        for name in dossier.names(f"{stem}_{number}_"):
            del dossier.columns[name]
        if number == 1:
            for name in dossier.names(f"{stem}_2_"):
                dossier.columns[name.replace("_2_", "_1_")] = dossier.columns.pop(name)
    if chance.random() < 0.5:
        dossier.sidecar["pantographs"] = 1
    return f"drop pantograph {number}"


def drop_samples(dossier: Dossier, chance: random.Random) -> str | None:
    """Remove samples at the start, the end, in the middle, where the force is largest, or at random."""
    if not dossier.columns:
        return None
    n = len(next(iter(dossier.columns.values())))
    count = max(1, int(n * chance.choice((0.0005, 0.01, 0.1, 0.3, 0.5))))
    where = chance.choice(("start", "end", "middle", "largest force", "largest uplift", "random"))
    keep = np.ones(n, dtype=bool)
    match where:
        case "start":
            keep[:count] = False
        case "end":
            keep[-count:] = False
        case "middle":
            first = chance.randrange(n)
            keep[first : first + count] = False
        case "random":
            keep[np.random.default_rng(chance.randrange(10**6)).integers(n, size=count)] = False
        case _:
            if (name := dossier.choose(chance, where.split()[1])) is None:
                return None
            centre = int(np.argmax(dossier.columns[name]))
            keep[max(0, centre - count // 2) : centre + count // 2 + 1] = False
    if keep.sum() < 2:
        return None
    closed = chance.random() < 0.5
    step = dossier.columns.get("time_s", np.arange(2.0))[:2]
    dossier.columns = {name: column[keep] for name, column in dossier.columns.items()}
    if closed and "time_s" in dossier.columns:  # the gap is hidden by an even time axis
        dossier.columns["time_s"] = step[0] + (step[1] - step[0]) * np.arange(keep.sum())
    return f"drop samples, {where}{', gap closed' if closed else ''}"


def drop_key(dossier: Dossier, chance: random.Random) -> str | None:
    """Remove a key of the sidecar."""
    key = chance.choice(sorted(dossier.sidecar)) if dossier.sidecar else None
    if key is None:
        return None
    del dossier.sidecar[key]
    return f"drop key {key}"
