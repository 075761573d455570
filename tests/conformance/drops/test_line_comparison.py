"""A damping fit recognises the line of the record, and marks coefficients that the modes do not determine."""

import json
import lzma
import tomllib
from collections.abc import Sequence
from dataclasses import replace
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from pydantic import TypeAdapter
from pypdf import PdfReader

from helpers.command_line import pantocheck
from helpers.section_lines import section_line
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.json_file import write_model
from pantocheck.conformance.drops.damping_model import judge_coefficients
from pantocheck.conformance.drops.damping_results import build_damping_results, write_damping_toml
from pantocheck.conformance.drops.drop_simulation import describe_line
from pantocheck.conformance.drops.line_comparison import compare_line, refuse_other_line
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.line.elements.damping import Damping
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.pages.damping_page import build_damping_document
from pantocheck.conformance.results.damping_format import Coefficient, DampingResults, Matching, Observability
from pantocheck.conformance.results.identified_modes import MeasuredLine, Mode, ModesFile, SensorShape
from pantocheck.model import Catenary, Kind, ModalBand, Rayleigh, discretise
from pantocheck.model.modal.modes import compute_modes, damping_ratios, deflection_at
from verification.tables.line_coverage import DAMPING, SPANS, build_line

CASE = "vovan2015/mass-drop/printed"
"""Case with six spans of 63 m, contact wire 20 kN, messenger wire 14 kN."""

SENSORS = (("contact wire", "CW", 195.75), ("contact wire", "CW", 144.0), ("messenger wire", "MW", 272.25))
ELEMENT = 2.0
"""Length of the elements of lines and fits [m]."""
MODES = Path(__file__).parents[2] / "data" / "modes" / "T1.json.xz"


@pytest.fixture(scope="module")
def file() -> LineFile:
    return select_cases([CASE])[0].line


@pytest.fixture(scope="module")
def catenary(file: LineFile) -> Catenary:
    return build_catenary(file)


@pytest.fixture(scope="module")
def unequal() -> Catenary:
    """The line with unequal spans. Both wires have a known damping."""
    return build_line()


@pytest.fixture(scope="module")
def measured(unequal: Catenary) -> tuple[Mode, ...]:
    """Modes of the line with unequal spans as an identification of perfect records would write them."""
    mesh = discretise(unequal, ELEMENT, tuple(x for _, _, x in SENSORS))
    modes = compute_modes(mesh, 30)
    shapes = np.array([deflection_at(mesh, modes, mesh.mesh.row_of[name, "z"], x) for name, _, x in SENSORS]).T
    line = MeasuredLine(spans_m=SPANS, contact_wire_tension_N=20e3, messenger_wire_tension_N=14e3)
    return tuple(
        Mode(
            frequency_Hz=frequency,
            damping_ratio=ratio,
            damping_ratio_std=0.002 * ratio,
            group=1 + i // 6,
            sensor_shape=tuple(
                SensorShape(sensor=number, wire=wire, position_m=x, re=value, im=0.0)
                for number, ((_, wire, x), value) in enumerate(zip(SENSORS, shape, strict=True), 1)
            ),
            record="T",
            line=line,
        )
        for i, (frequency, ratio, shape) in enumerate(
            zip(modes.frequency, damping_ratios(mesh, modes), shapes, strict=True)
        )
    )


@pytest.fixture(scope="module")
def fitted(measured: tuple[Mode, ...], unequal: Catenary) -> DampingResults:
    return build_damping_results(measured, unequal, ELEMENT, "modes.json")


def build_mode(line: MeasuredLine | None, record: str = "T", wire: str = "CW", position: float | None = 30.0) -> Mode:
    sensor = SensorShape(sensor=1, wire=wire, position_m=position, re=1.0, im=0.0)
    return Mode(
        frequency_Hz=1.0, damping_ratio=0.01, damping_ratio_std=1e-5, sensor_shape=(sensor,), record=record, line=line
    )


def fit_other_line(folder: Path, modes: Sequence[Mode], *options: object) -> tuple[int, str]:
    write_model(folder / "modes.json", ModesFile(tuple(modes)))
    command = ("drop", "fit", folder / "modes.json", "--line", CASE, "--out", folder / "fit", *options)
    result = pantocheck(*command, COLUMNS="4000")
    return result.exit_code, result.output


