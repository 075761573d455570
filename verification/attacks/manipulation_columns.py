"""Manipulations that remove channels, supports, pantographs, samples or keys of the sidecar."""

import random

import numpy as np
from scipy.signal import butter, sosfiltfilt

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


# Manipulations of units, names and order of columns and supports.
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


# Manipulations that shift pantographs, supports or channels along the track or in time.
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


# Manipulations that change the samples of a channel or their rate.
def rescale(dossier: Dossier, chance: random.Random) -> str | None:
    """Multiply all columns of a kind of channel, or one of them."""
    stem = chance.choice((*STEMS, "time"))
    names = dossier.names(stem)
    if not names:
        return None
    names = chance.choice((names, [chance.choice(names)]))
    factor = chance.choice((-1.0, 1e-3, 0.1, 0.5, 0.9, 1.1, 2.0, 10.0, 1e3))
    dossier.columns |= {name: factor * dossier.columns[name] for name in names}
    return f"multiply {stem}{'' if len(names) > 1 else ' of one'} by {factor:g}"


def smooth(dossier: Dossier, chance: random.Random) -> str | None:
    """Filter a channel, stated or not."""
    stem, cutoff = chance.choice(("force", "contact_height", "uplift")), chance.choice((2.0, 5.0, 10.0, 15.0, 20.0))
    names = dossier.names(stem)
    if not names or len(dossier.columns[names[0]]) < 100:
        return None
    sections = butter(3, cutoff, fs=1000.0, output="sos")
    dossier.columns |= {name: sosfiltfilt(sections, dossier.columns[name]) for name in names}
    stated = chance.random() < 0.5
    if stated:
        dossier.sidecar["filter_applied_Hz"] = chance.choice((cutoff, 20.0))
    return f"filter {stem} at {cutoff:g} Hz{', stated' if stated else ''}"


def hold(dossier: Dossier, chance: random.Random) -> str | None:
    """Replace a column by zero or by its first value, as from a dead sensor."""
    if (name := dossier.choose(chance, "force", "contact_height", "uplift")) is None:
        return None
    value = chance.choice((0.0, float(dossier.columns[name][0])))
    dossier.columns[name] = np.full(len(dossier.columns[name]), value)
    return f"hold {channel_kind(name)}"


def change_rate(dossier: Dossier, chance: random.Random) -> str | None:
    """Keep every nth sample, or call the rate another one."""
    if "time_s" not in dossier.columns:
        return None
    if chance.random() < 0.5:
        n = chance.choice((2, 4, 5, 10, 20, 50))
        dossier.columns = {name: column[::n] for name, column in dossier.columns.items()}
        return f"keep every sample of {n}"
    factor = chance.choice((0.5, 0.9, 0.996, 1.004, 1.1, 2.0))
    dossier.columns["time_s"] = factor * dossier.columns["time_s"]
    return f"time axis {factor:g} times as long"


def thin_samples(dossier: Dossier, chance: random.Random) -> str:
    """Keep every nth sample, from any of the first n."""
    n = chance.choice((2, 3, 4, 5, 10, 20))
    first = chance.randrange(n)
    dossier.columns = {name: column[first::n] for name, column in dossier.columns.items()}
    return f"keep every sample of {n}"


def round_numbers(dossier: Dossier, chance: random.Random) -> str | None:
    """Round a kind of channel to steps, to the nearest or downwards."""
    stem, step = chance.choice(
        (
            *(("force", step) for step in (0.1, 0.5, 1.0, 2.0, 5.0, 10.0)),
            *(("contact_height", step) for step in (1e-3, 5e-3)),
            *(("uplift", step) for step in (1e-4, 1e-3, 2e-3, 5e-3)),
        )
    )
    turn = chance.choice((np.round, np.floor))
    names = dossier.names(stem)
    if not names:
        return None
    dossier.columns |= {name: turn(dossier.columns[name] / step) * step for name in names}
    return f"round {stem} to {step:g}{' downwards' if turn is np.floor else ''}"
