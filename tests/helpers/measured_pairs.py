"""Line test as it is measured: force on the train at 500 Hz, uplift at the masts at 200 Hz by a clock of their own."""

from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SPEED, SPACING = 70.0, 200.0


@dataclass(frozen=True)
class MeasuredPair:
    """Passage of a train under masts; the truth is known."""

    pantographs: int = 2
    supports: tuple[float, ...] = (300.0, 360.0, 420.0)
    offset: float = 3.217
    """Time of the record less the time of the masts, at the time 0 of the masts [s]."""
    drift: float = 0.0
    """Clock of the masts fast by this share [-]."""
    rate: float = 200.0
    noise: float = 0.0005
    """Standard deviation of the noise of the uplift [m]."""
    heights: tuple[float, ...] = (0.05, 0.042)
    """Uplift at the passage of each pantograph [m]."""
    times: tuple[float, float] = (-4.0, 16.0)
    """Start and end of the file of the masts in the time of the record [s]."""

    @property
    def behind(self) -> Array:
        """Distances of the pantographs behind the first one [m]."""
        return SPACING * np.arange(self.pantographs)

    def train(self) -> Array:
        """Time [s], position [m] and forces [N] of the train, 500 samples per second, one row per sample."""
        time = np.arange(0.0, 11.0, 0.002)
        random = np.random.default_rng(1)
        waves = [
            2 * np.pi * (time[:, None] * f + random.uniform(size=self.pantographs)) for f in (1.2, 7.3, 16.0, 38.0)
        ]
        force = 115 + 12 * sum(np.sin(wave) for wave in waves)
        return np.column_stack([time, SPEED * time, force])

    def masts(self) -> Array:
        """Time by the clock of the masts [s], and the uplift at each of them [mm], one row per sample."""
        time = np.arange(*self.times, 1 / self.rate)
        position = SPEED * time - self.behind[:, None]
        random = np.random.default_rng(2)
        columns = [(time - self.offset) * (1 + self.drift)]
        for place in self.supports:
            distance = position - place
            pulse = np.exp(-np.abs(distance) / 12) + 0.3 * np.where(
                distance > 0, np.sin(distance / 7) * np.exp(-distance / 150), 0
            )
            heights = np.array(self.heights[: self.pantographs])
            columns.append(1e3 * (heights @ pulse + self.noise * random.standard_normal(time.size)))
        return np.column_stack(columns)

    def write(self, folder: Path, join: str, further: str = "") -> Path:
        """Write both files with German headers and decimal commas, and their sidecar."""
        supports = range(1, len(self.supports) + 1)
        for name, text in zip(("zug.csv", "mast.csv"), format_files(self), strict=True):
            (folder / name).write_text(text, encoding="cp1252", newline="\n")
        spacing = f"spacing_m = [{SPACING}]\n" if self.pantographs == 2 else ""
        lines = [f'force_{n}_N = {{ column = "Kraft {n} [N]" }}' for n in range(1, self.pantographs + 1)]
        masts = [f'uplift_{n}_m = {{ column = "Anhub Mast {n} [mm]" }}' for n in supports]
        sidecar = folder / "fahrt.toml"
        sidecar.write_text(
            f"""schema = "pantocheck.record/1"
file = "zug.csv"
speed_km_h = {3.6 * SPEED}
pantographs = {self.pantographs}
filter_applied_Hz = "none"
evaluated_m = [{self.supports[0]}, {self.supports[-1]}]
support_position_m = {list(self.supports)}
{spacing}{further}
[line]
span_m = 60.0
wave_speed_m_s = 120.0
uplift_space_mm = 80.0

[columns]
time_s = {{ column = "Zeit [s]" }}
position_1_m = {{ column = "Weg [m]" }}
"""
            + "\n".join(lines)
            + f"""

[[source]]
file = "mast.csv"
join = {{ {join} }}

[source.columns]
time_s = {{ column = "Uhrzeit [s]" }}
"""
            + "\n".join(masts)
            + "\n",
            encoding="utf-8",
        )
        return sidecar


def format_german(names: list[str], rows: Array) -> str:
    """Text of a table with semicolons and decimal commas."""
    lines = [";".join(f"{value:.5f}" for value in row).replace(".", ",") for row in rows]
    return "\n".join([";".join(names), *lines]) + "\n"


def format_masts(table: Array) -> str:
    """Text of a table of the masts: time, and the uplift at each of them."""
    return format_german(["Uhrzeit [s]", *(f"Anhub Mast {n} [mm]" for n in range(1, table.shape[1]))], table)


@cache
def format_files(pair: MeasuredPair) -> tuple[str, str]:
    """Texts of the tables of the train and of the masts."""
    forces = [f"Kraft {n} [N]" for n in range(1, pair.pantographs + 1)]
    train = format_german(["Zeit [s]", "Weg [m]", *forces], pair.train())
    return train, format_masts(pair.masts())


def write_masts(folder: Path, table: Array) -> None:
    """Write a table of the masts."""
    (folder / "mast.csv").write_text(format_masts(table), encoding="cp1252", newline="\n")


def write_german(path: Path, names: list[str], rows: Array) -> None:
    """Write a table with semicolons and decimal commas."""
    path.write_text(format_german(names, rows), encoding="cp1252", newline="\n")


PASSAGE = 'kind = "passage", offset_s = 3.0, within_s = 20.0'
STATED = 'kind = "time", offset_s = 3.217, uncertainty_s = 0.005'