def test_sections_and_stitch_wires_carry_their_sensors() -> None:
    """Two sections of six spans of 60 m, an overlap of three; sensors on either section."""
    line = section_line()
    facts = describe_line(line)
    modes = [build_mode(facts, position=position) for position in (30.0, 510.0)]
    comparison = compare_line(modes, build_catenary(line))
    assert (comparison.state, len(facts.spans_m)) == ("consistent", 9)
    # Stitch wires exist only around the supports; a sensor at mid-span hangs on none.
    case = select_cases(["en50318-2018/ac-stitched/275*"])[0]
    line, geometry = build_catenary(case.line), case.line.geometry
    states = [
        compare_line([build_mode(describe_line(case.line), wire="SW", position=x)], line).state
        for x in (geometry.supports[1], geometry.mid_span(3))
    ]
    assert states == ["consistent", "contradicted"]


def test_line_of_the_record_is_verified(file: LineFile, catenary: Catenary) -> None:
    """Facts within 0.1 m and 1 % agree; such differences change a coefficient by about 1 %."""
    for changes in (
        {},
        {"spans_m": (63.09, 62.91, 63.0, 63.0, 63.0, 63.0)},
        {"contact_wire_tension_N": 20.19e3, "messenger_wire_tension_N": 13.87e3},
    ):
        comparison = compare_line([build_mode(describe_line(file).model_copy(update=changes))], catenary)
        assert (comparison.state, comparison.differences, comparison.missing) == ("consistent", (), ())
        refuse_other_line(comparison, "modes.json")


@pytest.mark.parametrize(
    ("changes", "differences"),
    [
        ({"spans_m": (63.0,) * 5}, {("number of spans", "5", "6")}),
        (
            {"spans_m": (*SPANS, 63.0)},
            {
                ("number of spans", "7", "6"),
                ("length of span 3", "58.5 m", "63 m"),
                ("length of span 5", "54 m", "63 m"),
            },
        ),
        ({"spans_m": (63.0, 62.85, 63.0, 62.85, 63.0, 63.0)}, {("length of span 2, 4", "62.85 m", "63 m")}),
        ({"contact_wire_tension_N": 20.3e3}, {("tension of the contact wire", "20300 N", "20000 N")}),
        ({"messenger_wire_tension_N": 15e3}, {("tension of the messenger wire", "15000 N", "14000 N")}),
        ({"contact_wire_tension_N": 20.0}, {("tension of the contact wire", "20 N", "20000 N")}),  # kN by mistake
    ],
)
def test_refusal_names_each_difference_with_its_unit(
    file: LineFile, catenary: Catenary, changes: dict, differences: set[tuple[str, str, str]]
) -> None:
    comparison = compare_line([build_mode(describe_line(file).model_copy(update=changes))], catenary)
    assert comparison.state == "contradicted"
    assert {(row.fact, row.record, row.line) for row in comparison.differences} == differences
    with pytest.raises(InputError) as refusal:
        refuse_other_line(comparison, "modes.json")
    for fact, record, line in differences:
        assert f"{fact} is {record} in the record, {line} on the line" in str(refusal.value)


@pytest.mark.parametrize(
    ("wire", "position", "line"),
    [("CW", 400.0, "0 m to 378 m"), ("MW", -1.0, "0 m to 378 m"), ("SW", 63.0, "no stitch wire")],
)
def test_sensor_without_its_wire_differs(
    file: LineFile, catenary: Catenary, wire: str, position: float, line: str
) -> None:
    comparison = compare_line([build_mode(describe_line(file), wire=wire, position=position)], catenary)
    (difference,) = comparison.differences
    assert (difference.record, difference.line) == (f"{position:g} m", line)


@pytest.mark.parametrize(
    ("changes", "wire", "position", "missing"),
    [
        ({"spans_m": ()}, "CW", 30.0, "lengths of the spans"),
        ({"contact_wire_tension_N": None}, "CW", 30.0, "tension of the contact wire"),
        ({"messenger_wire_tension_N": None}, "CW", 30.0, "tension of the messenger wire"),
        *(({}, wire, x, "wire and position of sensor 1") for wire, x in (("", 30.0), ("CW", None), ("pole", 30.0))),
    ],
)
def test_line_or_sensor_with_a_missing_fact_is_not_verified(
    file: LineFile, catenary: Catenary, changes: dict, wire: str, position: float | None, missing: str
) -> None:
    facts = describe_line(file).model_copy(update=changes)
    comparison = compare_line([build_mode(facts, wire=wire, position=position)], catenary)
    assert (comparison.state, comparison.missing) == ("unconfirmed", (missing,))
    refuse_other_line(comparison, "modes.json")


