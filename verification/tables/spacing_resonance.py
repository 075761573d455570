"""Resonance of the spacing of two pantographs, from the table of a campaign; the numbers of docs/pantograph-spacing.md.

    pantocheck campaign campaigns/ac-simple-spacing --out spacing
    python -m verification.tables.spacing_resonance spacing/campaign.csv [--out docs/pantograph-spacing.svg]

prints the predicted distance of two maxima at each speed beside that of the campaign, and draws the standard
deviation of the rear pantograph over that of the front one with the predicted maxima and minima. The prediction uses
the modes of the line alone.
"""

import argparse
import csv
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from pantocheck.conformance.cases.library import library_folder, list_library, load_case
from pantocheck.conformance.core.figure_style import FULL, render_svg
from pantocheck.conformance.line.catenary_model import discretise_line
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.model.modal.modes import compute_modes

Real = NDArray[np.float64]

CASE = "en50318-2018/ac-simple/320-twin"

SPANS = 24
"""Spans of the line of the modes: with 12, the predicted frequencies differ by less than 0.1 %."""

ELEMENT_M = 1.0

TRIALS_M = np.arange(40.0, 130.0, 0.25)
"""Trial distances of two maxima for the fit [m]."""

DECAYS_M = (100.0, 200.0, 400.0, np.inf)
"""Trial distances over which the effect of the front pantograph falls to 1/e [m]."""


def main() -> None:
    """Print the table and draw the map."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("table", type=Path, help="campaign.csv of campaigns/ac-simple-spacing")
    parser.add_argument("--out", type=Path, metavar="FILE", help="figure to write (SVG)")
    arguments = parser.parse_args()
    speeds, spacings, ratio = read_map(arguments.table)
    line = load_case(list_library(library_folder())[CASE]).line
    frequencies = [wake_frequency(line, speed / 3.6) for speed in speeds]
    waves = speeds / 3.6 / np.array(frequencies)
    print("| speed [km/h] | frequency [Hz] | v / f [m] | fitted [m] | at n v / f | at (n + 1/2) v / f |")
    print("|--:|--:|--:|--:|--:|--:|")
    for speed, frequency, wave, values in zip(speeds, frequencies, waves, ratio.T, strict=True):
        fitted = fit_wave(spacings, values)
        high, low = (mean_near(spacings, values, wave, offset) for offset in (0.0, 0.5))
        print(f"| {speed:.0f} | {frequency:.3f} | {wave:.1f} | {fitted:.1f} | {high:.2f} | {low:.2f} |")
    if arguments.out is not None:
        arguments.out.write_bytes(draw(speeds, spacings, ratio, waves).encode())


def read_map(path: Path) -> tuple[Real, Real, Real]:
    """Speeds [km/h], spacings [m], and ratio of the rear to the front standard deviation (spacings, speeds) [-]."""
    with path.open(encoding="utf-8", newline="") as file:
        rows = [
            [float(row[name]) for name in ("speed_km_h", "spacing_m", "1.std_force_N", "2.std_force_N")]
            for row in csv.DictReader(file)
        ]
    speed, spacing, front, rear = np.array(rows).T
    speeds, column = np.unique(speed, return_inverse=True)
    spacings, row = np.unique(spacing, return_inverse=True)
    ratio = np.full((spacings.size, speeds.size), np.nan)
    ratio[row, column] = rear / front
    return speeds, spacings, ratio


def first_band(line: LineFile) -> tuple[Real, Real]:
    """Phase from span to span [rad] and frequency [Hz] of the modes with one half-wave per span, by increasing phase.

    The modes of a line of N equal spans between fixed ends are standing waves with the phases pi n / N.
    """
    geometry = line.geometry.model_copy(
        update={"spans": SPANS, "stagger_contact_wire_m": 0.0, "stagger_messenger_m": 0.0}
    )
    modes = compute_modes(discretise_line(line.model_copy(update={"geometry": geometry}), ELEMENT_M), SPANS)
    return np.pi * np.arange(1, SPANS + 1) / SPANS, modes.frequency


def wake_frequency(line: LineFile, speed: float) -> float:
    """Frequency of the line behind a pantograph at a speed [m/s]: its phase from span to span is 2 pi f L / v."""
    phase, band = first_band(line)
    frequency = float(band.mean())
    for _ in range(200):  # half steps of the fixed point converge below the wave speed
        turns = frequency * line.geometry.longest_span / speed
        folded = 2 * np.pi * abs(turns - round(turns))
        frequency = (frequency + float(np.interp(folded, phase, band))) / 2
    return frequency


def fit_wave(spacings: Real, values: Real) -> float:
    """Distance of two maxima [m]: least squares of the squares of the values as a decaying wave of the spacing."""
    return min(_list_fits(spacings, values**2))[1]


def _list_fits(spacings: Real, squares: Real) -> Iterator[tuple[float, float]]:
    for wave in TRIALS_M:
        for decay in DECAYS_M:
            angle, fade = 2 * np.pi * spacings / wave, np.exp(-spacings / decay)
            terms = np.column_stack([np.ones_like(spacings), fade * np.cos(angle), fade * np.sin(angle)])
            coefficients = np.linalg.lstsq(terms, squares, rcond=None)[0]
            yield float(np.sum((squares - terms @ coefficients) ** 2)), float(wave)


def mean_near(spacings: Real, values: Real, wave: float, offset: float) -> float:
    """Mean value at the spacings within an eighth of a wave of the places (n + offset) waves, n from 1 on."""
    turns = spacings / wave - offset
    return float(values[(np.abs(turns - np.round(turns)) <= 1 / 8) & (np.round(turns) >= 1)].mean())


@render_svg
def draw(speeds: Real, spacings: Real, ratio: Real, waves: Real) -> Figure:
    """Map of the ratio; solid: n v / f, dashed: (n + 1/2) v / f."""
    figure = Figure(figsize=(FULL, 3.6))
    axes = figure.subplots()
    mesh = axes.pcolormesh(speeds, spacings, ratio, shading="nearest", cmap="Greys")
    figure.colorbar(mesh, ax=axes, label="standard deviation, rear over front [-]")
    for half in range(1, 8):
        solid = half % 2 == 0
        axes.plot(speeds, half / 2 * waves, "-" if solid else "--", color="#b3541e", linewidth=1.6 if solid else 1.0)
    axes.set(xlabel="speed [km/h]", ylabel="spacing [m]", ylim=(spacings[0] - 5, spacings[-1] + 5))
    return figure


if __name__ == "__main__":
    main()
