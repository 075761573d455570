"""Grammar of the manipulation campaign: each manipulation removes, moves, relabels or mixes information of a run.

No manipulation invents physics: a force and a height that are changed consistently are another record, which no check
can tell from a real one.
"""

import random
from collections.abc import Callable
from copy import deepcopy
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.signal import butter, sosfiltfilt

COMPARED = frozenset(
    {
        "mean_force_N", "std_force_N", "std_force_50_N", "max_force_N", "min_force_N", "statistical_max_N",
        "statistical_min_N", "contact_loss_pct", "max_uplift_at_support_mm", "contact_height_range_mm",
    }
)  # fmt: skip
"""Quantities that the cases of the campaign limit."""

STEMS = ("position", "force", "contact_height", "uplift")

UNITS = {
    "s": {"s": 1.0, "ms": 1e-3},
    "m": {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "km": 1e3},
    "N": {"N": 1.0, "kN": 1e3, "daN": 10.0},
}


@dataclass
class Dossier:
    """Files of a run: case, line, pantograph, columns of the table, sidecar, limits file; `other` is a second run."""

    case: dict[str, Any]
    line: dict[str, Any]
    pantograph: dict[str, Any]
    columns: dict[str, np.ndarray]
    sidecar: dict[str, Any]
    limits: dict[str, Any] | None
    other: "Dossier | None" = None

    def copy(self) -> "Dossier":
        """Copy whose tables can be changed; arrays are shared and must be replaced."""
        tables = {name: deepcopy(getattr(self, name)) for name in ("case", "line", "pantograph", "sidecar", "limits")}
        return replace(self, columns=dict(self.columns), **tables)

    def names(self, *stems: str) -> list[str]:
        """Columns of some kinds of channel."""
        return [name for name in self.columns if name.startswith(stems)]

    def choose(self, chance: random.Random, *stems: str) -> str | None:
        """Random column of some kinds of channel."""
        names = self.names(*stems)
        return chance.choice(names) if names else None


Manipulation = Callable[[Dossier, random.Random], str | None]
"""Change of a dossier; the result is the name of its kind, or None if it does not apply."""

MANIPULATIONS: list[tuple[str, Manipulation]] = []
"""Group and function of every manipulation."""


def _group(name: str) -> Callable[[Manipulation], Manipulation]:
    def register(manipulation: Manipulation) -> Manipulation:
        MANIPULATIONS.append((name, manipulation))
        return manipulation

    return register


def _stem(column: str) -> str:
    return next((stem for stem in STEMS if column.startswith(stem)), "time")


@_group("drop")
def drop_column(dossier: Dossier, chance: random.Random) -> str | None:
    """Remove one column."""
    if (name := dossier.choose(chance, *STEMS, "time")) is None:
        return None
    del dossier.columns[name]
    return f"drop column of {_stem(name)}"


@_group("drop")
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


@_group("drop")
def drop_support(dossier: Dossier, chance: random.Random) -> str | None:
    """Remove a support without a trace."""
    names = [name for name in dossier.names("uplift") if name.endswith("_m")]
    if len(names) < 2:
        return None
    worst = max(names, key=lambda name: float(dossier.columns[name].max()))
    name = chance.choice((worst, chance.choice(names)))
    _remove_support(dossier, int(name.split("_")[1]))
    return "drop the support of the largest uplift" if name == worst else "drop a support"


@_group("drop")
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


@_group("drop")
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


@_group("drop")
def drop_key(dossier: Dossier, chance: random.Random) -> str | None:
    """Remove a key of the sidecar."""
    key = chance.choice(sorted(dossier.sidecar)) if dossier.sidecar else None
    if key is None:
        return None
    del dossier.sidecar[key]
    return f"drop key {key}"


@_group("positions")
def shift_positions(dossier: Dossier, chance: random.Random) -> str | None:
    """Shift the positions of one or all pantographs."""
    names = dossier.names("position")
    if not names:
        return None
    names = chance.choice((names, [chance.choice(names)]))
    shift = chance.choice((-60.0, -20.0, -5.0, -1.0, 1.0, 5.0, 20.0, 40.0, 60.0, 120.0))
    dossier.columns |= {name: dossier.columns[name] + shift for name in names}
    return f"shift positions of {'one pantograph' if len(names) == 1 else 'all'} by {abs(shift):g} m"


@_group("positions")
def shift_supports(dossier: Dossier, chance: random.Random) -> str | None:
    """Shift the position of one or all supports in the sidecar."""
    supports = dossier.sidecar.get("support_position_m")
    if not supports:
        return None
    shift = chance.choice((-60.0, -5.0, -1.0, -0.4, -0.001, 0.001, 0.4, 1.0, 5.0, 60.0))
    chosen = chance.choice((range(len(supports)), [chance.randrange(len(supports))]))
    dossier.sidecar["support_position_m"] = [x + shift if i in chosen else x for i, x in enumerate(supports)]
    return f"shift {'one support' if len(chosen) == 1 else 'all supports'} by {abs(shift):g} m"


