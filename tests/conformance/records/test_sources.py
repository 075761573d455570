"""Records of several sources: their clocks, the uplift criterion of a line test, wrong clocks and damaged inputs."""

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st

from helpers.command_line import pantocheck
from helpers.measured_pairs import PASSAGE, SPEED, STATED, MeasuredPair, write_german, write_masts
from helpers.toml_edit import edit_toml
from pantocheck.conformance.app.notebook.graded_results import assess_run
from pantocheck.conformance.cases.profile_file import load_profile
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.grading.assessed_record import AssessedRecord, load_assessed_record
from pantocheck.conformance.pages.translation import translate
from pantocheck.conformance.records.sidecar_tables import LineTable
from pantocheck.conformance.records.uplift_sensor import find_uplift_fault

UPLIFT = "max_uplift_at_support_mm"
SECONDS = 'kind = "pps", column = "PPS", record_column = "PPS", offset_s = 3.4'


def assess(sidecar: Path) -> AssessedRecord:
    return load_assessed_record(sidecar, load_profile("acceptance-ac"), LineTable())


def read_results(sidecar: Path) -> dict[str, Any]:
    """Result of `assess` on the command line."""
    report = sidecar.parent / "report"
    done = pantocheck("assess", sidecar, "--profile", "acceptance-ac", "--out", report, "--formats", "json")
    assert done.exit_code < 2, done.output
    return json.loads((report / "results.json").read_text())["cases"][0]


def truth(pair: MeasuredPair) -> float:
    """Largest uplift that was written [mm]."""
    return float(pair.masts()[:, 1:].max())


def add_seconds(folder: Path, pair: MeasuredPair) -> None:
    """Pulses of 20 ms at each full second of GPS time in both files; the record starts 0.4 s after one."""
    for name, table in (("zug.csv", pair.train()), ("mast.csv", pair.masts())):
        head = (folder / name).read_text(encoding="cp1252").splitlines()[0].split(";")
        clock = table[:, 0] if name == "zug.csv" else table[:, 0] / (1 + pair.drift) + pair.offset
        pulses = np.where((clock + 0.4) % 1.0 < 0.02, 5.0, 0.0)
        write_german(folder / name, [*head, "PPS"], np.column_stack([table, pulses]))


@pytest.mark.parametrize("join", [PASSAGE, STATED, SECONDS])
@pytest.mark.parametrize("pantographs", [1, 2])
def test_uplift_of_a_line_test_is_graded_from_two_files(join: str, pantographs: int, tmp_path: Path) -> None:
    """The largest sample is that of the file at its own rate: 1e-5 mm is the rounding of the file."""
    pair = MeasuredPair(pantographs)
    sidecar = pair.write(tmp_path, join)
    if join == SECONDS:
        add_seconds(tmp_path, pair)
    result = read_results(sidecar)
    assert result["verdict"] == "pass"
    assert result["quantities"]["0"][UPLIFT] == pytest.approx(truth(pair), abs=1e-5)
    (source,) = result["sources"]
    assert (source["state"], source["rate_Hz"]) == ("confirmed", 200)
    # The middle of the ties differs from the time 0 by seconds, but there is no drift.
    assert abs(source["offset_s"] - pair.offset) <= source["uncertainty_s"]
    assert len(source["passages"]) == 3 * pantographs
    assert [len(series["x"]) > 300 for series in source["chart"]["series"]] == [True] * 3
    assert len(source["chart"]["marks"]) == pantographs
    assert result["uncertainty_components"]["0"][UPLIFT]["alignment"] == 0
    assert result["uncertainty_components"]["1"]["mean_force_N"]["alignment"] == 0


def test_clocks_of_each_file_differ_in_rate_and_offset(tmp_path: Path) -> None:
    """Three masts with loggers of 100, 200 and 500 Hz; each keeps its own samples."""
    pairs = [
        MeasuredPair(supports=(x,), rate=f, offset=o) for x, f, o in ((300, 100, 1), (360, 200, -40), (420, 500, 7))
    ]
    sidecar = MeasuredPair().write(tmp_path, PASSAGE)
    content = sidecar.read_text().partition("[[source]]")[0]
    for n, pair in enumerate(pairs, 1):
        write_german(tmp_path / f"mast{n}.csv", ["t [s]", "Anhub [mm]"], pair.masts())
        content += f"""
[[source]]
file = "mast{n}.csv"
join = {{ kind = "passage", offset_s = {pair.offset + 0.4}, within_s = 2.0 }}
[source.columns]
time_s = {{ column = "t [s]" }}
uplift_{n}_m = {{ column = "Anhub [mm]" }}
"""
    sidecar.write_text(content)
    result = read_results(sidecar)
    assert result["verdict"] == "pass"
    assert [source["rate_Hz"] for source in result["sources"]] == [100, 200, 500]
    assert result["quantities"]["0"][UPLIFT] == pytest.approx(max(map(truth, pairs)), abs=1e-5)
    assert [part["uplift_m"]["samples"] for part in result["signals"]["uplift"]] == [
        # 60 m before to 60 m past the support, and 200 m between the pantographs.
        pytest.approx(320 / SPEED * rate, abs=1)
        for rate in (100, 200, 500)
    ]
    verified = pantocheck("verify", tmp_path / "report" / "results.json", "--record", sidecar, "--numbers-only")
    assert "fahrt.toml is the graded record" in verified.output
    assert "follow from the samples" in verified.output
    table = tmp_path / "mast2.csv"
    table.write_text(table.read_text(encoding="cp1252").replace("0,50000", "0,50001", 1), encoding="cp1252")
    verified = pantocheck("verify", tmp_path / "report" / "results.json", "--record", sidecar, "--numbers-only")
    assert verified.exit_code == 1
    assert "fahrt.toml is not the graded record" in verified.output


