"""Logger files of measured runs, with a force that is known."""

from pathlib import Path

import numpy as np
import tomli_w

RATE = 250.0

FORCE_PROFILE = """
schema = "pantocheck.profile/1"
name = "force"
title = "Force"
rule = [
    { quantity = "mean_force_N", upper = { per_speed_squared = 0.00097, constant = 70.0 } },
    { quantity = "cov_20", upper = 0.3 },
    { quantity = "contact_loss_pct", upper = 0.1 },
]
"""
"""Rules that the runs pass without a dip."""


def write_run(
    folder: Path,
    name: str,
    *,
    ends_km: tuple[float, float] = (9.9, 12.1),
    day: int = 1,
    speed_km_h: float = 250.0,
    mean: float = 100.0,
    dip_km: float | None = None,
    wide_km: tuple[float, float] = (0.0, 0.0),
    rough_N: float = 0.0,
    shift_km: float = 0.0,
    seed: int = 0,
) -> Path:
    """Write a German logger file (kN, decimal comma) with its sidecar; the kilometres run from the first to the last.

    The force has a sigma of 20 N by spans of 50 m and noise; a dip of 150 N and 2 m is a broken dropper;
    between `wide_km` the sigma is 30 N. A rough line adds the same random force to every run. The kilometres of the
    file are too high by `shift_km`.
    """
    random = np.random.default_rng((37, seed))
    begin, end = ends_km
    time = np.arange(0, 3600 * abs(end - begin) / speed_km_h, 1 / RATE)
    km = begin + np.sign(end - begin) * speed_km_h / 3600 * time
    swing = np.where((km >= wide_km[0]) & (km < wide_km[1]), 42.0, 28.0)
    true_km = km - shift_km
    force = mean + swing * np.sin(2 * np.pi * true_km / 0.05) + random.normal(0, 3, time.size)
    if rough_N:
        marks = np.arange(8.0, 25.0, 0.003)
        force += np.interp(true_km, marks, rough_N * np.random.default_rng(37).standard_normal(marks.size))
    if dip_km is not None:
        force -= 150 * np.exp(-((1000 * (km - dip_km)) ** 2) / 8)
    rows = np.column_stack([time, km, force / 1000])
    lines = ["Zeit [s];km;Kraft [kN]", *(";".join(f"{x:.6f}" for x in row).replace(".", ",") for row in rows)]
    path = folder / f"{name}.csv"
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    sidecar = {
        "schema": "pantocheck.record/1",
        "file": path.name,
        "speed_km_h": speed_km_h,
        "pantographs": 1,
        "filter_applied_Hz": "none",
        "line": {"wave_speed_m_s": 120.0, "uplift_space_mm": 120.0},
        "columns": {
            "time_s": {"column": "Zeit [s]"},
            "position_1_m": {"column": "km", "unit": "km"},
            "force_1_N": {"column": "Kraft [kN]"},
        },
        "track": {"zero_km": begin, "kilometres": "increasing" if end > begin else "decreasing"},
    }
    text = tomli_w.dumps(sidecar) + f'\n[measurement]\nline = "1700"\ntrack = "2"\ndate = 2026-05-{day:02d}\n'
    path.with_suffix(".toml").write_text(text, encoding="utf-8")
    return path
