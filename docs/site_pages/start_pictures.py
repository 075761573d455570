"""Pictures of the start page, computed when the site is built.

python docs/site_pages/start_pictures.py DIR     # the same pictures, for example for the README
"""

import subprocess
import sys
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "docs"))

from pantocheck.conformance.core.figure_style import CURVES, PALE, read_style  # noqa: E402
from site_pages.page_run import build_environment  # noqa: E402
from site_pages.picture_folder import draw_page  # noqa: E402

TWO_PANTOGRAPHS = "en50318-2018/ac-simple/320-twin"
ONE_PANTOGRAPH = "en50318-2002/250"
MASS_DROP = "vovan2015/mass-drop/stand-in"

LENGTH_M = 275.0
"""Length of the drawn part of the analysis section: five spans of 55 m."""

NAMES = ("contact-force.svg", "line.svg", "spectrum.svg", "decay.svg", "certificate.png")
"""Files that `write_start_pictures` writes."""


def write_start_pictures(folder: Path) -> None:
    """Write the pictures of the start page."""
    folder.mkdir(parents=True, exist_ok=True)
    draw_contact_force(folder / "contact-force.svg")
    draw_spectrum(folder / "spectrum.svg")
    draw_decay(folder)
    run_pantocheck("line", "draw", ONE_PANTOGRAPH, "--out", str(folder / "line.svg"))
    run_pantocheck("run", ONE_PANTOGRAPH, "--formats", "pdf", "--out", str(folder / "report"))
    draw_page(folder / "report" / "certificate.pdf", 1, folder / "certificate.png")


def draw_contact_force(target: Path) -> None:
    """Contact force of two pantographs over five spans, below 20 Hz."""
    from pantocheck.conformance import open_case

    run = open_case(TWO_PANTOGRAPHS).simulate()
    figure, axes = _start_figure(7.0, 2.6)
    for pantograph, style in ((1, {"color": CURVES[0]}), (2, {"color": CURVES[1], "linestyle": "--"})):
        signals = run.signals(pantograph)
        deviation = run.quantity("std_force_N", pantograph)
        label = f"{('leading', 'rear')[pantograph - 1]} pantograph, standard deviation {deviation:.1f} N"
        axes.plot(signals["position_m"][::4], signals["force_20_N"][::4], linewidth=1.1, label=label, **style)
    start = float(run.signals(1)["position_m"].min())
    axes.set(xlabel="position along the track [m]", ylabel="contact force [N]", xlim=(start, start + LENGTH_M))
    axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2, frameon=False, fontsize=8)
    _save(figure, target)


def draw_spectrum(target: Path) -> None:
    """Amplitude spectrum of the contact force, with the band of 20-50 Hz."""
    from pantocheck.conformance import open_case

    run = open_case(ONE_PANTOGRAPH).simulate()
    figure, axes = _start_figure(3.4, 2.4)
    run.plot_spectrum(axes=axes)
    axes.axvspan(20, 50, color=PALE, linewidth=0)
    axes.text(
        35, 0.9 * axes.get_ylim()[1], f"20-50 Hz:\n{run.quantity('rms_20_50_N'):.1f} N RMS", ha="center", va="top"
    )
    axes.set(xlim=(0, 50), title="")
    _save(figure, target)


def draw_decay(folder: Path) -> None:
    """Acceleration of the contact wire after the release of a mass."""
    import numpy as np

    record = folder / "drop.csv"
    run_pantocheck("drop", "simulate", MASS_DROP, "--drop", "1", "--out", str(record))
    names = record.read_text(encoding="utf-8").split("\n", 1)[0].split(",")
    table = np.loadtxt(record, delimiter=",", skiprows=1)
    figure, axes = _start_figure(3.4, 2.4)
    axes.plot(table[:, 0], table[:, 3], color=CURVES[0], linewidth=0.6)
    axes.set(xlabel="time [s]", ylabel="acceleration [m/s2]", ylim=(-3, 3), xlim=(0, table[-1, 0]))
    assert names[0] == "time_s"
    _save(figure, folder / "decay.svg")


def run_pantocheck(*arguments: str) -> None:
    """Run a command of the installed suite; its output is shown if it fails."""
    command = ["pantocheck", *arguments]
    done = subprocess.run(command, env=build_environment(), capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise RuntimeError(f"{' '.join(command)} ended with exit code {done.returncode}:\n{done.stdout}{done.stderr}")


def _start_figure(width: float, height: float) -> tuple[Any, Any]:
    import matplotlib
    from matplotlib.figure import Figure

    with matplotlib.rc_context(read_style()):
        figure = Figure(figsize=(width, height), layout="constrained")
        return figure, figure.subplots()


def _save(figure: Any, target: Path) -> None:
    import matplotlib

    with matplotlib.rc_context(read_style()):
        figure.savefig(target, metadata={"Date": None})


if __name__ == "__main__":
    write_start_pictures(Path(sys.argv[1]))
