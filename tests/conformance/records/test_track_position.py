"""Positions from distance pulses, pulse trains and kilometre marks, in both running directions."""

from contextlib import nullcontext
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from helpers.record_keys import record_keys
from helpers.toml_edit import edit_toml
from pantocheck.conformance.cases.profile_file import load_profile
from pantocheck.conformance.core.csv_table import write_csv_table
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.toml_file import read_model
from pantocheck.conformance.grading.assessed_record import load_assessed_record
from pantocheck.conformance.records.record_reading import read_record
from pantocheck.conformance.records.record_sidecar import RecordSidecar
from pantocheck.conformance.records.sidecar_tables import LineTable
from pantocheck.conformance.records.track_position import (
    PulsesUnusable,
    count_distance,
    interpolate_marks,
    pulse_distance,
)

RATE, SPEED = 1000.0, 60.0
TIME = np.arange(20_000) / RATE
DISTANCE = SPEED * TIME + 0.5 * 0.02 * TIME**2
"""20 s from 60 m/s on, with an acceleration of 0.02 m/s2."""


@pytest.mark.parametrize("direction", [1, -1])
def test_counter_gives_the_distance_within_one_sample(direction: int) -> None:
    """A pulse is seen up to one sample late: 0.06 m at 60 m/s; the first reading lies up to a pulse after the last."""
    count = 700 + direction * np.floor(DISTANCE / 0.4)
    distance = count_distance(count, 0.4)
    known = np.isfinite(distance)
    assert known.mean() > 0.999
    assert np.abs(distance - DISTANCE)[known].max() < 0.4 + 0.061
    assert np.ptp((distance - DISTANCE)[known]) < 2 * 0.061
    assert (np.diff(distance[known]) > 0).all()


def test_standing_train_has_no_distance() -> None:
    """One pulse per sample between two stands: one sample is extrapolated at each end."""
    distance = count_distance(np.r_[np.zeros(50), np.arange(1.0, 80.0), np.full(50, 79.0)], 0.4)
    assert np.flatnonzero(np.isfinite(distance)).tolist() == [*range(49, 130)]


def test_pulses_and_marks_give_the_distance_between_them() -> None:
    """A sensor of 5 V with noise of 0.2 V, and a wave of 1 m: edges are interpolated, so that 2 cm are left."""
    noise = 0.2 * np.random.default_rng(2).standard_normal(TIME.size)
    signal = 2.5 + 2.5 * np.tanh(2 * np.sin(2 * np.pi * DISTANCE)) + noise
    distance = pulse_distance(signal, 1.0)
    known = np.isfinite(distance)
    assert known.mean() > 0.998
    assert np.ptp((distance - DISTANCE)[known]) < 0.1
    # Edges of a triangle lie on straight lines between two samples, which are exact up to the acceleration.
    exact = pulse_distance(np.abs(2 * (DISTANCE % 1) - 1), 1.0) - DISTANCE
    assert np.ptp(exact[np.isfinite(exact)]) < 1e-3
    # Marks of 100 m at a nearly constant speed: monotone cubics leave 1 cm of 1.2 km.
    places = np.arange(100.0, 1200.0, 100.0)
    passing = np.interp(places, DISTANCE, TIME)
    position = interpolate_marks(TIME, passing, places)
    inside = (passing[0] <= TIME) & (passing[-1] >= TIME)
    assert np.isfinite(position[inside]).all()
    assert np.isnan(position[~inside]).all()
    assert_allclose(position[inside], DISTANCE[inside], atol=0.01)


@pytest.mark.parametrize(
    ("read", "signal", "message"),
    [
        (count_distance, np.r_[np.arange(50.0), 48.0, np.arange(50.0, 90)], "runs backwards at sample 51"),
        (count_distance, np.zeros(100), "the counter counts 0 pulses; at least 2 are needed"),
        (count_distance, np.r_[0.0, np.nan, 1, 2], "sample 2 of the counter is missing"),
        (pulse_distance, np.ones(100), "is constant"),
        (pulse_distance, np.r_[np.zeros(50), np.ones(50)], "has 1 rising edges"),
        (pulse_distance, np.tile([0.0, 1.0], 50), "about one edge in two samples"),
    ],
)
def test_unusable_counters_and_pulse_trains_are_refused(read: Any, signal: np.ndarray, message: str) -> None:
    with pytest.raises(PulsesUnusable, match=message):
        read(signal, 0.5)


COLUMNS: dict[str, Any] = {
    "time_s": {"column": "t", "unit": "s"},
    "force_1_N": {"column": "F1", "unit": "N"},
    "force_2_N": {"column": "F2", "unit": "N"},
}
ZERO_KM = 120.5
SIDECAR = record_keys(speed_km_h=216.7, pantographs=2, spacing_m=[100.0], evaluated_m=[300.0, 900.0])


def write_logger_file(folder: Path, kilometres: str, sidecar: dict[str, Any]) -> Path:
    """Two pantographs 100 m apart; the first passes x = 50 m at the start; the force is a function of the place."""
    place = 50 + DISTANCE
    force = [120 + 20 * np.sin(2 * np.pi * (place - behind) / 60) for behind in (0, 100)]
    sign = 1 if kilometres == "increasing" else -1
    columns = [TIME, *force, ZERO_KM + sign * place / 1000, np.floor(DISTANCE / 0.25) * sign, SPEED + 0.02 * TIME]
    write_csv_table(folder / "a.csv", ["t", "F1", "F2", "km", "pulses", "v"], np.column_stack(columns), 10)
    (folder / "a.toml").write_text("")
    return edit_toml(folder / "a.toml", {**SIDECAR, **sidecar})