# Wrong clocks.
WRONG: dict[str, tuple[MeasuredPair, str, str]] = {
    "one second late": (
        MeasuredPair(),
        STATED.replace("3.217", "4.217"),
        "pulses come 1.00 s after the pantographs pass",
    ),
    "one second early": (MeasuredPair(), STATED.replace("3.217", "2.217"), "pulses come 1.00 s before the pantographs"),
    "half a span": (MeasuredPair(), STATED.replace("3.217", "3.617"), "pulses come 0.40 s after the pantographs pass"),
    "the other pantograph": (MeasuredPair(), STATED.replace("3.217", "6.074"), "pulses come 2.86 s after"),
    "one pantograph, 1 s": (MeasuredPair(1), STATED.replace("3.217", "4.217"), "pulses come 1.00 s after"),
    "a minute": (MeasuredPair(1, times=(-5, 90)), STATED.replace("3.217", "63.217"), "pulses come 60.00 s after"),
    "wrong second": (MeasuredPair(), SECONDS.replace("3.4", "4.4"), "pulses come 0.99 s after the pantographs pass"),
    "100 ppm for an hour": (
        MeasuredPair(offset=-3600.0, drift=1e-4),
        'kind = "time", offset_s = -3600.0, uncertainty_s = 0.01',
        "a drift of 100 ppm since its time 0 would explain it",
    ),
    "another train": (
        replace(MeasuredPair(1), pantographs=2, heights=(0.05, 0.0)),
        PASSAGE,
        "its pulses fit no passage of this train",
    ),
    "no uplift": (MeasuredPair(heights=(0.0, 0.0)), STATED, "it must hold the passage of each pantograph at each of"),
    "cut before the rear pantograph passes": (
        MeasuredPair(times=(-4.0, 7.0)),
        STATED,
        "fit no passage of this train; by its clock it holds 3 of the 6 passages of the pantographs at its supports",
    ),
    "cut, without a time": (
        MeasuredPair(times=(-4.0, 7.0)),
        PASSAGE,
        "it must hold the passage of each pantograph at each of its supports",
    ),
}


@pytest.mark.parametrize("name", WRONG)
def test_wrong_clock_is_found_and_named(name: str, tmp_path: Path) -> None:
    """The uplift does not count, and the reason names the file and the error."""
    pair, join, reason = WRONG[name]
    sidecar = pair.write(tmp_path, join)
    if join.startswith(SECONDS[:12]):
        add_seconds(tmp_path, pair)
    result = read_results(sidecar)
    assert result["verdict"] == "skip"
    assert reason in result["skipped"]["0"][UPLIFT]
    assert any(text.startswith("the clock of mast.csv is") and reason in text for text in result["warnings"])
    (criterion,) = (row for row in result["criteria"] if row["quantity"] == UPLIFT)
    assert criterion["verdict"] == "skip"


def test_pulses_of_a_second_measure_the_drift(tmp_path: Path) -> None:
    """10 seconds of pulses at 200 Hz give a drift of 1000 ppm to 500 ppm; it is corrected."""
    pair = MeasuredPair(drift=2e-3)
    sidecar = pair.write(tmp_path, SECONDS)
    add_seconds(tmp_path, pair)
    result = read_results(sidecar)
    (source,) = result["sources"]
    assert result["verdict"] == "pass"
    assert abs(source["drift_ppm"] + 2000) < source["drift_uncertainty_ppm"] < 700
    assert any("the clock of mast.csv runs" in text and "fast" in text for text in result["warnings"])


