"""Pictures of the user pages: steps, screens of commands, and figures computed when the site is built."""

import tempfile
from collections.abc import Callable
from functools import cache, partial
from pathlib import Path
from typing import Any

import numpy as np

from pantocheck.conformance.core.figure_style import CURVES, FULL, GREY, HALF, INK, PALE, add_legend, render_svg
from site_pages.sketches import draw_commands, draw_screen, draw_sheet, draw_steps, list_output, start_sketch

ONE, READ = "en50318-2002/250", "en50318-2018/ac-simple/275"

STEPS = {
    "extending": ("folder of yours|cases, lines,|profiles", "--cases DIR|ids own/...", "catalogue|library and yours"),
    "format-versions": ("file|schema = name/1", "same version?|yes: read", "other version:|refused,|exit code 2"),
    "platforms": ("Linux|tested", "Windows|simulated checks", "macOS|open"),
    "systems": (
        "case|line, train,|discretisation", "your program|task as JSON",
        "record|forces, uplifts", "verdicts|limits, bands",
    ),
    "network": (
        "files|of the train", "runs import|collection",
        "runs assess|section by section", "report|places, trends",
    ),
    "pytest": ("plan.toml|cases, system", "pytest|one test each", "criterion|pass, fail, skip"),
    "ci": ("commit", "simulator|records", "pantocheck run|exit code", "0: go on|1, 2, 3: stop"),
    "site": ("results.json|systems, versions", "pantocheck site|no server", "pages|who passes what"),
    "signing": ("certificate", "sign|your key", "signed document", "verify|who, and unchanged?"),
    "archival": ("results.json|attached", "PDF/A-3|fonts, tags inside", "archive|readable alone"),
    "fmu": ("FMU|pantograph", "process of its own|bounded", "line|reference simulator", "force, uplift"),
    "rig": (
        "simulated line|height of the wire", "actuator",
        "pantograph|on the rig", "measured force|back to the line",
    ),
    "known-limitations": ("0-20 Hz|published limits", "20-50 Hz|converged solution", "above 50 Hz|not graded"),
}  # fmt: skip
"""Steps of a page, each with a title and further lines."""

STATES = ("format-versions", "platforms", "known-limitations")
"""Pages whose boxes are states beside each other."""


def write_page_pictures(folder: Path) -> None:
    """Write the picture of each page that has one of its own."""
    folder.mkdir(parents=True, exist_ok=True)
    drawings: dict[str, Callable[[], str]] = {
        name: partial(draw_steps, *steps, joined=name not in STATES) for name, steps in STEPS.items()
    }
    for name, draw in (drawings | FIGURES).items():
        (folder / f"{name}.svg").write_text(draw(), "utf-8")


# Screens of commands.
def draw_doctor() -> str:
    """State of an installation, without the places on this machine."""
    lines = list_output(Path(), "pantocheck doctor")
    return draw_screen(["$ pantocheck doctor", *(line for line in lines if "/" not in line)][:14])


def _draw_in_folder(*commands: str, prepare: str = "", most: int = 16) -> str:
    """Screen of commands in a new folder, after one whose output is not shown."""
    with tempfile.TemporaryDirectory() as folder:
        if prepare:
            draw_commands(Path(folder), prepare)
        return draw_commands(Path(folder), *commands, most=most)


# Lines.
def draw_new_line() -> str:
    """Some spans of the line of the template."""
    with tempfile.TemporaryDirectory() as folder:
        draw_commands(Path(folder), "pantocheck new line line.toml")
        return _draw_spans(str(Path(folder) / "line.toml"), 2, 6)


@render_svg
def _draw_spans(name: str, first: int, last: int) -> Any:
    from pantocheck.conformance import open_line

    figure, axes = _start(FULL, 2.0)
    open_line(name).plot(first, last, axes=axes)
    axes.set(title="")
    return figure