@_group("positions")
def shift_track(dossier: Dossier, chance: random.Random) -> str | None:
    """Shift pantographs and supports together, as from another origin of the track."""
    shift = chance.choice((-120.0, -60.0, -20.0, 20.0, 60.0, 120.0))
    supports = dossier.sidecar.get("support_position_m")
    dossier.columns |= {name: dossier.columns[name] + shift for name in dossier.names("position")}
    if supports:
        dossier.sidecar["support_position_m"] = [x + shift for x in supports]
    return f"shift the track by {abs(shift):g} m"


@_group("shift")
def shift_time(dossier: Dossier, chance: random.Random) -> str | None:
    """Shift one channel in time; samples beyond the end are repeated."""
    if (name := dossier.choose(chance, *STEMS)) is None:
        return None
    shift = chance.choice((-200, -50, -10, -2, 2, 10, 50, 200))
    column = dossier.columns[name]
    dossier.columns[name] = column[np.clip(np.arange(len(column)) + shift, 0, len(column) - 1)]
    return f"shift {_stem(name)} in time by {abs(shift)} samples"


@_group("shift")
def shift_clock(dossier: Dossier, chance: random.Random) -> str | None:
    """Change the zero of time; without effect on any quantity."""
    for name in dossier.names("time"):
        dossier.columns[name] = dossier.columns[name] + chance.choice((-3.0, 0.5, 100.0))
    return "shift the clock"


@_group("split")
def repeat_pantograph(dossier: Dossier, chance: random.Random) -> str | None:
    """Write the data of one pantograph as those of the other."""
    source = chance.choice((1, 2))
    stems = chance.choice((("force",), ("force", "contact_height"), STEMS[:3]))
    for stem in stems:
        first, second = (f"{stem}_{number}_{'N' if stem == 'force' else 'm'}" for number in (source, 3 - source))
        if first in dossier.columns and second in dossier.columns:
            dossier.columns[second] = dossier.columns[first]
    return f"pantograph {source} as the other: {', '.join(stems)}"


@_group("split")
def split_train(dossier: Dossier, chance: random.Random) -> str | None:
    """Deliver the pantographs of a train with other spacing, as if from separate runs."""
    if "position_2_m" not in dossier.columns or "position_1_m" not in dossier.columns:
        return None
    spacing = chance.choice((0.0, 40.0, 60.0, 100.4, 160.0))
    dossier.columns["position_2_m"] = dossier.columns["position_1_m"] - spacing
    return f"spacing of {spacing:g} m in the table"


@_group("split")
def swap_pantographs(dossier: Dossier, chance: random.Random) -> str | None:
    """Exchange channels of the two pantographs."""
    stems = chance.choice((("force",), ("force", "contact_height"), ("position",), STEMS[:3]))
    for stem in stems:
        first, second = (f"{stem}_{number}_{'N' if stem == 'force' else 'm'}" for number in (1, 2))
        if first in dossier.columns and second in dossier.columns:
            pair = dossier.columns[second], dossier.columns[first]
            dossier.columns[first], dossier.columns[second] = pair
    return f"swap pantographs: {', '.join(stems)}"


@_group("split")
def swap_supports(dossier: Dossier, chance: random.Random) -> str | None:
    """Exchange the uplift of two supports."""
    names = dossier.names("uplift")
    if len(names) < 2:
        return None
    first, second = chance.sample(names, 2)
    dossier.columns[first], dossier.columns[second] = dossier.columns[second], dossier.columns[first]
    return "swap two supports"


@_group("scale")
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


@_group("scale")
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


@_group("scale")
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


@_group("scale")
def hold(dossier: Dossier, chance: random.Random) -> str | None:
    """Replace a column by zero or by its first value, as from a dead sensor."""
    if (name := dossier.choose(chance, "force", "contact_height", "uplift")) is None:
        return None
    value = chance.choice((0.0, float(dossier.columns[name][0])))
    dossier.columns[name] = np.full(len(dossier.columns[name]), value)
    return f"hold {_stem(name)}"


@_group("reexpress")
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


@_group("reexpress")
def reorder_columns(dossier: Dossier, chance: random.Random) -> str | None:
    """Change the order of the columns; without effect on any quantity."""
    names = chance.sample(list(dossier.columns), len(dossier.columns))
    dossier.columns = {name: dossier.columns[name] for name in names}
    return "reorder columns"