def test_modes_without_facts_or_with_a_missing_fact_hide_no_difference(file: LineFile, catenary: Catenary) -> None:
    facts = describe_line(file).model_copy(update={"spans_m": (), "messenger_wire_tension_N": 15e3})
    comparison = compare_line([build_mode(facts)], catenary)
    assert (comparison.state, len(comparison.differences), len(comparison.missing)) == ("contradicted", 1, 1)
    # Record T1, without facts on the line, is from another line: its frequencies are not those of this one.
    modes = TypeAdapter(list[Mode]).validate_python(json.loads(lzma.decompress(MODES.read_bytes())))
    results = build_damping_results(modes, catenary, ELEMENT, "modes.json")
    assert (results.line.state, results.line.differences) == ("contradicted", ())
    assert "natural frequencies contradict the line: scatter of the frequencies" in results.warnings[0]
    assert "not confirmed" in results.warnings[1]
    assert results.matching.matched_share < 0.8
    assert results.matching.median_mac < 0.9
    assert not any(c.determined for c in results.coefficients)


def test_difference_names_the_record_if_there_are_two_lines(file: LineFile, catenary: Catenary) -> None:
    """One of two records is from another line: the difference names that record, in any order of the modes."""
    modes = [
        build_mode(describe_line(file), "T1"),
        build_mode(describe_line(file).model_copy(update={"messenger_wire_tension_N": 16e3}), "T3"),
        build_mode(None, "T4"),
    ]
    for order in (modes, modes[::-1]):
        comparison = compare_line(order, catenary)
        assert [row.fact for row in comparison.differences] == ["T3: tension of the messenger wire"]
        assert {fact.split(":")[0] for fact in comparison.missing} == {"T4"}


def test_fit_on_the_line_of_the_record_returns_its_damping(fitted: DampingResults) -> None:
    """Perfect modes of the same mesh: every mode is matched, and each coefficient returns within 1 %."""
    assert (fitted.line.state, fitted.warnings) == ("consistent", ())
    assert (fitted.matching.modes, fitted.matching.matched, fitted.matching.matched_share) == (30, 30, 1.0)
    assert fitted.matching.lowest_mac == pytest.approx(1.0, abs=1e-6)
    for c in fitted.coefficients:
        assert (c.determined, c.reason) == (True, "")
        assert c.value == pytest.approx(getattr(DAMPING[Kind(c.kind)], f"{c.matrix}_coefficient"), rel=0.01)
    text = write_damping_toml(fitted)
    comments = [line for line in text.splitlines() if line.startswith("#")]
    assert len(comments) == len(fitted.coefficients)
    assert all(": nominal 95 % interval " in line for line in comments)
    assert Damping.model_validate(tomllib.loads(text)["damping"]).contact_wire.stiffness_coefficient_s > 0


def test_modal_damping_replaces_the_stated_damping_in_its_bands(
    measured: tuple[Mode, ...], unequal: Catenary, fitted: DampingResults
) -> None:
    """The line states damping of its droppers, and modal damping at all frequencies: droppers add nothing to a mode."""
    # Without the bands, what the droppers add is subtracted, and the coefficients of the wires change.
    droppers = replace(unequal, damping=DAMPING | {Kind.DROPPER: Rayleigh(0.0, 2e-3)})
    banded = replace(droppers, modal_damping=(ModalBand(0.0, 100.0, 0.005),))
    found, subtracted = (build_damping_results(measured, line, ELEMENT, "m") for line in (banded, droppers))
    assert found.coefficients == fitted.coefficients
    assert found.stated == ()
    assert [stated.kind for stated in subtracted.stated] == ["dropper"]
    assert subtracted.coefficients != found.coefficients


def test_other_line_is_refused_before_anything_is_written(tmp_path: Path, measured: tuple[Mode, ...]) -> None:
    code, output = fit_other_line(tmp_path, measured)
    assert code == 2
    assert "length of span 3 is 58.5 m in the record, 63 m on the line" in output
    assert "length of span 5 is 54 m in the record, 63 m on the line" in output
    assert "--other-line" in output
    assert not (tmp_path / "fit").exists()
    shape = measured[0].sensor_shape
    beyond = [
        mode.model_copy(update={"sensor_shape": (shape[0].model_copy(update={"position_m": 500.0}),)})
        for mode in measured
    ]
    code, output = fit_other_line(tmp_path, beyond, "--other-line")
    assert code == 2
    assert "a sensor is at 500 m, where the line has no contact wire" in output