@render_svg
def draw_sections() -> Any:
    """Overlap of two tension sections, and the contact force there."""
    from pantocheck.conformance import open_case

    changes = {"line.geometry.spans": 14, "line.section": [{"spans": 8}, {"spans": 9}]}
    case = open_case("en50318-2002/300").with_(
        changes | {"line.overlap": {"spans": 3, "anchor_rise_m": 0.5}}, evaluated_spans=[3, 11]
    )
    figure, (above, below) = _start(FULL, 3.2, rows=2)
    case.line.plot(4, 10, axes=above)
    signals = case.simulate().signals()
    below.plot(signals["position_m"], signals["force_20_N"], color=CURVES[0], linewidth=1)
    above.set(title="", xlabel="", xlim=(180, 600))
    below.set(xlabel="position along the track [m]", ylabel="force [N]", xlim=(180, 600))
    return figure


def draw_line_sheet() -> str:
    """Sheet of the supports of a line, as it is written."""
    import io

    from openpyxl import load_workbook

    from pantocheck.conformance.app.commands.new_command import build_sheets

    sheet = load_workbook(io.BytesIO(build_sheets("line")))["supports"]
    names = [str(cell.value) for cell in sheet[1]]
    kept = [names.index(name) for name in ("number", "x_m", "span_m", "encumbrance_m")]
    cells = list(sheet.iter_rows(max_row=6, values_only=True))
    rows = [[str("" if row[i] is None else row[i]) for i in kept] for row in cells]
    (check,) = (each for each in sheet.data_validations.dataValidation if each.promptTitle == "encumbrance_m")
    return draw_sheet(rows, f"encumbrance_m: {check.prompt}")


@render_svg
def draw_update() -> Any:
    """Factors of a line that one passage has updated."""
    import json

    with tempfile.TemporaryDirectory() as folder:
        tension = "--set line.contact_wire.tension_N=20300"
        draw_commands(
            Path(folder),
            f"pantocheck simulate {ONE} {tension} --out a.csv",
            f"pantocheck line update {ONE} --passages a.toml --out as-built.toml",
        )
        rows = json.loads((Path(folder) / "as-built.covariance.json").read_text())["properties"][:8]
    figure, axes = _start(FULL, 2.2)
    for place, row in enumerate(reversed(rows)):
        axes.plot([row["low_95"], row["high_95"]], [place, place], color=INK, linewidth=2)
        axes.plot(row["factor"], place, "o", color=INK, markersize=5)
    axes.axvline(1.015, color=CURVES[1], linestyle="--", linewidth=1, label="true factor of the contact wire tension")
    axes.set_yticks(range(len(rows)), [row["name"].replace("_", " ") for row in reversed(rows)])
    axes.set(xlabel="factor on the stated value, with 95 % interval", xlim=(0.94, 1.06))
    add_legend(axes)
    return figure


# Pantographs and contact.
@render_svg
def draw_force_law() -> Any:
    """A law of the mean contact force, and the passages that it rules."""
    figure, axes = _start(HALF, 2.0)
    speed = np.linspace(0, 320, 100)
    axes.plot(speed, 70 + 0.00097 * speed**2, color=CURVES[0])
    axes.plot([300], [70 + 0.00097 * 300**2], "o", color=INK)
    axes.annotate("force of a case at 300 km/h", (300, 157), (60, 165), fontsize=7.5, arrowprops={"arrowstyle": "->"})
    axes.set(xlabel="speed [km/h]", ylabel="mean contact force [N]", xlim=(0, 330), ylim=(60, 185))
    return figure


@render_svg
def draw_response() -> Any:
    """Apparent mass of the pantograph of the reference model."""
    from pantocheck.conformance import open_pantograph

    figure, axes = _start(HALF, 2.2)
    open_pantograph("en50318-2002/pantograph.toml").plot(axes=axes)
    axes.set(title="")
    return figure


@render_svg
def draw_contact_laws() -> Any:
    """Force over penetration of the three contact laws."""
    figure, axes = _start(HALF, 2.2)
    depth = np.linspace(0, 4, 100)
    axes.plot(depth, 50 * depth, color=CURVES[0], label="spring, 50 kN/m")
    axes.plot(depth, 60 * depth**1.5, "--", color=CURVES[1], label="Hertz (own scale)")
    axes.plot([0, 0], [0, 400], "-.", color=CURVES[2], linewidth=2, label="constraint")
    axes.plot([-1, 0], [0, 0], color=INK)
    axes.set(xlabel="penetration [mm]", ylabel="contact force [N]", xlim=(-1, 4), ylim=(-15, 220))
    axes.legend(fontsize=7, loc="lower right", bbox_to_anchor=(1, 0.1))
    return figure


