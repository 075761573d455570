"""Option --cases and cases of distributions in the commands, the certificate, `verify`, campaigns and pytest."""

import json
from pathlib import Path

import pytest

from helpers.command_line import pantocheck
from helpers.fake_distribution import write_distribution
from helpers.outside_cases import outside_case, write_case
from helpers.wave_system import Wave
from pantocheck.conformance import grade_cases
from pantocheck.conformance.campaigns.campaign_file import CampaignFile
from pantocheck.conformance.campaigns.campaign_preparation import prepare_campaign
from pantocheck.conformance.cases.catalogue import LIBRARY, open_catalogue
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.documents.library_check import check_outside_cases
from pantocheck.conformance.documents.recomputation import find_discrepancies
from pantocheck.conformance.execution.plan import read_plan
from pantocheck.conformance.records.record_writing import write_record
from pantocheck.conformance.results.results_format import Results

NAME = "own/acme/fast"
AUTHOR = "Inputs, limits and their trust are stated by the author of this source."


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Folder with one case from outside."""
    write_case(tmp_path / "lines" / "fast.toml", NAME)
    return tmp_path / "lines"


@pytest.fixture
def records(folder: Path, tmp_path: Path) -> Path:
    """Record of the case from outside with known quantities."""
    (case,) = (case for case in select_cases(["own/*"], (), open_catalogue([folder])) if case.id == NAME)
    write_record(tmp_path / "records" / "fast.csv", Wave().record(case), case.id, further={"case_digest": case.digest})
    return tmp_path / "records"


@pytest.fixture
def results(folder: Path, records: Path) -> Results:
    return grade_cases(NAME, system=f"record:{records}", case_folders=[folder]).results


def test_run_states_the_source_of_a_case_on_page_1(folder: Path, records: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    done = pantocheck(
        "run", "own/*", "--cases", folder, "--system", f"record:{records}", "--out", out, "--formats", "json,md,html"
    )
    assert done.exit_code == 1
    (case,) = json.loads((out / "results.json").read_text())["cases"]
    assert (case["library"], case["origin"]["kind"], case["origin"]["name"]) == ("own", "folder", "lines")
    for page in ("summary.md", "certificate.html"):
        text = (out / page).read_text("utf-8")
        assert "folder lines" in text
        assert case["origin"]["digest"] in text
        assert AUTHOR in text
    assert str(folder) not in (out / "certificate.html").read_text("utf-8")  # no path of this machine


def test_commands_find_the_cases_of_a_folder_but_not_ids_of_the_library(folder: Path, tmp_path: Path) -> None:
    listed = pantocheck("cases", "--cases", folder)
    assert listed.exit_code == 0
    assert NAME in listed.output
    assert "folder lines" in listed.output
    shown = pantocheck("show", NAME, "--cases", folder)
    assert "not in the library: folder lines" in shown.output
    assert pantocheck("show", NAME).exit_code != 0
    checked = pantocheck("check", "--cases", folder)
    assert checked.exit_code == 0
    assert f"valid case {NAME}" in " ".join(checked.output.split())
    simulated = pantocheck("simulate", NAME, "--cases", tmp_path / "none", "--out", tmp_path / "run.csv")
    assert "there is no such folder" in simulated.stderr
    write_case(folder / "copy.toml", "en50318-2002/300")
    done = pantocheck("check", "--cases", folder)
    assert "is the id of the library file" in done.stderr


def test_a_broken_distribution_does_not_hide_the_cases(site: Path) -> None:
    write_distribution(site, "broken", "2.0", {"pantocheck.cases": {"x": "no_such_package"}}, {})
    done = pantocheck("cases")
    assert done.exit_code == 2
    assert "en50318-2002/250" in done.output
    assert "cases 'x' of broken 2.0" in done.stderr


def test_plans_and_campaigns_name_folders_relative_to_their_files(folder: Path) -> None:
    plan = folder.parent / "plan.toml"
    plan.write_text('system = "builtin"\ncases = ["own/*"]\ncase_folders = ["lines"]\n')
    assert read_plan(plan).case_folders == (str(folder),)
    file = CampaignFile.model_validate({"cases": ["own/*"], "case_folders": ["lines"]})
    prepared = prepare_campaign(file, folder.parent)
    assert prepared.origins[NAME].text == "folder lines"
    assert list(prepared.execute.case_files) == [NAME]


def test_verify_compares_with_the_folder_if_it_is_given(results: Results, folder: Path) -> None:
    (without,) = check_outside_cases(results, LIBRARY)
    assert (without.outcome, without.statement) == (
        "open", f"{NAME} was not compared with folder lines: give its folder by --cases."
    )  # fmt: skip
    (same,) = check_outside_cases(results, open_catalogue([folder]))
    assert same.outcome == "proved"
    assert "as its author states them" in same.statement
    content = results.to_dict()
    content["cases"][0]["criteria"][0]["lower"] -= 5.0
    (check,) = check_outside_cases(Results.model_validate(content), open_catalogue([folder]))
    assert check.outcome == "contradicted"
    assert "folder lines" in check.details[0]
    # The verdict of a document without the key is decided by the same numbers.
    content = results.to_dict()
    before = [*find_discrepancies(Results.model_validate(content))]
    del content["cases"][0]["origin"]
    assert [*find_discrepancies(Results.model_validate(content))] == before == []
    assert Results.model_validate(content).verdict == results.verdict


def test_verify_names_another_version_of_a_distribution(site: Path) -> None:
    name = "own/acme-lines/fast"
    files = {"acme_lines/__init__.py": "", "acme_lines/fast.toml": outside_case(name)}
    write_distribution(site, "acme-lines", "1.1", {"pantocheck.cases": {"lines": "acme_lines"}}, files)
    graded = grade_cases(name, system="record:en50318-2002/known-passing-code").results
    assert graded.cases[0].origin is not None
    (same,) = check_outside_cases(graded, LIBRARY)
    assert same.outcome == "proved"
    content = graded.to_dict()
    content["cases"][0]["origin"]["version"] = "1.0"
    (other,) = check_outside_cases(Results.model_validate(content), LIBRARY)
    assert (other.outcome, "version 1.1 is installed" in other.statement) == ("open", True)
