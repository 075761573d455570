"""Manipulations of the settings in sidecar, case and limits file."""

import random

from verification.attacks.manipulation_columns import (
    change_rate,
    convert_unit,
    drop_channel,
    drop_column,
    drop_key,
    drop_pantograph,
    drop_samples,
    drop_support,
    hold,
    relabel_unit,
    rename_column,
    reorder_columns,
    reorder_supports,
    rescale,
    round_numbers,
    shift_clock,
    shift_positions,
    shift_supports,
    shift_time,
    shift_track,
    smooth,
    thin_samples,
)
from verification.attacks.manipulation_dossier import Dossier, Manipulation
from verification.attacks.manipulation_trains import (
    change_support,
    copy_pantograph,
    merge_records,
    repeat_pantograph,
    smooth_one,
    smooth_together,
    split_train,
    swap_pantographs,
    swap_supports,
)


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


# Grammar of the manipulation campaign: each manipulation removes, moves, relabels or mixes information of a run.
#
# No manipulation invents physics: it changes or copies channels of a run, but solves no equation of motion.
MANIPULATIONS: tuple[tuple[str, Manipulation], ...] = (
    ("drop", drop_column),
    ("drop", drop_channel),
    ("drop", drop_support),
    ("drop", drop_pantograph),
    ("drop", drop_samples),
    ("drop", drop_key),
    ("positions", shift_positions),
    ("positions", shift_supports),
    ("positions", shift_track),
    ("shift", shift_time),
    ("shift", shift_clock),
    ("split", repeat_pantograph),
    ("split", split_train),
    ("split", swap_pantographs),
    ("split", swap_supports),
    ("scale", rescale),
    ("scale", relabel_unit),
    ("scale", smooth),
    ("scale", hold),
    ("reexpress", convert_unit),
    ("reexpress", reorder_columns),
    ("reexpress", reorder_supports),
    ("rename", rename_column),
    ("rate", change_rate),
    ("section", change_section),
    ("sidecar", change_sidecar),
    ("merge", merge_records),
    ("case", change_case),
    ("limits", add_limits_file),
    ("channels", change_support),
    ("channels", smooth_one),
    ("channels", smooth_together),
    ("channels", copy_pantograph),
    ("thin", thin_samples),
    ("thin", round_numbers),
)
"""Group and function of every manipulation; a trial draws from them by position."""