def draw_head() -> str:
    """Scheme of a pantograph with two strips on springs."""
    from pantocheck.conformance.pages.line_figure import DrawnChain, draw_chain

    chain = DrawnChain(
        (15.0, 7.2), (50.0, 4200.0), (90.0, 10.0), ("frame", "head"), 0, "50 kN/m", ((3.0, 10000.0, 5.0),) * 2
    )
    return draw_chain(chain)


# Forces, values and verdicts.
@cache
def _grade() -> Any:
    from pantocheck.conformance import open_case

    (case,) = open_case(ONE).grade().results.cases
    return case


@render_svg
def draw_record() -> Any:
    """Force of a record with its analysis section."""
    from pantocheck.conformance import open_case

    run = open_case(ONE).simulate()
    figure, axes = _start(FULL, 2.0)
    begin, end = _grade().run.evaluated_m
    axes.axvspan(begin, end, color=PALE, linewidth=0)
    signals = run.signals()
    axes.plot(signals["position_m"], signals["force_N"], color=GREY, linewidth=0.6, label="as recorded")
    axes.plot(signals["position_m"], signals["force_20_N"], color=CURVES[0], linewidth=1.2, label="up to 20 Hz")
    axes.set(
        xlabel="position along the track [m]",
        ylabel="contact force [N]",
        xlim=(begin - 10, end + 10),
        title="analysis section of a record",
    )
    add_legend(axes)
    return figure


@render_svg
def draw_python_plot() -> Any:
    """Figure of `run.plot()`."""
    from pantocheck.conformance import open_case

    figure, axes = _start(FULL, 2.2)
    open_case(ONE).simulate().plot(axes=axes)
    return figure


@render_svg
def draw_verdicts() -> Any:
    """Values against limits: inside, close, undecided and outside."""
    figure, axes = start_sketch(FULL, 1.6, 10, 5)
    rows = (
        *((4.2, 5.0, 0.7, "pass"), (3.1, 6.7, 0.7, "pass, close")),
        *((2.0, 6.9, 0.9, "undecided (guarded)"), (0.9, 8.2, 0.6, "fail")),
    )
    axes.axvspan(3, 7, ymin=0.1, ymax=0.94, color=PALE, linewidth=0)
    for y, x, half, text in rows:
        axes.plot([x - half, x + half], [y, y], color=INK, linewidth=1.6)
        axes.plot(x, y, "o", color=INK, markersize=6)
        axes.text(0.2, y, text, fontsize=8.5, va="center", weight="bold")
    for x, text in ((3, "lower limit"), (7, "upper limit")):
        axes.axvline(x, ymin=0.1, ymax=0.94, color=GREY, linewidth=1)
        axes.text(x, 0.15, text, fontsize=7.5, ha="center")
    axes.text(9.9, 4.2, "value ± uncertainty", fontsize=7.5, ha="right", va="center")
    return figure


@render_svg
def draw_verification() -> Any:
    """Bands of a run against the converged solution with its tolerance."""
    rows = [row for row in _grade().verification.criteria if row.quantity.startswith("rms_")]
    figure, axes = _start(HALF, 2.0)
    for place, row in enumerate(rows):
        axes.plot([row.lower, row.upper], [place, place], color=CURVES[2], linewidth=7, alpha=0.5)
        axes.plot(row.value, place, "o", color=INK, markersize=4)
    names = [row.quantity.removeprefix("rms_").removesuffix("_N").replace("_", "-") + " Hz" for row in rows]
    axes.set_yticks(range(len(rows)), names)
    axes.set(xlabel="RMS of the band [N]: run, and tolerance", ylim=(-0.6, len(rows) - 0.4))
    return figure


