"""Manipulations of units, names and order of columns and supports."""

import random

from verification.attacks.manipulation_dossier import STEMS, Dossier, channel_kind

UNITS = {
    "s": {"s": 1.0, "ms": 1e-3},
    "m": {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "km": 1e3},
    "N": {"N": 1.0, "kN": 1e3, "daN": 10.0},
}
"""Units of the columns, with their factors to SI."""


def relabel_unit(dossier: Dossier, chance: random.Random) -> str | None:
    """Change the unit in the name of columns, but not their numbers."""
    stem = chance.choice((*STEMS, "time"))
    unit = {"force": "N", "time": "s"}.get(stem, "m")
    other = chance.choice([label for label in UNITS[unit] if label != unit])
    ending = f"_{unit}"
    dossier.columns = {
        name.removesuffix(ending) + f"_{other}" if name.startswith(stem) and name.endswith(ending) else name: column
        for name, column in dossier.columns.items()
    }
    return f"call {stem} {other}"


def convert_unit(dossier: Dossier, chance: random.Random) -> str | None:
    """Convert a kind of channel to another unit; without effect on any quantity."""
    stem = chance.choice((*STEMS, "time"))
    unit = {"force": "N", "time": "s"}.get(stem, "m")
    other, factor = chance.choice([pair for pair in UNITS[unit].items() if pair[0] != unit])
    ending = f"_{unit}"
    dossier.columns = dict(
        (name.removesuffix(ending) + f"_{other}", column / factor)
        if name.startswith(stem) and name.endswith(ending)
        else (name, column)
        for name, column in dossier.columns.items()
    )
    return f"convert {stem} to {other}"


def reorder_columns(dossier: Dossier, chance: random.Random) -> str | None:
    """Change the order of the columns; without effect on any quantity."""
    names = chance.sample(list(dossier.columns), len(dossier.columns))
    dossier.columns = {name: dossier.columns[name] for name in names}
    return "reorder columns"


def reorder_supports(dossier: Dossier, chance: random.Random) -> str | None:
    """Number the supports in another order; without effect on any quantity."""
    supports = dossier.sidecar.get("support_position_m")
    names = [f"uplift_{i}_m" for i in range(1, len(supports or ()) + 1)]
    if not supports or not all(name in dossier.columns for name in names):
        return None
    order = chance.sample(range(len(supports)), len(supports))
    dossier.sidecar["support_position_m"] = [supports[i] for i in order]
    rows = [dossier.columns[names[i]] for i in order]
    dossier.columns |= dict(zip(names, rows, strict=True))
    return "reorder supports"


def rename_column(dossier: Dossier, chance: random.Random) -> str | None:
    """Give a column another number, another channel or an unknown name."""
    if (name := dossier.choose(chance, *STEMS)) is None:
        return None
    kind = chance.choice(("number", "channel", "unknown"))
    number = name.removeprefix(channel_kind(name)).split("_")[1]
    new = {
        "number": name.replace(f"_{number}_", f"_{chance.choice((1, 2, 3, 7, 99))}_"),
        "channel": name.replace(channel_kind(name), chance.choice(STEMS)),
        "unknown": f"x_{name}",
    }[kind]
    if new == name:
        return None
    dossier.columns[new] = dossier.columns.pop(name)
    return f"rename {channel_kind(name)}: {kind}"
