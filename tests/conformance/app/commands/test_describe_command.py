"""`pantocheck describe`: the facts about a file at 80 columns, and a sidecar that leads to a readable record."""

import re
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from helpers.command_line import pantocheck
from helpers.foreign_tables import FOREIGN_WRITERS
from pantocheck.conformance.cases.profile_file import load_profile
from pantocheck.conformance.core.measured_table import MeasuredTable, TableColumn
from pantocheck.conformance.drops.drop_reading import read_drop_records
from pantocheck.conformance.grading.assessed_record import load_assessed_record
from pantocheck.conformance.records.channel_facts import describe_time, list_channel_facts
from pantocheck.conformance.records.sidecar_tables import LineTable

RATE, SPEED = 500.0, 70.0
TIME = np.arange(12_000) / RATE
PLACE = SPEED * TIME

describe = partial(pantocheck, "describe")


@pytest.fixture
def logger(tmp_path: Path) -> Path:
    """German logger file: time stamp, decimal commas, units, decreasing kilometres, two pantographs."""
    force = [0.12 + 0.03 * np.sin(2 * np.pi * (PLACE - behind) / 60) for behind in (0, 200)]
    rows = [
        f"10:00:{t:06.3f};{t:.3f};{87.25 - x / 1000:.5f};252,0;{a:.6f};{b:.6f};12,5"
        for t, x, a, b in zip(TIME, PLACE, *force, strict=True)
    ]
    names = "Uhr;Messzeit;Kilometer;Geschwindigkeit;Kraft vorn;Kraft hinten;Temperatur"
    head = ["Messzug;707", "Strecke;Süd", "", names]
    text = "\n".join([*head, ";s;km;km/h;kN;kN;°C", *rows]).replace(".", ",")
    (tmp_path / "m.csv").write_text(text, encoding="cp1252")
    return tmp_path / "m.csv"


def complete(sidecar: Path, values: dict[str, str]) -> None:
    """Complete commented keys of a sidecar, as a user does."""
    text = sidecar.read_text(encoding="utf-8")
    for key, value in values.items():
        text, count = re.subn(rf"(?m)^# {re.escape(key)} = [^#\n]*", f"{key} = {value} ", text)
        assert count == 1, key
    sidecar.write_text(text, encoding="utf-8")


def test_facts_and_sidecar_of_a_logger_file(logger: Path) -> None:
    """Four keys are completed, the track is known; the statistics are those of the sine: 120 N, 30/sqrt(2) N."""
    sidecar = logger.with_suffix(".toml")
    result = describe(logger, "--sidecar", sidecar)
    assert result.exit_code == 0
    assert max(map(len, result.output.splitlines())) <= 80 or str(logger.parent) in result.output
    for text in ("encoding Windows-1252", "separator semicolon", "decimal comma", "| Strecke;Süd", "500 Hz", "text or"):
        assert text in result.output
    assert "constant" in result.output
    (unused,) = [line for line in sidecar.read_text("utf-8").splitlines() if line.startswith("# not used")]
    assert ("Temperatur" in unused, "Kraft" in unused) == (True, False)
    decided = {"speed_km_h": "252.0", "filter_applied_Hz": '"none"', "evaluated_km": "[86.95, 85.87]"}
    complete(sidecar, {**decided, "spacing_m": "[200.0]"})
    assessed = load_assessed_record(sidecar, load_profile("acceptance-ac"), LineTable())
    for number in (1, 2):
        values = assessed.values.values[number]
        # Six decimals of kilonewtons; 1080 m are eighteen spans of 60 m.
        assert values["mean_force_N"] == pytest.approx(120.0, abs=0.01)
        assert values["std_force_N"] == pytest.approx(30 / np.sqrt(2), abs=0.05)


def test_column_km_without_a_unit_is_a_kilometre(logger: Path) -> None:
    text = logger.read_text("cp1252").replace("Kilometer", "km").replace(";s;km;", ";s;;")
    logger.write_text(text, encoding="cp1252")
    sidecar = logger.with_suffix(".toml")
    assert describe(logger, "--sidecar", sidecar).exit_code == 0
    complete(sidecar, {"speed_km_h": "252.0", "filter_applied_Hz": '"none"', "evaluated_km": "[86.95, 85.87]"})
    complete(sidecar, {"spacing_m": "[200.0]"})
    assert 'kilometres = "decreasing"' in sidecar.read_text("utf-8")
    # The file begins at kilometre 87.25, where x = 0.
    assert load_assessed_record(sidecar, load_profile("acceptance-ac"), LineTable()).header.evaluated_m == (
        pytest.approx(300.0, abs=0.01),
        pytest.approx(1380.0, abs=0.01),
    )