def test_two_passages_of_the_same_train_need_a_choice(tmp_path: Path) -> None:
    """A second passage 60 s later in the file of the masts: within_s decides, and nothing is guessed."""
    pair = MeasuredPair()
    sidecar = pair.write(tmp_path, PASSAGE.replace("20.0", "100.0"))
    table = pair.masts()
    later = table + np.array([60.0, 0, 0, 0])
    quiet = np.arange(table[-1, 0] + 0.005, later[0, 0] - 0.004, 0.005)
    rows = np.vstack([table, np.column_stack([quiet, np.zeros((quiet.size, 3))]), later])
    write_masts(tmp_path, rows)
    result = read_results(sidecar)
    assert result["verdict"] == "skip"
    assert "several passages fit, with offset_s = -56.7" in result["skipped"]["0"][UPLIFT]
    edit_toml(sidecar, {"source.0.join.within_s": 20.0})
    assert read_results(sidecar)["verdict"] == "pass"


def edit_mast(change: Callable[[list[str]], list[str]]) -> Callable[[Path], None]:
    def edit(folder: Path) -> None:
        path = folder / "mast.csv"
        path.write_text("\n".join(change(path.read_text(encoding="cp1252").splitlines())) + "\n", encoding="cp1252")

    return edit


# Removal of information.
def cut_rows(first: float, last: float) -> Callable[[Path], None]:
    def keep(row: str) -> bool:
        return first <= float(row.partition(";")[0].replace(",", ".")) + 3.217 <= last

    return edit_mast(lambda rows: [rows[0], *filter(keep, rows[1:])])


def edit_keys(changes: dict[str, Any]) -> Callable[[Path], object]:
    return lambda folder: edit_toml(folder / "fahrt.toml", changes)


REMOVALS: dict[str, Callable[[Path], object]] = {
    "start of the masts": cut_rows(4.5, 99),
    "passage of the masts": cut_rows(-9, 7.0),
    "end of the masts": cut_rows(-9, 8.4),
    "hole in the passage": edit_mast(lambda rows: [*rows[:1900], *rows[1910:]]),
    "one mast": edit_keys({"source.0.columns.uplift_2_m": None}),
    "one mast and its support": edit_keys({"source.0.columns.uplift_3_m": None, "support_position_m": [300.0, 360.0]}),
    "source": edit_keys({"source": None}),
    "second pantograph": edit_keys({"columns.force_2_N": None, "pantographs": 1, "spacing_m": None}),
    "span": edit_keys({"line.span_m": None}),
    "space for the uplift": edit_keys({"line.uplift_space_mm": None}),
}


@pytest.mark.parametrize("join", [PASSAGE, STATED])
def test_removing_information_never_makes_a_pass(join: str, tmp_path: Path) -> None:
    """The uplift of the last mast exceeds its space by 0.01 %."""
    pair, exit_codes = MeasuredPair(), {}
    space = {"line.uplift_space_mm": truth(pair) / 1.0001}
    options = ("--profile", "acceptance-ac", "--formats", "json", "--out", tmp_path / "removed")
    for name, remove in REMOVALS.items():
        sidecar = edit_toml(pair.write(tmp_path, join), space)
        if not exit_codes:
            assert read_results(sidecar)["verdict"] == "fail"
        remove(tmp_path)
        exit_codes[name] = pantocheck("assess", sidecar, *options).exit_code
    assert [name for name, exit_code in exit_codes.items() if exit_code == 0] == []


def test_gap_beside_the_passage_hides_no_uplift(tmp_path: Path) -> None:
    """A smooth wave of 60 mm, 40 m before a support, exceeds the space; without its samples, nothing is graded."""
    pair = MeasuredPair(1)
    sidecar = edit_toml(pair.write(tmp_path, STATED), {"line.uplift_space_mm": 55.0})
    table = pair.masts()
    distance = SPEED * (table[:, 0] + pair.offset) - 360 + 40
    table[:, 2] += 60.0 * np.exp(-((distance / 10) ** 2))
    write_masts(tmp_path, table)
    assert read_results(sidecar)["verdict"] == "fail"
    write_masts(tmp_path, table[np.abs(distance) > 15])
    result = read_results(sidecar)
    assert result["verdict"] == "skip"
    assert "the uplift at 420 m has no rest" in result["skipped"]["0"][UPLIFT]


def test_uncertain_clock_leaves_an_uplift_near_its_space_undecided(tmp_path: Path) -> None:
    """A wave of 55 mm, 62 m before the support, counts if the clock is wrong by 0.1 s, which is stated as possible."""
    pair = MeasuredPair(1)
    sidecar = pair.write(tmp_path, STATED.replace("0.005", "0.1"))
    edit_toml(sidecar, {"line.uplift_space_mm": 53.0})
    table = pair.masts()
    near = np.abs(SPEED * (table[:, 0] + pair.offset) - 360 + 62) < 0.4
    table[near, 2] = 55.0
    write_masts(tmp_path, table)
    result = read_results(sidecar)
    (criterion,) = (row for row in result["criteria"] if row["quantity"] == UPLIFT)
    assert criterion["verdict"] == "undecided"
    assert criterion["components"]["alignment"] == pytest.approx(55 - criterion["value"], abs=1e-6)


