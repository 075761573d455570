"""Report on a recorded drop: headline, caveats, criteria, and for each place its figures and a table of all bands."""

from typing import Any

from matplotlib.figure import Figure

from helpers.criterion_fixtures import COMPARED
from pantocheck.conformance.pages import document as doc
from pantocheck.conformance.pages.comparison_page import (
    DROP_PAGE,
    build_comparison,
    draw_drop_motion,
    draw_residual_energy,
)
from pantocheck.conformance.results.drop_comparison_format import DropComparison, MotionCurve

TIME = [0.0, 0.5, 1.0]
WINDOWS = [[0.0, 1.0], [2.0, 3.0]]


def build_curve(place: str, motion: str, window: list[float]) -> dict[str, Any]:
    record = [1.0, 0.0, -1.0] if place == "S1" else None
    models = {"own": [1.0, 0.1, -1.0], "other": [0.5, 0.0, -0.5]}
    times = [window[0] + t for t in TIME]
    return {"place": place, "motion": motion, "window_s": window, "time_s": times, "record": record, "models": models}


def build_energy(place: str) -> dict[str, Any]:
    models = {"own": [1.0, 0.5, 0.2], "other": [0.9, 0.3, 0.1]}
    sensor = place == "S1"
    return {
        "place": place, "time_s": TIME, "record": [1.0, 0.5, 0.2] if sensor else None, "models": models,
        "differences": models if sensor else {},
    }  # fmt: skip


def build_results(**changes: Any) -> DropComparison:
    """Sensor S1 and the mass, two models, one limit that fails."""
    agreement = {"model": "own", "rms": 1.1, "rms_ratio": 1.1, "correlation": 0.99}
    quiet = {"model": "other", "rms": 0.5, "rms_ratio": None, "correlation": None}
    statistics = [
        {
            "place": place, "motion": "velocity", "window_s": window, "band_Hz": [0.3, 20.0],
            "record_rms": 1.0 if place == "S1" else None, "noise_rms": 0.01 if place == "S1" else None,
            "models": [agreement if place == "S1" else agreement | quiet, quiet],
        }
        for place in ("S1", "mass") for window in WINDOWS
    ]  # fmt: skip
    criterion = {
        **COMPARED, "quantity": "rms_ratio", "unit": "", "value": 1.1,
        "where": {"motion": "velocity", "sensor": 1, "window_s": WINDOWS[0], "band_Hz": [0.3, 20.0]},
        "lower": 0.98, "upper": 1.02, "verdict": "fail", "reason": "0.08 above the upper limit",
        "margin": -4.0, "uncertainty": 0.001, "limit_uncertainty": 0.002,
    }  # fmt: skip
    places = [
        {"name": "S1", "sensor": 1, "wire": "CW", "position_m": 81.0},
        {"name": "mass", "sensor": None, "wire": "CW", "position_m": 94.5},
    ]
    drop = {
        "mass_kg": 30.0, "wire": "CW", "position_m": 94.5, "release_duration_s": 0.0, "planned_release_s": 3.0,
        "release_s": 3.001, "release_correlation": 0.999,
    }  # fmt: skip
    content = {
        "suite": {"version": "1", "commit": None, "digest": "sha256:c"},
        "model": {"name": "My line", "digest": "sha256:a"},
        "record": {"name": "T1", "source": "T1.h5", "digest": None}, "verdict": "fail",
        "line_comparison": {"state": "consistent", "differences": [], "missing": []}, "drop": drop, "rate_Hz": 200.0,
        "element_m": 0.5, "time_step_s": 0.001, "windows_s": WINDOWS, "bands_Hz": [[0.3, 20.0]],
        "models": [{"name": name, "source": f"{name}.toml", "damping": {}, "last_slack_s": None}
                   for name in ("own", "other")],
        "places": places, "statistics": statistics, "energies": [build_energy(place["name"]) for place in places],
        "curves": [build_curve(place["name"], motion, window) for place in places
                   for motion in ("velocity", "acceleration") for window in WINDOWS],
        "criteria": [criterion], "warnings": ["the record is short"], **changes,
    }  # fmt: skip
    return DropComparison.model_validate(content)


def find_sections(document: doc.Document) -> dict[str, doc.Section]:
    return {block.heading: block for block in document.blocks if isinstance(block, doc.Section)}


def test_page_states_verdict_caveats_and_criteria() -> None:
    document = build_comparison(build_results())
    assert isinstance(document.header, doc.VerdictHeader)
    assert (document.header.verdict, document.header.headline) == ("fail", DROP_PAGE.headlines["fail"])
    (box,) = (block for block in document.blocks if isinstance(block, doc.WarningBox))
    name = "RMS ratio of the velocity at sensor 1, 0 to 1 s, 0.3 to 20 Hz"
    assert box.sentences == ("the record is short", f"{name} lies near")
    (table,) = find_sections(document)["Criteria"].blocks
    assert isinstance(table, doc.Table)
    assert table.rows == (
        (name, "1.100", "0.98 to 1.02", "0.0010", "0.0020", doc.VerdictMark("fail"), "0.08 above the upper limit"),
    )


def test_every_place_has_its_figures_and_a_table_of_all_bands() -> None:
    """One figure per window and one of the energy; one row per window and model."""
    sections = find_sections(build_comparison(build_results()))
    assert list(sections) == ["Criteria", "S1, CW at 81 m", "Mass, CW at 94.5 m"]
    for heading in list(sections)[1:]:
        figures, table = sections[heading].blocks
        assert isinstance(figures, doc.Figures)
        assert isinstance(table, doc.Table)
        assert (len(figures.figures), len(table.rows)) == (3, 4)
    assert table.rows[0][3:5] == ("–", "–")


def test_figures_show_record_models_and_difference() -> None:
    """The record is drawn first, below the models; the energy has a line of the difference of the graded model."""
    results = build_results()
    motion: Figure = draw_drop_motion.__wrapped__(results.curves[:2])  # type: ignore[attr-defined]
    energy: Figure = draw_residual_energy.__wrapped__(results.energies[0], "own")  # type: ignore[attr-defined]
    mass: Figure = draw_residual_energy.__wrapped__(results.energies[1], "own")  # type: ignore[attr-defined]
    assert [[line.get_label() for line in axes.lines] for axes in motion.axes] == [["record", "own", "other"]] * 2
    assert [line.get_label() for line in energy.axes[0].lines] == ["record", "own", "other", "own − record"]
    assert [line.get_label() for line in mass.axes[0].lines] == ["own", "other"]
    # A damping file may have any name; matplotlib reads text between two dollar signs as a formula.
    curve = build_curve("S1", "velocity", WINDOWS[0]) | {"models": {r"$\frac$": [1.0, 0.0, -1.0]}}
    assert "<svg" in draw_drop_motion([MotionCurve.model_validate(curve)])