def test_permitted_other_line_is_marked_in_every_file(tmp_path: Path, measured: tuple[Mode, ...]) -> None:
    code, output = fit_other_line(tmp_path, measured, "--other-line", "--element", ELEMENT)
    assert code == 0
    difference = "length of span 3 is 58.5 m in the record, 63 m on the line"
    assert "warning: The line of the fit is not the line of the record, so that the errors" in output
    results = json.loads((tmp_path / "fit" / "damping.json").read_text())
    assert results["line"]["state"] == "contradicted"
    assert {"fact": "length of span 5", "record": "54 m", "line": "63 m"} in results["line"]["differences"]
    assert difference in results["warnings"][0]
    page = (tmp_path / "fit" / "damping.html").read_text()
    paper = PdfReader(BytesIO((tmp_path / "fit" / "damping.pdf").read_bytes())).pages[0].extract_text()
    for text in (" ".join(page.split()), " ".join(paper.split())):
        assert "The line of the fit is NOT the line of the record." in text
        assert difference in text
    box = build_damping_document(DampingResults.model_validate(results), "").blocks[0]
    assert box.sentences[: len(results["warnings"])] == tuple(results["warnings"])
    for name in ("damping.toml", "damping_with_modal.toml"):
        text = (tmp_path / "fit" / name).read_text()
        assert difference in text.splitlines()[0]
        assert text.startswith("# warning: The line of the fit is not the line of the record")
        assert difference in tomllib.loads(text)["damping"]["note"]


COEFFICIENT = Coefficient(kind="contact_wire", matrix="mass", value=0.05, low_95=0.04, high_95=0.06)
ROW = Observability(
    kind="contact_wire", matrix="mass", largest_share=0.5, variance_inflation=1.0, std=0.01, plausible=0.1,
    plausible_over_std=10.0, residual_without=2.0, observable=True,
)  # fmt: skip


@pytest.mark.parametrize(
    ("matched", "median_mac", "observable", "reason"),
    [
        (8, 0.9, True, ""),
        (7, 0.9, True, "7 of 10 modes are matched, needed are 80 %"),
        (8, 0.89, True, "the median MAC is 0.89, needed is 0.9"),
        (8, None, True, "single sensor"),
        (8, 0.9, False, "it is not observable in the modes"),
    ],
)
def test_each_threshold_counts_alone(matched: int, median_mac: float | None, observable: bool, reason: str) -> None:
    matching = Matching(
        modes=10, matched=matched, matched_share=matched / 10, median_mac=median_mac, lowest_mac=median_mac
    )
    rows = [ROW.model_copy(update={"observable": observable})]
    (coefficient,) = judge_coefficients([COEFFICIENT], rows, matching)
    assert coefficient.determined == (reason == "")
    assert reason in coefficient.reason
    assert (coefficient.value, coefficient.low_95) == (0.05, 0.04)


def test_coefficient_that_is_not_determined_is_only_a_comment(measured: tuple[Mode, ...], unequal: Catenary) -> None:
    """A single sensor confirms no match: nothing is determined, and damping.toml holds no coefficient."""
    single = [mode.model_copy(update={"sensor_shape": mode.sensor_shape[:1]}) for mode in measured]
    results = build_damping_results(single, unequal, ELEMENT, "modes.json")
    assert (results.matching.median_mac, results.matching.lowest_mac) == (None, None)
    text = write_damping_toml(results)
    damping = tomllib.loads(text)["damping"]
    assert set(damping) == {"trust", "source", "note"}
    assert "Not determined: contact wire stiffness" in damping["note"]
    assert text.count("# not determined, left out: ") == 4


def test_damping_file_needs_six_pairs_and_safe_names(measured: tuple[Mode, ...], unequal: Catenary) -> None:
    with pytest.raises(InputError, match="only 5 of 5 modes have a computed counterpart, 6 are needed"):
        build_damping_results(measured[:5], unequal, ELEMENT, "modes.json")
    other = MeasuredLine(spans_m=SPANS)
    name = "T\n[damping.droppers]\nmass_coefficient_1_s = 9.0\x7f"
    modes = [
        mode.model_copy(update={"line": other, "record": name}) if i % 2 else mode
        for i, mode in enumerate(measured[:6])
    ]
    results = build_damping_results(modes, unequal, ELEMENT, "modes.json")
    assert len(results.pairs) == results.matching.matched == 6
    text = write_damping_toml(results)
    assert "droppers" not in tomllib.loads(text)["damping"]
    assert "mass_coefficient_1_s = 9.0" in text.splitlines()[0]