# Sensors with a fault.
def change_mast(sidecar: Path, change: Callable[[np.ndarray], np.ndarray], pair: MeasuredPair | None = None) -> None:
    """Change the uplift of the second mast [mm]."""
    table = (pair or MeasuredPair()).masts()
    table[:, 2] = change(table[:, 2])
    write_masts(sidecar.parent, table)


def join_tables(pair: MeasuredPair) -> np.ndarray:
    """Train and masts in one table of one clock: time, position, forces [N], uplifts [mm]."""
    train, masts = pair.train(), pair.masts()
    columns = [np.interp(train[:, 0], masts[:, 0] + pair.offset, column) for column in masts[:, 1:].T]
    return np.column_stack([train, *columns])


def write_joined(folder: Path, table: np.ndarray) -> Path:
    """Write such a table of two pantographs, and its sidecar without further sources."""
    sidecar = MeasuredPair().write(folder, STATED)
    names = ["Zeit [s]", "Weg [m]", "Kraft 1 [N]", "Kraft 2 [N]", *(f"Anhub Mast {n} [mm]" for n in (1, 2, 3))]
    write_german(folder / "zug.csv", names, table)
    uplifts = {f"columns.uplift_{n}_m": {"column": f"Anhub Mast {n} [mm]"} for n in (1, 2, 3)}
    return edit_toml(sidecar, {"source": None, **uplifts})


@settings(max_examples=2, deadline=None)
@given(cut=st.tuples(st.floats(0, 1), st.floats(0, 1)), inside=st.booleans())
@example(cut=(0.0, 0.0), inside=True)
@example(cut=(0.0, 0.3), inside=True)  # the rest of the first support, 150 to 200 m, is in the first 26 %
@example(cut=(0.38, 0.39), inside=True)  # the passage of the first support
@example(cut=(0.81, 0.88), inside=True)  # a wave behind the last support, outside the sections of the forces
@example(cut=(0.0, 0.82), inside=False)  # ends 11 m past the last support
@example(cut=(0.0, 0.5), inside=False)  # no support is left
@pytest.mark.parametrize("fault", ["none", "zero", "wave before", "wave behind"])
def test_cut_of_a_table_of_one_clock_never_improves_its_verdict(
    fault: str, cut: tuple[float, float], inside: bool, tmp_path_factory: pytest.TempPathFactory
) -> None:
    """Rows inside or outside of a part are lost; the uplift is 5 mm too small, or a wave exceeds 80 mm."""
    table = join_tables(MeasuredPair(noise=0.0))
    if fault == "wave before":
        table[:, 4] += 90 * np.exp(-(((table[:, 1] - 250) / 5) ** 2))
    elif fault == "wave behind":
        table[:, 6] += 90 * np.exp(-(((table[:, 1] - 200 - 450) / 5) ** 2))
    elif fault == "zero":
        table[:, 4:] -= 5.0
    kept = np.full(len(table), inside)
    begin, end = (int(part * len(table)) for part in sorted(cut))
    kept[begin:end] = not inside
    assume(np.count_nonzero(kept) > 100)
    sidecar = write_joined(tmp_path_factory.mktemp("cut"), table[kept])
    try:
        verdict = assess_run(sidecar, "acceptance-ac").results.cases[0].verdict
    except InputError:
        assert not kept.all()
        return
    assert verdict == {"none": "pass", "zero": "skip"}.get(fault, "fail") or not kept.all()
    assert verdict != "pass" or fault == "none"


FAULTS: dict[str, tuple[Callable[[np.ndarray], np.ndarray], str]] = {
    "inverted": (np.negative, "the uplift at 360 m falls by 5"),
    "overloaded": (lambda uplift: np.minimum(uplift, 30.0), "the uplift at 360 m is flat at its largest value, 30 mm"),
    "zero error": (lambda uplift: uplift - 20.0, "the uplift at 360 m is -19.9 mm at rest, before the passage"),
    "zero error of 3 mm": (lambda uplift: uplift + 3.0, "mm at rest, before the passage, and not 0 within 2 mm"),
}


@pytest.mark.parametrize("fault", FAULTS)
@pytest.mark.parametrize("files", [1, 2])
def test_faulty_sensor_of_one_mast_is_named_and_not_graded(fault: str, files: int, tmp_path: Path) -> None:
    """Of a source, and of the uplift in the file of the force."""
    change, reason = FAULTS[fault]
    sidecar = MeasuredPair().write(tmp_path, STATED)
    change_mast(sidecar, change)
    if files == 1:
        table = join_tables(MeasuredPair())
        table[:, 5] = change(table[:, 5])
        sidecar = write_joined(tmp_path, table)
    result = read_results(sidecar)
    assert result["verdict"] == "skip"
    assert reason in result["skipped"]["0"][UPLIFT]
    assert reason in " ".join(pantocheck("check", sidecar, COLUMNS="400").output.split())