@_group("reexpress")
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


@_group("rename")
def rename_column(dossier: Dossier, chance: random.Random) -> str | None:
    """Give a column another number, another channel or an unknown name."""
    if (name := dossier.choose(chance, *STEMS)) is None:
        return None
    kind = chance.choice(("number", "channel", "unknown"))
    number = name.removeprefix(_stem(name)).split("_")[1]
    new = {
        "number": name.replace(f"_{number}_", f"_{chance.choice((1, 2, 3, 7, 99))}_"),
        "channel": name.replace(_stem(name), chance.choice(STEMS)),
        "unknown": f"x_{name}",
    }[kind]
    if new == name:
        return None
    dossier.columns[new] = dossier.columns.pop(name)
    return f"rename {_stem(name)}: {kind}"


@_group("rate")
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


@_group("section")
def change_section(dossier: Dossier, chance: random.Random) -> str | None:
    """Cut, shift, widen or turn the analysis section of the sidecar."""
    section = dossier.sidecar.get("evaluated_m")
    if section is None:
        return None
    start, end = section
    length = end - start
    kind, new = chance.choice(
        (
            ("cut at its end", [start, end - chance.choice((0.005, 0.5, 60.0)) * length / 120]),
            ("cut at its start", [start + chance.choice((0.005, 0.5, 60.0)) * length / 120, end]),
            ("shift", [start + 60.0, end + 60.0]),
            ("widen", [start - 60.0, end]),
            ("turn", [end, start]),
            ("one point", [start, start + 0.1]),
        )
    )
    dossier.sidecar["evaluated_m"] = new
    return f"analysis section: {kind}"


@_group("sidecar")
def change_sidecar(dossier: Dossier, chance: random.Random) -> str | None:
    """Change a key of the sidecar."""
    key, value = chance.choice(
        (
            ("spacing_m", [chance.choice((40.0, 60.0, 200.0))]),
            ("start_m", chance.choice((-60.0, 30.0, 60.0, 1e6))),
            ("speed_km_h", chance.choice((125.0, 240.0, 249.0, 251.0, 260.0, 500.0))),
            ("filter_applied_Hz", chance.choice((5.0, 19.0, 20.0, 20.001, 50.0, 1e9))),
            ("pantographs", chance.choice((1, 2, 3))),
            ("case", chance.choice(("en50318-2002/300", "own/other"))),
            ("sha256", "0" * 64),
            ("line", {"span_m": 30.0, "wave_speed_m_s": 500.0, "uplift_space_mm": 500.0}),
            ("schema", "pantocheck.summary/1"),
        )
    )
    if dossier.sidecar.get(key) == value:
        return None
    dossier.sidecar[key] = value
    return f"change key {key}"


@_group("merge")
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


@_group("case")
def change_case(dossier: Dossier, chance: random.Random) -> str | None:
    """Change the copy of a library case that keeps its id."""
    case = dossier.case
    kind = chance.choice(
        ("widen limits", "drop limits", "section", "lower trust", "speed", "filter", "pantograph", "line")
    )
    limits = case.get("limit", [])
    match kind:
        case "widen limits":
            for limit in limits:
                limit |= {"lower": -1e3, "upper": 1e3}
        case "drop limits":
            case["limit"] = chance.sample(limits, max(1, len(limits) // 4)) if limits else []
        case "section":
            case["evaluated_spans"] = [chance.choice((3, 4, 5))]
        case "lower trust":
            for limit in limits:
                limit["trust"] = "provisional"
        case "speed":
            case["speed_km_h"] = chance.choice((240.0, 249.0, 260.0))
        case "filter":
            case["filter"] = {**case["filter"], "cutoff_Hz": chance.choice((5.0, 10.0, 50.0))}
        case "pantograph":
            dossier.pantograph["chain"]["masses_kg"] = [12.0, 6.0]
        case _:
            dossier.line["contact_wire"]["tension_N"] = 25e3
    return f"copy of a library case: {kind}"


@_group("limits")
def add_limits_file(dossier: Dossier, chance: random.Random) -> str | None:
    """Give a limits file that lowers the trust of limits of the case, or that applies to other cases."""
    limits = dossier.case.get("limit")
    if not limits:
        return None
    kind, change = chance.choice((("lower trust", {"trust": "provisional"}), ("other case", {"case": "vovan2015/*"})))
    chosen = limits if kind == "lower trust" else [{**limit, "lower": -1e3, "upper": 1e3} for limit in limits]
    chosen = chance.choice((chosen, chance.sample(chosen, 1)))
    dossier.limits = {"limit": [{**limit, **change} for limit in chosen]}
    return f"limits file: {kind}"
