"""Line as built: planted errors are found by static measurements, modes and passages; another passage judges it."""

import csv
import json
import shutil
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import scipy

from helpers.command_line import pantocheck
from helpers.static_records import LINE_PATH, measure_line, read_unequal_line, write_static_record
from helpers.toml_edit import edit_toml, write_toml
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.catalogue import open_catalogue
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.comparison.line_update import (
    BAND_ERROR,
    MeasuredPassage,
    _build_band_covariance,
    begin_estimate,
    build_updated_line,
    update_linear,
)
from pantocheck.conformance.core.json_file import write_model
from pantocheck.conformance.core.toml_file import read_model
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.line.line_parameters import DAMPING, MECHANICAL, scale_line
from pantocheck.conformance.pages.words import format_value
from pantocheck.conformance.records.record_writing import write_record
from pantocheck.conformance.results.identified_modes import ModesFile
from pantocheck.conformance.runs.case_run import run_passage
from pantocheck.model import Catenary, discretise
from pantocheck.model.statics.elasticity import rest_height, static_uplift
from verification.tables.line_coverage import measure_modes

SPLIT = (1.015, 0.988)
"""Factors of the tensions of contact and messenger wire."""

MOVED = {7: 0.006, 20: -0.005, 41: 0.006}
"""Heights of the wire above the stated ones at three wrong droppers [m]."""


@pytest.fixture(scope="module")
def updated(tmp_path_factory: pytest.TempPathFactory) -> tuple[int, dict, LineFile]:
    """Exit code, covariance file and line file of an update by heights, elasticities and modes."""
    folder = tmp_path_factory.mktemp("update")
    stated, random = build_catenary(read_unequal_line()), np.random.default_rng(4)
    built = scale_line(stated, MECHANICAL[:2], SPLIT)
    droppers = (
        replace(dropper, contact_wire_height=(dropper.contact_wire_height or 0.0) + MOVED.get(number, 0.0))
        for number, dropper in enumerate(built.droppers)
    )
    built = replace(built, droppers=tuple(droppers))
    mesh = discretise(built, 1.0)
    position = np.arange(0.5, mesh.mesh.position[-1], 1.5)
    (folder / "heights").mkdir()
    (folder / "elasticity").mkdir()
    heights = rest_height(mesh, position) + 0.001 * random.standard_normal(position.size)
    survey = write_static_record(
        folder / "heights",
        {"position_m": position, "contact_wire_height_m": heights},
        force_N=None,
        height_uncertainty_mm=1.96,
    )
    places = measure_line()["position_m"]
    elasticity = 10 * static_uplift(mesh, places, 100.0) * (1 + 0.01 * random.standard_normal(places.size))
    pushed = write_static_record(
        folder / "elasticity",
        {"position_m": places, "elasticity_mm_N": elasticity},
        elasticity_uncertainty_mm_N=float(0.0196 * elasticity.mean()),
    )
    write_model(folder / "modes.json", ModesFile(measure_modes(built, random, 1.5)))
    result = pantocheck(
        *("line", "update", LINE_PATH, "--heights", survey, "--elasticity", pushed),
        *("--modes", folder / "modes.json", "--element", "1.5", "--out", folder / "as-built.toml"),
    )
    data = json.loads((folder / "as-built.covariance.json").read_text())
    return result.exit_code, data, read_model(folder / "as-built.toml", LineFile, "line")


def test_intervals_of_the_tensions_contain_the_truth_and_reach_the_line(updated: tuple[int, dict, LineFile]) -> None:
    """Modes alone know the tensions to 0.4 %; the line file has values, tolerances and correlations of the estimate."""
    code, data, line = updated
    assert (code, data["verdict"], data["held_out"]) == (3, "info", [])
    assert [part["name"] for part in data["data"]] == ["modes", "elasticity"]
    rows = {row["name"]: row for row in data["properties"]}
    assert list(rows) == [parameter.name for parameter in (*MECHANICAL, *DAMPING)]
    stated = read_unequal_line()
    for wire, true in zip(("contact_wire", "messenger_wire"), SPLIT, strict=True):
        row = rows[f"{wire}_tension"]
        assert row["low_95"] <= true <= row["high_95"]
        assert row["high_95"] - row["low_95"] < 0.02
        assert row["determined"]
        found = getattr(line, wire).tension_N / getattr(stated, wire).tension_N
        assert found == pytest.approx(row["factor"], rel=1e-6)
    assert line.tolerance is not None
    assert line.tolerance.correlation is not None
    matrix = np.array(data["covariance"]["rows"])
    factors = np.array([row["factor"] for row in data["properties"]])
    names = [parameter.name for parameter in (*MECHANICAL, *DAMPING)]
    read = line.covariance_of(names, [0.01] * len(names))
    assert read == pytest.approx(matrix / np.outer(factors, factors), rel=2e-3, abs=1e-8)