def test_inverted_mast_confirms_no_clock(tmp_path: Path) -> None:
    """A pulse of 13 mm up, 70 m behind the inverted one of 50 mm, fits the passage of one pantograph."""
    pair = MeasuredPair(1, supports=(300.0,))
    sidecar = edit_toml(pair.write(tmp_path, PASSAGE), {"evaluated_m": [270.0, 330.0]})
    table = pair.masts()
    rebound = 13 * np.exp(-np.abs(SPEED * (table[:, 0] + pair.offset) - 370) / 3)
    write_masts(tmp_path, np.column_stack([table[:, 0], rebound - table[:, 1]]))
    result = read_results(sidecar)
    assert [source["state"] for source in result["sources"]] == ["unconfirmed"]
    assert "the uplift at 300 m falls by" in result["skipped"]["0"][UPLIFT]


@pytest.mark.parametrize(
    ("step", "rate"),
    [
        pytest.param(step, rate, marks=pytest.mark.thorough if (i + k) % 2 else ())
        for i, step in enumerate((0.1, 0.5, 1.0, 2.0))
        for k, rate in enumerate((200.0, 1000.0, 5000.0))
    ],
)
def test_rounded_uplift_is_neither_overloaded_nor_off_zero(step: float, rate: float, tmp_path: Path) -> None:
    """A sensor in whole steps holds its largest value at a smooth maximum, and 1 mm are within the zero."""
    pair = MeasuredPair(noise=0.0, rate=rate, supports=(300.0, 360.0), times=(-1.0, 9.2))
    sidecar = pair.write(tmp_path, STATED)
    for smooth in (False, True):
        place = SPEED * np.arange(*pair.times, 1 / rate) - 360
        hump = 55 * np.exp(-((place / 15) ** 2)) if smooth else 0.0
        change_mast(sidecar, lambda uplift, hump=hump: np.round((uplift + hump) / step) * step, pair)
        assert "skips the uplift" not in " ".join(pantocheck("check", sidecar, COLUMNS="400").output.split())
    change_mast(sidecar, lambda uplift: uplift + 1.0, pair)
    assert read_results(sidecar)["verdict"] == "pass"


def test_mast_file_without_a_rest_does_not_pass(tmp_path: Path) -> None:
    """The file of the masts begins 85 m before the support; a zero error of -3 mm could hide there."""
    pair = MeasuredPair(1, times=(215 / SPEED, 16.0))
    sidecar = pair.write(tmp_path, STATED)
    edit_toml(sidecar, {"evaluated_m": [300.0, 350.0], "source.0.columns.uplift_2_m": None,
                        "source.0.columns.uplift_3_m": None, "support_position_m": [300.0]})  # fmt: skip
    table = pair.masts()
    table[:, 1] -= 3.0
    write_masts(tmp_path, table)
    result = read_results(sidecar)
    assert result["verdict"] == "skip"
    reasons = [row["reason"] for row in result["criteria"] if row["quantity"] == UPLIFT]
    assert "has no rest, 100 to 150 m before the passage" in reasons[0]
    assert translate(reasons[0], "de").missing == ()


@pytest.mark.parametrize(("begin", "gap", "fault"), [(0, 1, "mm at rest"), (0, 3, "no rest"), (155, 1, "no rest")])
def test_rest_counts_as_a_whole(begin: int, gap: int, fault: str) -> None:
    """The zero is -4 mm up to 120 m before the support, and 0 behind it; a part of the rest would pass."""
    place = np.r_[begin:180, 180 + gap : 400].astype(float)
    uplift = 0.05 * np.exp(-np.abs(place - 300) / 12) - 0.004 * (place < 180)
    assert fault in (find_uplift_fault(300.0, uplift, place, place) or "")


@pytest.mark.parametrize("copy", ["same column", "copied file"])
def test_mast_of_one_support_cannot_stand_for_another(copy: str, tmp_path: Path) -> None:
    sidecar = MeasuredPair().write(tmp_path, STATED)
    (tmp_path / "copy.csv").write_bytes((tmp_path / "mast.csv").read_bytes())
    column, time = {"column": "Anhub Mast 1 [mm]"}, {"column": "Uhrzeit [s]"}
    join = {"kind": "time", "offset_s": 3.217, "uncertainty_s": 0.005}
    if copy == "same column":
        changes, names = {"source.0.columns.uplift_2_m": column}, ("mast.csv", "mast.csv")
    else:
        source = {"file": "copy.csv", "join": join, "columns": {"time_s": time, "uplift_2_m": column}}
        changes, names = {"source.0.columns.uplift_2_m": None, "source.1": source}, ("copy.csv", "mast.csv")
    done = pantocheck("check", edit_toml(sidecar, changes), COLUMNS="400")
    assert done.exit_code == 2
    text = f"uplift_2_m of {names[0]} has the same samples as uplift_1_m of {names[1]}, at another support"
    assert text in " ".join(done.output.split())