def marks(kilometres: str) -> dict[str, Any]:
    sign = 1 if kilometres == "increasing" else -1
    places = np.arange(60.0, 1240.0, 40.0)
    passing = np.interp(places, 50 + DISTANCE, TIME)
    mark = [{"time_s": t, "km": ZERO_KM + sign * x / 1000} for t, x in zip(passing, places, strict=True)]
    return {"columns": COLUMNS, "position": {"kind": "marks", "mark": mark}}


SOURCES = ("column", "counter", "marks", "speed")


@pytest.mark.parametrize("kilometres", ["increasing", "decreasing"])
@pytest.mark.parametrize("source", SOURCES)
def test_both_directions_and_every_source_give_the_same_places(source: str, kilometres: str, tmp_path: Path) -> None:
    """The place of the train in running direction, and the statistics over the analysis section."""
    # Tolerances: a quarter of a metre per pulse; ten digits of kilometres; marks as above; a speed by trapezoids.
    track = {"track": {"zero_km": ZERO_KM, "kilometres": kilometres}}
    variants: dict[str, dict[str, Any]] = {
        "column": {"columns": {**COLUMNS, "position_1_m": {"column": "km", "unit": "km"}}},
        "counter": {
            "columns": COLUMNS,
            "position": {"kind": "counter", "column": "pulses", "metres_per_pulse": 0.25, "start_m": 50.0},
        },
        "marks": marks(kilometres),
        "speed": {"columns": {**COLUMNS, "speed_m_s": {"column": "v", "unit": "m/s"}}, "start_m": 50.0},
    }
    sidecar = write_logger_file(tmp_path, kilometres, {**variants[source], **track})
    assessed = load_assessed_record(sidecar, load_profile("acceptance-ac"), LineTable())
    for number, behind in ((1, 0.0), (2, 100.0)):
        signals = assessed.prepared.pantographs[number]
        place = 50 + DISTANCE - behind
        expected = np.interp(signals.position, place, 120 + 20 * np.sin(2 * np.pi * place / 60))
        # 20 N over 60 m: 2 N per metre; 0.35 m is a pulse and a sample.
        assert np.abs(signals.force.delivered - expected).max() < 2.1 * 0.35
        # 600 m are ten spans of 60 m: mean 120 N, sigma 20/sqrt(2) N.
        assert assessed.values.values[number]["mean_force_N"] == pytest.approx(120.0, abs=0.05)
        assert assessed.values.values[number]["std_force_N"] == pytest.approx(20 / np.sqrt(2), abs=0.05)


def test_section_and_supports_by_kilometres_are_those_by_positions(tmp_path: Path) -> None:
    """From 120.2 down to 119.6 km with x = 0 at 120.5 km: x from 300 m to 900 m, in whichever order."""
    track = {"zero_km": ZERO_KM, "kilometres": "decreasing"}
    columns = {**COLUMNS, "position_1_m": {"column": "km", "unit": "km"}}
    kilometres = {"evaluated_km": [119.6, 120.2], "support_km": [120.2, 119.9]}
    content = {"columns": columns, "track": track, **kilometres}
    sidecar = write_logger_file(tmp_path, "decreasing", content)
    edit_toml(sidecar, {"evaluated_m": None})
    read = read_model(sidecar, RecordSidecar, "sidecar")
    assert (read.evaluated_m, read.support_position_m) == ((300.0, 900.0), (300.0, 600.0))
    stored = read.model_dump(by_alias=True, exclude_none=True, exclude_defaults=True)
    assert RecordSidecar.model_validate(stored, strict=False) == read


PULSES = {"kind": "counter", "column": "v", "metres_per_pulse": 1.0, "start_m": 0.0}


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"track": None}, "key track: missing, but needed for kilometre marks"),
        ({"track": {"zero_km": ZERO_KM, "kilometres": "decreasing"}}, "the kilometres are not decreasing"),
        (
            {"columns": {**COLUMNS, "position_1_m": {"column": "km", "unit": "km"}}},
            "gives the position as well",
        ),
        (
            {"position": {"kind": "marks", "mark": [{"time_s": 1.0, "km": 0.1}, {"time_s": 1.0, "km": 0.2}]}},
            "the times do not increase",
        ),
        ({"position": PULSES | {"column": "x"}}, "no column 'x'"),
        ({"position": PULSES, "track": None}, None),
        ({"position": PULSES | {"kind": "pulses"}, "track": None}, "has 1 rising edges"),
        ({"evaluated_km": [119.6, 120.2]}, "key evaluated_km: evaluated_m gives the same"),
        ({"position": PULSES, "track": None, "support_km": [120.2]}, "key support_km: the table track is missing"),
        ({"support_position_m": [86.85, 86.8]}, "two supports are less than 0.5 m apart"),
    ],
)
def test_wrong_positions_name_their_key(change: dict[str, Any], message: str | None, tmp_path: Path) -> None:
    base = {**marks("increasing"), "track": {"zero_km": ZERO_KM, "kilometres": "increasing"}}
    content = {key: value for key, value in {**base, **change}.items() if value is not None}
    sidecar = write_logger_file(tmp_path, "increasing", content)
    with nullcontext() if message is None else pytest.raises(InputError, match=message):
        assert read_record(sidecar)[0].position[0, -1] == pytest.approx(0.4, abs=0.01)