def test_measured_heights_move_the_droppers(updated: tuple[int, dict, LineFile]) -> None:
    """Heights every 1.5 m with 1 mm noise: a dropper has about four of them; five standard deviations of 0.5 mm."""
    _, data, line = updated
    stated = np.concatenate([span.contact_wire_height for span in read_unequal_line().layout.spans])
    found = np.concatenate([span.contact_wire_height for span in line.layout.spans])
    moved = np.array([MOVED.get(number, 0.0) for number in range(stated.size)])
    assert data["moved_droppers"] == stated.size
    assert found - stated == pytest.approx(moved, abs=2.5e-3)


def write_passages(folder: Path) -> dict[str, Case]:
    """Cases at three speeds on eight spans, with a coarse mesh; by the names of their files."""
    shutil.copytree(library_folder() / "en50318-2002", folder)
    shutil.rmtree(folder / "known-passing-code")
    (folder / "300.toml").unlink()
    edit_toml(folder / "line.toml", {"geometry.spans": 8})
    mesh = {"discretisation.element_m": 2.0, "discretisation.time_step_s": 0.004, "evaluated_spans": [4, 5]}
    for name, speed in {"a": 250.0, "b": 200.0, "c": 225.0}.items():
        shutil.copy(folder / "250.toml", folder / f"{name}.toml")
        edit_toml(folder / f"{name}.toml", {"id": f"own/{name}", "speed_km_h": speed, **mesh})
    (folder / "250.toml").unlink()
    catalogue = open_catalogue([folder])
    return {name: select_cases([f"own/{name}"], (), catalogue)[-1] for name in "abc"}


def record_passages(folder: Path, cases: dict[str, Case], built: Catenary) -> list[Path]:
    """Sidecars of the passages on a built line."""
    folder.mkdir()
    paths = []
    for name, case in cases.items():
        discretisation = case.file.discretisation
        run = run_passage(case, discretise(built, discretisation.element_m), discretisation)
        paths.append(write_record(folder / f"{name}.csv", run.record, case=case.id))
    return paths


