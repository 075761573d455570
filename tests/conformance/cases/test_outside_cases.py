"""Cases from outside the library: folders of the user and installed distributions; no id of the library is claimed."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

from helpers.fake_distribution import write_distribution
from helpers.outside_cases import outside_case, write_case
from pantocheck.conformance import list_cases, open_case
from pantocheck.conformance.app.commands.command_list import app
from pantocheck.conformance.cases.case_source import list_library
from pantocheck.conformance.cases.catalogue import open_catalogue
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.grading.case_identity import compare_with_library
from pantocheck.conformance.line.library_folder import library_folder

GROUP = "pantocheck.cases"


def install_cases(site: Path, package: str, *names: str, version: str = "1.0") -> None:
    files = {f"{package}/cases/{i}.toml": outside_case(name) for i, name in enumerate(names)}
    code = {f"{package}/__init__.py": "raise RuntimeError('cases are data: the package is not imported')"}
    write_distribution(site, package, version, {GROUP: {"lines": f"{package}.cases"}}, files | code)


def test_a_folder_adds_cases_beside_those_of_the_library(tmp_path: Path) -> None:
    assert not [name for name in list_library(library_folder()) if name.startswith("own/")]
    write_case(tmp_path / "acme" / "fast.toml", "own/acme/fast", 260.0)
    (tmp_path / "notes.toml").write_text("text = 'no case'")
    write_case(tmp_path / ".hidden" / "copy.toml", "own/acme/fast")
    (case,) = select_cases(["own/*"], (), open_catalogue([tmp_path]))
    assert (case.id, case.file.speed_km_h) == ("own/acme/fast", 260.0)
    assert (case.origin.kind, case.origin.name) == ("folder", tmp_path.name)
    assert compare_with_library(case) == "own"
    assert "own/acme/fast" in list_cases(tmp_path)
    changed = open_case("own/acme/fast", cases=tmp_path).with_(speed_km_h=250.0)
    assert changed.case.origin == case.origin


def test_a_folder_without_a_list_of_cases_takes_part_beside_the_library(tmp_path: Path) -> None:
    write_case(tmp_path / "fast.toml", "own/fast")
    ids = [case.id for case in select_cases(["*"], (), open_catalogue([tmp_path]))]
    assert {*ids} == {*list_library(library_folder()), "own/fast"}


@pytest.mark.parametrize(
    ("path", "name", "message"),
    [
        ("a.toml", "en50318-2002/250", "'en50318-2002/250' is the id of the library file"),
        ("a.toml", "en50318-2002/line", "is the id of the library file"),
        ("a.toml", "vovan2025/new", "does not begin with own/, so the library could use it later"),
        ("own.toml", "own", "does not begin with own/"),
        ("en50318-2002/line.toml", "own/a", "has the name of the library file"),
        ("deep/en50318-2002/pantograph.toml", "own/a", "has the name of the library file"),
        ("profiles/acceptance-ac.toml", "own/a", "has the name of the library file"),
    ],
)
def test_no_file_claims_a_name_of_the_library(tmp_path: Path, path: str, name: str, message: str) -> None:
    """The message names the file from outside and that of the library."""
    write_case(tmp_path / path, name)
    with pytest.raises(InputError) as caught:
        open_catalogue([tmp_path])
    assert message in str(caught.value)
    assert str(tmp_path / path) in str(caught.value)
    assert ("library file" not in message) or str(library_folder()) in str(caught.value)


def test_no_profile_claims_a_name_of_the_library(tmp_path: Path) -> None:
    write_case(tmp_path / "a.toml", "own/a")
    shutil.copy(library_folder() / "profiles" / "acceptance-ac.toml", tmp_path / "mine.toml")
    with pytest.raises(InputError, match=r"mine.toml.*'acceptance-ac' is the name of the library profile"):
        open_catalogue([tmp_path])


def test_a_path_may_still_name_a_modified_copy(edited_case) -> None:  # noqa: ANN001
    """As before: a file given by its path may have the id of a library case, and is shown as a modified copy."""
    (case,) = select_cases([str(edited_case("250.toml", {"speed_km_h": 251.0}))])
    assert compare_with_library(case) == "modified"
    assert case.origin.kind == "file"


def test_two_folders_with_one_id_are_an_error_that_names_both(tmp_path: Path) -> None:
    paths = [write_case(tmp_path / folder / "a.toml", "own/a") for folder in ("first", "second")]
    with pytest.raises(InputError) as caught:
        open_catalogue([tmp_path / "first", tmp_path / "second"])
    assert all(str(path) in str(caught.value) for path in paths)
    same = open_catalogue([tmp_path / "first", tmp_path / "first" / ".." / "first"])
    assert len(same.folders) == 1


def test_all_problems_of_a_folder_are_listed(tmp_path: Path) -> None:
    write_case(tmp_path / "a.toml", "first")
    write_case(tmp_path / "b.toml", "second")
    with pytest.raises(InputError) as caught:
        open_catalogue([tmp_path])
    assert len(caught.value.problems) == 2


@pytest.mark.parametrize(("path", "found"), [("none", "there is no such folder"), ("empty", "holds no case file")])
def test_a_wrong_folder_is_refused(tmp_path: Path, path: str, found: str) -> None:
    (tmp_path / "empty").mkdir()
    with pytest.raises(InputError, match=found):
        open_catalogue([tmp_path / path])


def test_a_distribution_offers_cases_without_being_imported(site: Path) -> None:
    install_cases(site, "acme_lines", "own/acme-lines/fast")
    (case,) = select_cases(["own/acme-lines/fast"])
    assert case.origin.text == "distribution acme_lines 1.0"
    assert "own/acme-lines/fast" in list_cases()
    # A default run does not depend on the packages that happen to be installed.
    assert "own/acme-lines/fast" not in {case.id for case in select_cases(["*"])}


def test_a_distribution_must_use_its_own_name_in_ids(site: Path) -> None:
    install_cases(site, "acme_lines", "own/other/fast")
    with pytest.raises(InputError, match=r"cases 'lines' of acme_lines 1.0: .*does not begin with own/acme-lines/"):
        select_cases(["own/*"])


def test_a_folder_cannot_replace_a_case_of_a_distribution(site: Path, tmp_path: Path) -> None:
    install_cases(site, "acme_lines", "own/acme-lines/fast")
    path = write_case(tmp_path / "folder" / "a.toml", "own/acme-lines/fast")
    with pytest.raises(InputError) as caught:
        open_catalogue([path.parent])
    assert str(path) in str(caught.value)
    assert "(distribution acme_lines 1.0)" in str(caught.value)


def test_a_broken_distribution_does_not_take_others_down(site: Path) -> None:
    write_distribution(site, "broken", "2.0", {GROUP: {"x": "no_such_package.cases"}}, {})
    install_cases(site, "acme_lines", "own/acme-lines/fast")
    assert [case.id for case in select_cases(["own/acme-lines/*"])] == ["own/acme-lines/fast"]
    with pytest.raises(InputError, match=r"cases 'x' of broken 2.0: .*not a folder of an installed package"):
        select_cases(["own/*"])


def test_cases_may_require_cases_from_outside(tmp_path: Path) -> None:
    write_case(tmp_path / "a.toml", "own/a")
    path = write_case(tmp_path / "b.toml", "own/b")
    path.write_text(path.read_text("utf-8").replace("speed_km_h", 'requires = ["own/a"]\nspeed_km_h', 1), "utf-8")
    assert [case.id for case in select_cases(["own/b"], (), open_catalogue([tmp_path]))] == ["own/a", "own/b"]
    with pytest.raises(InputError, match=r"there is no case 'own/a'"):
        select_cases([str(path)])


# Ways to start the command: `python -m pantocheck`, and the completion of a shell.
CHECKOUT = Path(__file__).parents[3]


def complete(*words: str) -> list[str]:
    """Answers to a request of bash to complete the last word."""
    environment = {"COMP_WORDS": " ".join(("pantocheck", *words)), "COMP_CWORD": str(len(words))}
    environment["_PANTOCHECK_COMPLETE"] = "complete_bash"
    return CliRunner().invoke(app, [], env=environment, prog_name="pantocheck").stdout.splitlines()


def test_the_command_starts_as_a_module_and_its_launcher_hides_no_package() -> None:
    """A checkout that is not installed finds `pantocheck/__main__.py` in the current folder."""
    command = [sys.executable, "-m", "pantocheck", "--version"]
    ended = subprocess.run(command, cwd=CHECKOUT, capture_output=True, text=True, check=True)
    assert ended.stdout.startswith("pantocheck ")
    # An `__init__.py` would hide the packages `pantocheck.*` of a checkout, and of extensions.
    assert [path.name for path in (CHECKOUT / "pantocheck").glob("*.py")] == ["__main__.py"]


def test_shell_completes_commands_options_and_cases() -> None:
    assert complete("comp") == ["compare"]
    assert complete("simulate", "--o") == ["--out"]
    expected = [name for name in list_library(library_folder()) if name.startswith("en50318-2002/")]
    assert len(expected) == 2
    for words in (("show",), ("compare", "a.csv", "--case")):
        assert complete(*words, "en50318-2002/") == expected
