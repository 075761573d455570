"""`pantocheck site`: matrix of systems and cases, history, links, and results that contradict themselves."""

import json
import re
import shutil
from dataclasses import replace
from functools import partial
from pathlib import Path

import pytest

from helpers.command_line import pantocheck
from helpers.wave_system import SIGMA, Wave
from pantocheck.conformance.cases.library import load_case
from pantocheck.conformance.execution.runner import run_cases
from pantocheck.conformance.grading.results_building import build_results
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.pages.site_pages import name_file, order_results
from pantocheck.conformance.results.results_format import SystemIdentity

RUNS = (
    ("old", "2026-01-05T00:00:00Z", 1.3 * SIGMA, {"name": "wave", "version": "1"}),
    ("new", "2026-02-05T00:00:00Z", SIGMA, {"name": "wave", "version": "2"}),
    ("deep/other", "2026-01-20T00:00:00Z", SIGMA, {"name": "<b>other</b>", "version": "7"}),
)
"""Folder, date, standard deviation and system of each run."""


@pytest.fixture(scope="module")
def contents() -> dict[str, str]:
    """Two versions of one system and one of another on a case with two pantographs, by their folders."""
    case = load_case(library_folder() / "en50318-2002" / "250.toml")
    file = case.file.model_copy(update={"spacing_m": (150.0,), "pantograph": case.file.pantograph * 2})
    case = replace(case, file=file, pantographs=case.pantographs * 2)
    return {
        name: json.dumps(run_cases([case], Wave(sigma=sigma, **system)).to_dict() | {"started": started})
        for name, started, sigma, system in RUNS
    }


@pytest.fixture
def results(tmp_path: Path, contents: dict[str, str]) -> Path:
    """Folder with the results."""
    return write_results(tmp_path / "results", contents)


def write_results(folder: Path, contents: dict[str, str]) -> Path:
    for name, content in contents.items():
        (folder / name).mkdir(parents=True)
        (folder / name / "results.json").write_text(content, encoding="utf-8")
    return folder


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory, contents: dict[str, str]) -> Path:
    """Site of the results, with a hostile title."""
    folder = tmp_path_factory.mktemp("site")
    results = write_results(folder / "results", contents)
    done = build(results, "--out", folder / "site", "--title", "<script>alert(1)</script>")
    assert done.exit_code == 0, done.output
    return folder / "site"


build = partial(pantocheck, "site")


def read_text(page: Path) -> str:
    """Text of a page without its tags."""
    return " ".join(re.sub(r"<[^>]+>", " ", page.read_text("utf-8").split("<main>")[1]).split())


def test_matrix_and_case_page_show_every_version_and_links_to_files(site: Path) -> None:
    text = read_text(site / "index.html")
    assert "2 systems, 1 case, 3 runs." in text
    matrix = text.split("Systems and cases")[1].split("Runs")[0]
    assert "wave" in matrix
    assert re.search(r"en50318-2002/250 .* 2\b", matrix)  # version 2, not version 1
    runs = text.split("All runs, the latest first")[1]
    places = [runs.index(date) for date in ("2026-02-05", "2026-01-20", "2026-01-05")]
    assert places == sorted(places)
    pages = [site / "index.html", *(site / "cases").iterdir()]
    links = [(page, link) for page in pages for link in re.findall(r'href="([^"#]+)"', page.read_text("utf-8"))]
    assert len(links) >= 8
    for page, link in links:
        assert (page.parent / link).resolve().is_relative_to(site.resolve())
        assert (page.parent / link).is_file(), link
    (page,) = (site / "cases").iterdir()
    text = read_text(page)
    for sigma in (SIGMA, 1.3 * SIGMA):
        assert f"{sigma:.4g}"[:4] in text
    assert "Pantograph 2" in text
    index = (site / "index.html").read_text("utf-8")
    assert "<b>other" not in index
    assert "<script>alert" not in index


def test_results_that_contradict_themselves_are_shown_as_errors(results: Path, tmp_path: Path) -> None:
    """A verdict raised by hand: the numbers do not support it."""
    path = results / "old" / "results.json"
    forged = json.loads(path.read_text("utf-8"))
    forged["verdict"] = forged["cases"][0]["verdict"] = "pass"
    path.write_text(json.dumps(forged), encoding="utf-8")
    done = build(results, "--out", tmp_path / "site")
    assert done.exit_code == 0
    assert "verdict 'pass' stated" in done.output
    text = read_text(tmp_path / "site" / "index.html")
    assert "contradicts itself" in text
    row = text.split("All runs, the latest first")[1].split("2026-01-05")[1]
    assert "ERROR" in row
    assert "0 of 1" in row


@pytest.mark.usefixtures("fresh_figures")
def test_repeated_site_gives_the_same_bytes_and_ignores_itself(
    results: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "0")
    shutil.rmtree(results / "deep")
    shutil.rmtree(results / "old")
    contents = []
    for _ in range(2):  # the site lies inside the folder of the results
        assert build(results, "--out", results / "site").exit_code == 0
        contents.append({path: path.read_bytes() for path in (results / "site").rglob("*") if path.is_file()})
    assert contents[0] == contents[1]


@pytest.mark.parametrize("make", [False, True])
def test_a_folder_without_results_is_named(tmp_path: Path, make: bool) -> None:
    folder = tmp_path / "empty"
    if make:
        folder.mkdir()
    done = build(folder, "--out", tmp_path / "site")
    assert done.exit_code == 2
    assert ("holds no results.json" if make else "not a folder") in " ".join(done.output.split())


def test_several_folders_give_the_site_of_all_their_results_once(results: Path, tmp_path: Path) -> None:
    """A folder inside another one adds nothing: each file is taken once."""
    one, two = tmp_path / "one", tmp_path / "two"
    first, *_ = sorted(results.iterdir())
    assert build(results, "--out", one).exit_code == 0
    assert build(first, str(results), str(first), "--out", two).exit_code == 0
    assert read_text(two / "index.html") == read_text(one / "index.html")
    (results / "copy").mkdir()
    (results / "copy" / "results.json").symlink_to(results / "old" / "results.json")
    (results / "folder" / "results.json").mkdir(parents=True)
    done = build(results, "--out", tmp_path / "site")
    assert "3 runs" in done.output


def test_runs_are_ordered_by_date_and_named_safely() -> None:
    systems = [SystemIdentity(name=name, version="", kind="record") for name in ("../../etc", "Ω")]
    contents = [
        (build_results([], system, "secondary", "").model_copy(update={"started": started}), ())
        for system, started in zip(systems, ("2026-02-01", None), strict=True)
    ]
    assert [run.folder for run in order_results(contents)] == ["runs/0001-unnamed", "runs/0002-etc"]
    assert len(name_file("x" * 500)) == 60
