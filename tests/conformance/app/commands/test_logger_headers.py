"""What `describe` writes, `check` accepts: headers in nine languages, units in seven spellings, both records."""

import re
import tomllib
from collections.abc import Callable, Sequence
from itertools import product
from pathlib import Path

import numpy as np
import pytest

from helpers.command_line import pantocheck
from pantocheck.conformance.core.channel_names import find_time_factor, list_meanings, split_unit
from pantocheck.conformance.drops.drop_reading import read_drop_records
from pantocheck.conformance.records.record_reading import read_record

HEADERS = tomllib.loads((Path(__file__).parents[2] / "core" / "logger_headers.toml").read_text(encoding="utf-8"))
RATE, SPEED = 200.0, 70.0
SHARES = [3, pytest.param(1, marks=pytest.mark.thorough)]

Column = tuple[str, str]
"""Name and unit."""

SPELLINGS: dict[str, Callable[[str, str], str]] = {
    "square brackets": "{} [{}]".format,
    "round brackets": "{} ({})".format,
    "slash": "{}/{}".format,
    "slash and blanks": "{} / {}".format,
    "the word in": "{} in {}".format,
    "underscore": lambda name, unit: f"{name.replace(' ', '_')}_{unit.replace('/', '_')}",
    "line of units": lambda name, unit: name,
}


def write_table(path: Path, columns: Sequence[Column], spelling: str, values: np.ndarray) -> None:
    """Text table with semicolons and decimal commas; the units stand as the spelling says."""
    head = [";".join(SPELLINGS[spelling](*column) for column in columns)]
    if spelling == "line of units":
        head.append(";".join(unit for _, unit in columns))
    rows = [";".join(f"{value:.6f}" for value in row).replace(".", ",") for row in values]
    path.write_text("\n".join([*head, *rows]), encoding="utf-8", newline="\n")


def choose_spellings(language: str, share: int) -> list[str]:
    """Every nth spelling, from another one for each language, so that each meets three languages or more."""
    return list(SPELLINGS)[list(HEADERS).index(language) % share :: share]


def complete(sidecar: Path) -> None:
    """Complete the lines with COMPLETE that a reader needs, and nothing else."""
    text = sidecar.read_text(encoding="utf-8")
    values = {"speed_km_h": "252.0", "filter_applied_Hz": '"none"', "evaluated_m": "[10.0, 60.0]", "spacing_m": "[5.0]"}
    for key, value in values.items():
        text = re.sub(rf"(?m)^# {key} = [^#\n]*(?=# COMPLETE)", f"{key} = {value} ", text)
    sidecar.write_text(text, encoding="utf-8", newline="\n")


def find_draft_faults(kind: str, folder: Path, columns: Sequence[Column], spelling: str, values: np.ndarray) -> str:
    """What `check` says against the completed sidecar of `describe`; empty if it is accepted."""
    table = folder / "logger.csv"
    sidecar = table.with_suffix(".toml")
    write_table(table, columns, spelling, values)
    sidecar.unlink(missing_ok=True)
    drafted = pantocheck("describe", table, "--kind", kind, "--sidecar", sidecar)
    if drafted.exit_code:
        return drafted.output
    complete(sidecar)
    checked = pantocheck("check", sidecar)
    return checked.output if checked.exit_code else ""


@pytest.mark.parametrize("share", SHARES)
@pytest.mark.parametrize("language", HEADERS)
def test_check_accepts_what_describe_writes_for_a_force_record(language: str, share: int, tmp_path: Path) -> None:
    """Time in milliseconds in second place, forces in kilonewtons: values and rate are those that were written."""
    names, time = HEADERS[language], np.arange(400) / RATE
    forces = [0.12 + 0.01 * np.sin(time + k) for k in (0, 1)]
    values = np.column_stack([forces[0], 1e3 * time, forces[1], SPEED * time, np.full(400, 3.6 * SPEED)])
    first, second = names["force"]
    columns = [(first, "kN"), (names["time"], "ms"), (second, "kN"), (names["position"], "m"), (names["speed"], "km/h")]
    faults = {}
    for spelling in choose_spellings(language, share):
        fault = find_draft_faults("record", tmp_path, columns, spelling, values)
        if not fault:
            record, _ = read_record(tmp_path / "logger.toml")
            # Six decimals of milliseconds and kilonewtons.
            assert record.time[-1] - record.time[0] == pytest.approx(time[-1], abs=1e-8)
            assert record.force == pytest.approx(1e3 * np.array(forces), abs=1e-3)
        faults[spelling] = fault
    assert {spelling: fault for spelling, fault in faults.items() if fault} == {}