@pytest.mark.parametrize(("column", "copy", "text"), [
    (4, 5, "uplift_2_m of zug.csv has the same samples as uplift_1_m of zug.csv, at another support"),
    (2, 3, "force_2_N of zug.csv has the same samples as force_1_N of zug.csv, at another pantograph"),
])  # fmt: skip
def test_copied_column_of_one_table_is_refused(column: int, copy: int, text: str, tmp_path: Path) -> None:
    table = join_tables(MeasuredPair())
    table[:, copy] = table[:, column]
    done = pantocheck("check", write_joined(tmp_path, table), COLUMNS="400")
    assert done.exit_code == 2
    assert text in " ".join(done.output.split())


# Position from another file.
def write_position(folder: Path, join: str, clock: Callable[[np.ndarray], np.ndarray]) -> Path:
    """Position and speed in a file of 10 Hz, with a time of its own."""
    pair = MeasuredPair(1)
    time = np.arange(-1.0, 12.0, 0.1)
    names = ["GPS [s]", "Kilometrierung [km]", "Geschwindigkeit [km/h]"]
    rows = np.column_stack([clock(time), 12.5 - SPEED * time / 1000, np.full(time.size, 3.6 * SPEED)])
    write_german(folder / "gps.csv", names, rows)
    sidecar = pair.write(folder, PASSAGE)
    text = sidecar.read_text().replace('position_1_m = { column = "Weg [m]" }\n', "")
    text += f"""
[[source]]
file = "gps.csv"
join = {{ {join} }}
[source.columns]
time_s = {{ column = "GPS [s]" }}
position_1_m = {{ column = "Kilometrierung [km]" }}
speed_m_s = {{ column = "Geschwindigkeit [km/h]" }}
[track]
zero_km = 12.5
kilometres = "decreasing"
"""
    sidecar.write_text(text)
    return sidecar


@pytest.mark.parametrize(
    "join",
    [
        'kind = "time", offset_s = -1732382000.0, uncertainty_s = 0.02',
        'kind = "marks", mark = [{ time_s = 1.0, km = 12.43 }, { time_s = 9.0, km = 11.87 }]',
    ],
)
def test_position_of_another_file_places_the_force(join: str, tmp_path: Path) -> None:
    """Seconds since 1970; marks are read to the metre of their kilometres, so that they join to 0.1 ms."""
    pair = MeasuredPair(1)
    reference = pair.write(tmp_path, PASSAGE)
    expected = assess(reference)
    assessed = assess(write_position(tmp_path, join, lambda time: time + 1732382000.0))
    for name, value in expected.values.values[1].items():
        # The section may begin one sample of 2 ms earlier or later.
        assert assessed.values.values[1][name] == pytest.approx(value, rel=2e-3, abs=1e-3), name
    component = assessed.uncertainty.components["alignment"].half_widths
    assert 0 < component[1]["mean_force_N"] < 5
    assert component[1].keys() == assessed.values.values[1].keys()
    assert assessed.values.values[0][UPLIFT] == expected.values.values[0][UPLIFT]
    assert assessed.prepared is not None
    assert [name for name, _, _ in assessed.prepared.place_clocks] == ["gps.csv"]


def split_forces(folder: Path, late: float = 0.0, step: int = 1) -> Path:
    """Rear force in a file of its own, whose clock is 12.3456 s behind and whose offset is stated `late`."""
    pair = MeasuredPair()
    sidecar, train = pair.write(folder, STATED), pair.train()
    write_german(folder / "rear.csv", ["Zeit [s]", "Kraft [N]"], (train[:, [0, 3]] - [12.3456, 0.0])[::step])
    join = {"kind": "time", "offset_s": 12.3456 + late, "uncertainty_s": 0.002}
    columns = {"time_s": {"column": "Zeit [s]"}, "force_2_N": {"column": "Kraft [N]"}}
    return edit_toml(
        sidecar, {"columns.force_2_N": None, "source.1": {"file": "rear.csv", "join": join, "columns": columns}}
    )