def test_ambiguous_table_names_the_options_and_no_sidecar_is_overwritten(logger: Path, tmp_path: Path) -> None:
    sidecar = logger.with_suffix(".toml")
    sidecar.write_text("mine")
    result = describe(logger, "--out", sidecar)
    assert result.exit_code == 2
    assert "exists already" in result.output
    assert sidecar.read_text() == "mine"
    (tmp_path / "a.csv").write_text("0,1\n2,3\n4,5\n")
    result = describe(tmp_path / "a.csv")
    assert result.exit_code == 2
    assert "--separator" in result.output
    result = describe(tmp_path / "a.csv", "--separator", ",", "--sidecar", tmp_path / "a.toml")
    assert result.exit_code == 0
    assert 'separator = ","' in (tmp_path / "a.toml").read_text()


@pytest.mark.parametrize("name", FOREIGN_WRITERS)
def test_drop_of_every_format_is_described_and_its_sidecar_is_read(name: str, tmp_path: Path) -> None:
    """Accelerations without a force are a mass drop; the sidecar is read without a change."""
    time = np.arange(2000) / 200
    signals = {f"S{k}_z": np.random.default_rng(k).standard_normal(2000) for k in (1, 2)}
    FOREIGN_WRITERS[name](tmp_path / name, {"time_s": time, **signals})
    sidecar = (tmp_path / name).with_suffix(".toml")
    result = describe(tmp_path / name, "--sidecar", sidecar)
    assert result.exit_code == 0, result.output
    assert "[[channel]]" in sidecar.read_text()
    (record,) = read_drop_records(tmp_path / name)
    assert record.rate == pytest.approx(200.0)
    assert record.signals.shape == (2000, 2)


@pytest.mark.parametrize("name", FOREIGN_WRITERS)
def test_force_record_of_every_format_is_described(name: str, tmp_path: Path) -> None:
    channels = {"time_s": TIME, "Kraft_1": 120 + np.sin(PLACE), "Kraft_2": 121 + np.cos(PLACE), "v": 0 * TIME + SPEED}
    FOREIGN_WRITERS[name](tmp_path / name, channels)
    result = describe(tmp_path / name, "--sidecar", tmp_path / "s.toml", "--kind", "record")
    assert result.exit_code == 0, result.output
    assert "500 Hz" in result.output
    draft = (tmp_path / "s.toml").read_text()
    assert re.search(r'force_2_N = \{ column = "(daq/)?Kraft_2" \}   # COMPLETE: unit', draft)


def test_draft_of_several_force_sensors_points_to_scale_and_sum(tmp_path: Path) -> None:
    """A signal in volts needs a scale; two sensors have the same units as the forces of two pantographs."""
    scaled = '# force_2_N = { column = "Kraft rechts", unit = "N", scale = 1.0 }   # COMPLETE: N per V'
    plain = 'force_2_N = { column = "Kraft rechts", unit = "N" }'
    rows = "\n".join(f"{t:.3f};{a:.4f};{a / 2:.4f}" for t, a in zip(TIME, 60 + np.sin(PLACE), strict=True))
    sums = {"V": (scaled, "the sum of several sensors"), "N": (plain, "[columns.force_1_N] with sum = [...]")}
    for unit, texts in sums.items():
        (tmp_path / f"{unit}.csv").write_text(f"Zeit;Kraft links;Kraft rechts\ns;{unit};{unit}\n{rows}")
        describe(tmp_path / f"{unit}.csv", "--sidecar", tmp_path / f"{unit}.toml")
        draft = (tmp_path / f"{unit}.toml").read_text()
        assert [text for text in texts if text not in draft] == []


def test_suspicious_contents_gaps_and_repetitions_are_named() -> None:
    sine = np.sin(PLACE)
    held, speed = np.repeat(sine, 4)[: TIME.size], np.round(200 + TIME / TIME[-1], 1)
    values = np.column_stack([sine, sine, np.clip(sine, -0.5, 0.5), held, 0 * TIME, speed])
    table = MeasuredTable("a.csv", values, tuple(TableColumn(name) for name in "abcdef"))
    remarks = [fact.remarks for fact in list_channel_facts(table)]
    assert remarks[0] == ()
    assert remarks[1] == ("same numbers as 'a'",)
    assert "overloaded" in remarks[2][0]
    assert "repeat the one before: recorded at a lower rate?" in remarks[3][0]
    assert remarks[4] == ("constant",)
    # A speed with a resolution of 0.1 km/h is no dead channel.
    assert remarks[5][0].startswith(f"changes seldom: 11 different values in {TIME.size} samples, at least 0.1 apart. ")
    values = np.column_stack([TIME, -TIME, 0 * TIME, np.sin(PLACE)])
    facts_of_trend = list_channel_facts(MeasuredTable("a.csv", values, tuple(TableColumn(name) for name in "abcd")))
    assert [fact.trend for fact in facts_of_trend] == [1, -1, 0, 0]
    # Samples 100 to 149 are missing, sample 500 is repeated.
    time = np.r_[np.arange(100), np.arange(150, 500), 499, np.arange(500, 900)] / 100
    facts = describe_time("t", None, time)
    assert facts is not None
    assert facts.rate == pytest.approx(100.0)
    assert facts.remarks == ("1 times repeated, first at 4.99 s", "1 gaps, the longest of 0.51 s at 0.99 s")