@pytest.mark.parametrize("share", SHARES)
@pytest.mark.parametrize("language", HEADERS)
def test_check_accepts_what_describe_writes_for_a_mass_drop(language: str, share: int, tmp_path: Path) -> None:
    """A text column and one of temperatures stand between the channels, which keep their numbers."""
    names, time = HEADERS[language], np.arange(400) / RATE
    noise = np.random.default_rng(5).standard_normal((400, 2))
    values = np.column_stack([np.linspace(20, 21, 400), 1e3 * time, noise])
    moved = [(f"{names['acceleration']} {k}", unit) for k, unit in ((1, "m/s2"), (2, "g"))]
    columns = [("Temperatur", "°C"), (names["time"], "ms"), *moved]
    faults = {}
    for spelling in choose_spellings(language, share):
        faults[spelling] = find_draft_faults("mass-drop", tmp_path, columns, spelling, values)
        if not faults[spelling]:
            (record,) = read_drop_records(tmp_path / "logger.csv")
            assert record.rate == pytest.approx(RATE, rel=1e-6)
            # Six decimals; one g is 9.80665 m/s2.
            assert record.signals == pytest.approx(noise * [1.0, 9.80665], abs=1e-5)
    assert {spelling: fault for spelling, fault in faults.items() if fault} == {}


def test_draft_that_is_not_completed_is_refused_for_its_marked_keys_only(tmp_path: Path) -> None:
    """Every key that `check` asks for is marked with COMPLETE in the draft."""
    time = np.arange(400) / RATE
    columns = [("Zeit", "s"), ("Kraft vorn", "kN"), ("Kraft hinten", "kN")]
    write_table(tmp_path / "m.csv", columns, "square brackets", np.column_stack([time, 0.1 + time, 0.2 + time]))
    pantocheck("describe", tmp_path / "m.csv", "--kind", "record", "--sidecar", tmp_path / "m.toml")
    draft = (tmp_path / "m.toml").read_text(encoding="utf-8")
    refused = pantocheck("check", tmp_path / "m.toml")
    assert refused.exit_code == 2
    asked = set(re.findall(r"key ([a-z_A-Z0-9]+)", refused.output))
    assert asked
    for key in asked:
        assert re.search(rf"(?m)^# {key} = .*COMPLETE", draft), key


def test_meaning_and_unit_of_names_of_known_exports() -> None:
    """Names of common exports; units of another quantity and words inside other words name nothing."""
    time = {
        "Zeit  1 - Standardmessrate [s]": 1.0,
        "X_Value": 1.0,
        "Time  1 - default sample rate [ms]": 1e-3,
        "daq/t": 1.0,
    }
    assert {name: find_time_factor(name, None) for name in time} == time
    assert [find_time_factor(name, None) for name in ("Temperatur", "Zeit [kN]", "Sometimes", "Kraft")] == [None] * 4
    assert find_time_factor("Zeit", "ms") == 1e-3
    assert split_unit("v / (km/h)") == ("v", "km/h")
    assert split_unit("daq/Kraft_2") == ("Kraft_2", None)
    assert split_unit("sensor_t") == ("sensor_t", None), "a tonne is no unit of any channel"
    meanings = {
        "Anhub Mast [mm]": "uplift",
        "Fahrdrahthöhe [m]": "contact_height",
        "Kraft [V]": None,
        "Kilometrierung": "position",
    }
    assert {name: next(list_meanings(name, None), (None, None))[0] for name in meanings} == meanings


def test_every_pair_of_a_language_and_a_channel_has_one_meaning() -> None:
    """No name of the corpus is taken for another channel."""
    wrong = [
        (language, channel, name)
        for (language, names), channel in product(
            HEADERS.items(), ("time", "force", "position", "speed", "acceleration")
        )
        for name in (names[channel] if isinstance(names[channel], list) else [names[channel]])
        if [found for found, _ in list_meanings(name, None)][:1] != [channel]
    ]
    assert wrong == []