@render_svg
def draw_uncertainty() -> Any:
    """Joint sample of a value with its limits."""
    row = next(row for row in _grade().criteria if row.quantity == "std_force_N")
    figure, axes = _start(HALF, 2.0)
    axes.hist(row.draws, bins=40, color=GREY)
    for limit in (row.lower, row.upper):
        axes.axvline(limit, color=CURVES[1], linestyle="--", label="limit" if limit == row.lower else None)
    axes.axvline(row.value, color=INK, label="value")
    axes.set(xlabel="standard deviation up to 20 Hz [N]", ylabel="draws of 1000")
    add_legend(axes)
    return figure


@render_svg
def draw_two_dampings() -> Any:
    """Free decay of one mode of 1 Hz with two damping ratios."""
    figure, axes = _start(FULL, 2.0)
    time = np.linspace(0, 30, 1500)
    for ratio, colour, style in ((0.005, CURVES[0], "-"), (0.012, CURVES[1], "--")):
        envelope = np.exp(-2 * np.pi * ratio * time)
        axes.plot(time, envelope * np.cos(2 * np.pi * time), color=colour, linewidth=0.7)
        axes.plot(time, envelope, style, color=colour, linewidth=1.4, label=f"damping ratio {100 * ratio:g} %")
    axes.set(xlabel="time [s]", ylabel="motion over first amplitude", xlim=(0, 30), ylim=(-1.1, 1.1))
    add_legend(axes)
    return figure


@render_svg
def draw_terms() -> Any:
    """A span with its terms."""
    from pantocheck.conformance import open_line

    figure, axes = _start(FULL, 2.8)
    line = open_line("en50318-2002/line.toml")
    line.plot(4, 5, axes=axes)
    start, middle, end = (float(line.span_limits[number]) for number in (3, 4, 5))
    style = {"arrowstyle": "-", "color": CURVES[1], "linewidth": 0.8}
    for text, point, place in (
        ("messenger wire", (start + 14, 0.86), (start + 12, 1.32)),
        ("dropper", (start + 30, 0.4), (start + 33, 0.98)),
        ("contact wire", (start + 45, 0.0), (start + 38, -0.28)),
        ("steady arm", (middle, 0.0), (middle - 6, -0.28)),
        ("messenger support", (middle, 1.2), (middle + 3, 1.38)),
    ):
        axes.annotate(text, point, place, arrowprops=style, fontsize=8, color=CURVES[1])
    double = {"arrowstyle": "<->", "color": GREY}
    axes.annotate("", (start, -0.42), (middle, -0.42), arrowprops=double)
    axes.text((start + middle) / 2, -0.4, "span", ha="center", fontsize=8)
    axes.annotate("", (end - 1.5, 0), (end - 1.5, 1.2), arrowprops=double)
    axes.text(end - 3, 0.15, "encumbrance", ha="right", fontsize=8)
    axes.set(title="", ylim=(-0.5, 1.5), xlim=(start - 2, end + 2))
    return figure


def _start(width: float, height: float, rows: int = 1) -> tuple[Any, Any]:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), layout="constrained")
    return figure, figure.subplots(rows)


FIGURES: dict[str, Callable[[], str]] = {
    "installation": draw_doctor,
    "terminal": partial(_draw_in_folder, f"pantocheck run {ONE} --formats json --out report"),
    "logger-files": partial(
        _draw_in_folder, "pantocheck describe run.csv", prepare=f"pantocheck simulate {ONE} --out run.csv"
    ),
    "verify": partial(
        _draw_in_folder,
        "pantocheck verify report/results.json",
        prepare=f"pantocheck run {ONE} --formats json --out report",
    ),
    "your-own-line": draw_new_line,
    "line-files": partial(_draw_spans, "en50318-2018/ac-stitched/line.toml", 4, 7),
    "sections": draw_sections,
    "line-tables": draw_line_sheet,
    "line-update": draw_update,
    "force-law": draw_force_law,
    "pantograph-response": draw_response,
    "contact-laws": draw_contact_laws,
    "head": draw_head,
    "records": draw_record,
    "python": draw_python_plot,
    "verdicts": draw_verdicts,
    "verification": draw_verification,
    "uncertainty": draw_uncertainty,
    "readings": partial(_draw_in_folder, f"pantocheck readings {READ}", most=12),
    "compare-drop": draw_two_dampings,
    "glossary": draw_terms,
}
"""Drawing of a page by its name."""