@pytest.fixture(scope="module")
def measured_line(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with a case of two pantographs 20 m apart, whose line was updated by a passage."""
    folder = tmp_path_factory.mktemp("measured")
    cases = write_passages(folder / "cases")
    built = scale_line(build_catenary(cases["a"].line), MECHANICAL[:2], (1.01, 0.99))
    record = record_passages(folder / "records", {"a": cases["a"]}, built)[0]
    line = folder / "cases" / "line.toml"
    result = pantocheck(
        *("line", "update", line, "--passages", record, "--cases", folder / "cases", "--out", folder / "as-built.toml")
    )
    assert result.exit_code == 3, result.output
    shutil.copy(folder / "as-built.toml", line)
    twin = folder / "cases" / "a.toml"
    content = tomllib.loads(twin.read_text())
    limit = next(row for row in content["limit"] if row["quantity"] == "std_force_N")
    rows = [{**limit, "pantograph": number, "upper": 60.0} for number in (1, 2)]
    edit_toml(twin, {"pantograph": 2 * content["pantograph"], "spacing_m": [20.0], "limit": rows})
    return folder / "cases"


OPTIONS = ("--verdicts", "criteria", "--trust", "provisional", "--formats", "json,html,md")


@pytest.fixture(scope="module")
def graded(measured_line: Path) -> Path:
    """Report of the case on the updated line."""
    pantocheck("run", "own/a", "--cases", measured_line, "--out", measured_line.parent / "run", *OPTIONS)
    return measured_line.parent / "run"


def test_certificate_of_an_updated_line_prints_its_covariance_at_both_pantographs(
    measured_line: Path, graded: Path, tmp_path: Path
) -> None:
    """Printed half-widths are those of the components, with two digits; without [tolerance] there is one alone."""
    (case,) = json.loads((graded / "results.json").read_text())["cases"]
    assert case["uncertainty_basis"]["line"].startswith("9 runs on lines one standard deviation away")
    rows = [row for row in case["criteria"] if row["quantity"] == "std_force_N"]
    assert [row["pantograph"] for row in rows] == [1, 2]
    page = (graded / "certificate.html").read_text()
    for row in rows:
        parts = row["components"]
        assert 0.1 < parts["line"] < 10
        assert row["uncertainty"] > 0.9 * parts["line"]
        numerics = np.sqrt(sum(width**2 for name, width in parts.items() if name != "line"))
        text = f"± {format_value(numerics, 2)} (numerics) ± {format_value(parts['line'], 2)} (line as measured)"
        assert text in page
        assert text in (graded / "summary.md").read_text().replace("\\", "")
    shutil.copytree(measured_line, tmp_path / "exact")
    edit_toml(tmp_path / "exact" / "line.toml", {"tolerance": None})
    pantocheck("run", "own/a", "--cases", tmp_path / "exact", "--out", tmp_path / "known", *OPTIONS)
    assert "(line as measured)" not in (tmp_path / "known" / "certificate.html").read_text()


def test_refined_campaign_contains_the_covariance_of_an_updated_line(
    measured_line: Path, graded: Path, tmp_path: Path
) -> None:
    """Width of a run of a campaign is that of the same run alone; draws with the same seed, so to rounding."""
    campaign = {"cases": ["own/a"], "case_folders": [str(measured_line)], "refined": True}
    campaign |= {"vary": [{"key": "speed_km_h", "values": [250.0]}]}
    write_toml(tmp_path / "campaign.toml", campaign)
    result = pantocheck("campaign", tmp_path / "campaign.toml", "--out", tmp_path / "many", "--workers", 1)
    (row,) = csv.DictReader((tmp_path / "many" / "campaign.csv").read_text().splitlines())
    (case,) = json.loads((graded / "results.json").read_text())["cases"]
    for number in ("1", "2"):
        by_line = case["uncertainty_components"][number]["std_force_N"]["line"]
        width = float(row[f"{number}.std_force_N.uncertainty"])
        assert width == pytest.approx(case["uncertainty"][number]["std_force_N"], rel=1e-5), result.output
        assert width > 0.9 * by_line > 0


@pytest.mark.parametrize(("clamp_kg", "verdict", "code"), [(0.0, "pass", 0), (0.4, "fail", 1)])
def test_the_held_out_passage_judges_the_form_of_the_model(
    tmp_path: Path, clamp_kg: float, verdict: str, code: int
) -> None:
    """Tensions wrong by 1 % lie within the tolerances; clamps of 0.4 kg that the line lacks do not.

    Passages at 250 and 200 km/h update the line, that at 225 km/h judges it.
    """
    cases = write_passages(tmp_path / "cases")
    stated = build_catenary(cases["a"].line)
    built = scale_line(stated, MECHANICAL[:2], (1.01, 0.99))
    heavier = (replace(d, lower_clamp_mass=d.lower_clamp_mass + clamp_kg) for d in built.droppers)
    a, b, c = record_passages(tmp_path / "records", cases, replace(built, droppers=tuple(heavier)))
    result = pantocheck(
        *("line", "update", tmp_path / "cases" / "line.toml", "--passages", a, "--passages", b, "--hold-out", c),
        *("--cases", tmp_path / "cases", "--out", tmp_path / "as-built.toml"),
    )
    data = json.loads((tmp_path / "as-built.covariance.json").read_text())
    assert (data["verdict"], result.exit_code) == (verdict, code)
    assert [part["name"] for part in data["data"]] == ["a", "b"]
    assert (data["probability"] >= 0.01) == (verdict == "pass")
    assert [row["quantity"] for row in data["held_out"]] == [f"rms_{low}_{low + 5}_N" for low in range(0, 50, 5)]
    assert all(row["line_std"] > 0 for row in data["held_out"])


def test_linear_update_is_the_posterior_of_a_normal_model() -> None:
    """Closed form for one factor: the precisions of prior and data add up; Student's interval and misfit widen."""
    estimate = begin_estimate(read_unequal_line())
    slope = np.array([2.0, -1.0])
    std = np.array([0.02, 0.03])

    def predict(factors: np.ndarray) -> np.ndarray:
        return slope * (factors[0] - 1)

    measured = slope * 0.004
    found = update_linear(estimate, "test", predict, [0], measured, np.diag(std**2))
    # The share of the data in the precision is lost for the scale of the errors, which is known by five values more.
    precision = np.sum((slope / std) ** 2)
    freedom = 5 + 2 - precision / (1 / 0.01**2 + precision)
    std = std * scipy.special.stdtrit(freedom, 0.975) / 1.959964
    information = 1 / 0.01**2 + np.sum((slope / std) ** 2)
    assert found.covariance[0, 0] == pytest.approx(1 / information, rel=1e-6)
    assert found.factors[0] - 1 == pytest.approx(0.004 * np.sum((slope / std) ** 2) / information, rel=1e-6)
    assert np.diag(found.covariance)[1:] == pytest.approx(np.diag(estimate.covariance)[1:])
    far = update_linear(estimate, "test", predict, [0], np.array([0.3, 0.3]), np.diag(std**2))
    assert far.data[0].misfit > 10
    assert found.covariance[0, 0] < far.covariance[0, 0] < estimate.covariance[0, 0]


def test_curved_model_is_solved_at_the_measured_line() -> None:
    """Powers 3 and -2 of a factor of 1.03: one step misses it by about 1e-3, 30 of its deviations.

    The prior of 1 % pulls by 0.03 (3e-5 / 0.01)^2 = 3e-7; the last step leaves less than a deviation.
    """
    estimate, power = begin_estimate(read_unequal_line()), np.array([3.0, -2.0])
    found = update_linear(estimate, "test", lambda factors: factors[0] ** power, [0], 1.03**power, np.eye(2) * 1e-8)
    assert found.factors[0] == pytest.approx(1.03, abs=5e-5)
    assert np.sqrt(found.covariance[0, 0]) == pytest.approx(
        1.25e-4 / np.linalg.norm(power * 1.03 ** (power - 1)), rel=0.01
    )


def test_mesh_is_an_error_of_all_bands_together() -> None:
    """Bands of one passage with the steps of the case and with half of them; the same arithmetic, so rounding alone."""
    (case,) = select_cases(["en50318-2002/250"])
    coarse, fine = (
        MeasuredPassage(
            "", case, run_passage(case, discretise(build_catenary(case.line), steps.element_m), steps).record
        )
        for steps in (case.file.discretisation, case.file.discretisation.scale(1 / 2))
    )
    value, halved = (np.array([each for _, _, each in passage.values]) for passage in (coarse, fine))
    assert np.max(np.abs(halved / value - 1)) > 0.002  # the mesh shows in the bands
    found = _build_band_covariance(coarse, case.line, begin_estimate(case.line), value)
    expected = np.diag((BAND_ERROR * value) ** 2) + np.outer(halved - value, halved - value)
    assert found == pytest.approx(expected, rel=1e-6, abs=1e-9 * float(expected.max()))


def test_stiffer_steady_arm_is_a_shorter_one() -> None:
    """The stiffness of an arm that is described by its length is the radial force over the length: halved by 2.0."""
    line = read_model(library_folder() / "en50318-2018" / "ac-simple" / "line.toml", LineFile, "line")
    begun = begin_estimate(line)
    factors = np.array([2.0 if each.name == "steady_arm_stiffness" else 1.0 for each in begun.parameters])
    tree = build_updated_line(line, replace(begun, factors=factors), None)
    assert tree["steady_arm"]["length_m"] == pytest.approx(line.steady_arm.length_m / 2, rel=1e-7)  # eight digits


def test_passage_of_another_line_is_refused(measured_line: Path, tmp_path: Path) -> None:
    record = measured_line.parent / "records" / "a.csv"
    other = pantocheck(
        *("line", "update", LINE_PATH, "--passages", record, "--cases", measured_line, "--out", tmp_path / "other.toml")
    )
    assert other.exit_code == 2
    assert "is on another line" in " ".join(other.output.split())
    assert not (tmp_path / "other.toml").exists()


def test_update_without_measurements_is_refused(tmp_path: Path) -> None:
    result = pantocheck("line", "update", LINE_PATH, "--out", tmp_path / "x.toml")
    assert result.exit_code == 2
    assert "has no measurement" in " ".join(result.output.split())