def test_rear_force_of_a_file_with_its_own_clock_is_that_of_one_file(tmp_path: Path) -> None:
    """Four tenths of a sample lie between the times of both files, so that the rear force is interpolated."""
    one = assess(MeasuredPair().write(tmp_path, STATED)).values.values
    (tmp_path / "two").mkdir()
    both = assess(split_forces(tmp_path / "two")).values.values
    assert both[1] == one[1]
    for name in ("mean_force_N", "std_force_N", "max_force_N", "min_force_N", "rms_20_50_N"):
        # A component of 38 Hz and 12 N is damped by less than 0.4 % between samples of 2 ms.
        assert both[2][name] == pytest.approx(one[2][name], abs=0.02), name
    (tmp_path / "late").mkdir()
    late = assess(split_forces(tmp_path / "late", late=0.5)).values.values
    assert abs(late[2]["mean_force_N"] - one[2]["mean_force_N"]) > 0.05


def test_rear_force_keeps_its_gap_and_needs_the_rate_of_the_first(tmp_path: Path) -> None:
    """A gap of 20 ms at 8 s, where the rear pantograph is at 360 m, inside the analysis section."""
    sidecar = split_forces(tmp_path)
    rows = (tmp_path / "rear.csv").read_text(encoding="cp1252").splitlines()
    (tmp_path / "rear.csv").write_text("\n".join([*rows[:4000], *rows[4010:]]) + "\n", encoding="cp1252")
    values = assess(sidecar).values.values
    assert isinstance(values[1]["mean_force_N"], float)
    assert not isinstance(values[2].get("mean_force_N"), float)
    (tmp_path / "slow").mkdir()
    with pytest.raises(InputError, match="has a force with 250 samples per second, and the first file 500"):
        assess(split_forces(tmp_path / "slow", step=2))


def test_wrong_clock_of_the_position_is_named_by_the_masts(tmp_path: Path) -> None:
    """The masts cannot tell which of both clocks is wrong; their uplift does not count."""
    sidecar = write_position(tmp_path, 'kind = "time", offset_s = 1.0, uncertainty_s = 0.01', lambda time: time)
    edit_toml(sidecar, {"source.0.join": {"kind": "time", "offset_s": 3.217, "uncertainty_s": 0.01}})
    skipped = assess(sidecar).values.skipped[0][UPLIFT]
    assert "the clock of mast.csv is wrong: its pulses come 1.00 s before the pantographs pass" in skipped


# Damaged inputs: each message names the file, the key or the sample, and the found and the expected.
DAMAGES: dict[str, tuple[Callable[[Path], object], tuple[str, ...]]] = {
    "missing file": (lambda folder: (folder / "mast.csv").unlink(), ("record 'mast.csv'", "No such file")),
    "path": (edit_keys({"source.0.file": "../mast.csv"}), ("source[1].file", "found the path '../mast.csv'")),
    "digest": (edit_keys({"source.0.sha256": "0" * 64}), ("record 'mast.csv'", "sha256")),
    "text": (edit_mast(lambda rows: [*rows[:9], "a;b;c;d", *rows[9:]]), ("record 'mast.csv', line 10", "'a'")),
    "time backwards": (
        edit_mast(lambda rows: [*rows[:50], rows[40], *rows[50:]]),
        ("source[1], mast.csv", "the time of sample 50 is not greater"),
    ),
    "column": (
        edit_keys({"source.0.columns.uplift_2_m.column": "Anhub Mast 9 [mm]"}),
        ("source[1], key columns.uplift_2_m.column", "there is no column 'Anhub Mast 9 [mm]' in mast.csv"),
    ),
    "unit": (
        edit_keys({"source.0.columns.uplift_2_m.unit": "N"}),
        ("source[1], key columns.uplift_2_m.unit", "'N' is not a unit of this channel"),
    ),
    "support": (
        edit_keys({"support_position_m": [300.0, 360.0]}),
        ("source[1].columns.uplift_3_m", "the sidecar has no support 3"),
    ),
    "force": (
        edit_keys({"source.0.columns.force_1_N": {"column": "Anhub Mast 1 [mm]", "scale": 1.0, "unit": "N"}}),
        ("source[1], mast.csv", "repeats the channel force_1_N of another source"),
    ),
    "height": (
        edit_keys({"source.0.columns.contact_height_1_m": {"column": "Anhub Mast 1 [mm]"}}),
        ("source[1].columns.contact_height_1_m", "holds force, uplift, position or speed only"),
    ),
    "repeated": (
        edit_keys({"columns.uplift_1_m": {"column": "Weg [m]"}}),
        ("source[1], mast.csv", "repeats the channel uplift_1_m of another source"),
    ),
    "no channel": (
        edit_keys({"source.0.columns": {"time_s": {"column": "Uhrzeit [s]"}}}),
        ("source[1], mast.csv", "has no channel beside the time"),
    ),
    "no time": (
        edit_keys({"source.0.columns.time_s": None}),
        ("source[1], mast.csv", "has no time"),
    ),
    "no join": (edit_keys({"source.0.join": None}), ("source[1].join", "missing")),
    "unknown join": (edit_keys({"source.0.join.kind": "sound"}), ("source[1].join", "sound")),
    "no range": (edit_keys({"source.0.join.within_s": None}), ("source[1].join", "within_s")),
    "no pulses": (
        edit_keys({"source.0.join": {"kind": "pps", "column": "Q", "record_column": "Weg [m]", "offset_s": 0.0}}),
        ("source[1], key join.column", "there is no column 'Q' in mast.csv"),
    ),
    "marks": (
        edit_keys({"source.0.join": {"kind": "marks", "mark": [{"time_s": t, "km": t} for t in (1.0, 2.0)]}}),
        ("source[1], key join.kind", "need the table track, and the position in the source"),
    ),
}


@pytest.mark.parametrize("name", DAMAGES)
def test_damaged_inputs_end_with_a_place_and_a_reason(name: str, tmp_path: Path) -> None:
    sidecar = MeasuredPair().write(tmp_path, PASSAGE)
    damage, texts = DAMAGES[name]
    damage(tmp_path)
    for command in (("check", sidecar), ("assess", sidecar, "--profile", "acceptance-ac", "--out", tmp_path / "out")):
        done = pantocheck(*command, COLUMNS="400")
        assert done.exit_code == 2, done.output
        for text in texts:
            assert text in done.output


def test_run_of_a_case_needs_one_time(tmp_path: Path) -> None:
    sidecar = edit_toml(MeasuredPair().write(tmp_path, PASSAGE), {"case": "en50318-2002/250"})
    done = pantocheck(
        "run", "en50318-2002/250", "--system", f"record:{tmp_path}", "--out", tmp_path / "o", COLUMNS="300"
    )
    assert done.exit_code == 2
    assert f"sidecar '{sidecar.name}', key source: the record has several clocks" in done.output


@pytest.mark.parametrize(
    ("times", "verdict", "warning"),
    [
        # The train is 60 m before the first support at 3.4286 s and 60 m past the last one at 6.8571 s. The clock is
        # known to 0.05 s, and one and a half steps of 0.005 s are no gap.
        ((-4.0, 6.88), "undecided", "ends 0.025 s too soon: the uplift at 420 m needs 60 m past the support"),
        ((3.42, 16.0), "skip", "begins 0.034 s too late: the uplift at 300 m needs 60 m before the support"),
        ((-4.0, 6.92), "pass", None),
        ((3.38, 16.0), "skip", None),  # the rest before the passage is missing
        ((-4.0, 6.85), "skip", None),  # the support is not covered at all, and its criterion says so
    ],
)
def test_file_that_ends_within_the_uncertainty_of_its_clock_is_named(
    times: tuple[float, float], verdict: str, warning: str | None, tmp_path: Path
) -> None:
    pair = MeasuredPair(1, times=times)
    result = read_results(pair.write(tmp_path, STATED.replace("0.005", "0.05")))
    (criterion,) = (row for row in result["criteria"] if row["quantity"] == UPLIFT)
    found = [text for text in result["warnings"] if text.startswith("mast.csv ")]
    assert criterion["verdict"] == verdict
    assert found == ([] if warning is None else [f"mast.csv {warning} and the uncertainty of the clock, 0.05 s"])
    assert [translate(text, "de").missing for text in found] == [()] * len(found)


@pytest.mark.parametrize(
    ("supports", "drift", "within", "ends"),
    [
        # One pulse sets the clock: (1 + 0.5 m) / 70 m/s in common, and twice 0.25 m / 70 m/s.
        ((360.0,), 0.0, 29, "uncertainty 0.029 s"),
        ((300.0, 360.0, 420.0), 0.0, None, " s"),
        ((300.0, 360.0, 420.0, 480.0), 0.02, None, " ppm"),
    ],
)
def test_check_prints_offset_uncertainty_and_drift(
    supports: tuple[float, ...], drift: float, within: int | None, ends: str, tmp_path: Path
) -> None:
    """The report states the same numbers."""
    pair = MeasuredPair(1, supports=supports, drift=drift, times=(-4.0, 14.0))
    sidecar = pair.write(tmp_path, PASSAGE)
    edit_toml(sidecar, {"evaluated_m": [supports[0] - 30, supports[-1] + 30]})
    text = json.loads(pantocheck("check", sidecar, "--json").stdout)["result"][0]["kind"]
    (source,) = read_results(sidecar)["sources"]
    offset, uncertainty = source["offset_s"], source["uncertainty_s"]
    line = next(line for line in text.splitlines() if "mast.csv" in line)
    assert f"; offset {offset:.3f} s, uncertainty {uncertainty:.3f} s" in line
    assert line.endswith(f", drift {source['drift_ppm']:.0f} ppm" if drift else ends)
    if within is not None:
        assert f"within {within} ms" in line
        assert uncertainty == pytest.approx(within / 1e3, abs=5e-4)
