"""Versions of file formats: chains of migrations, later versions, and files that earlier commits wrote."""

import lzma
import re
import typing
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from pantocheck.conformance.cases.library_folder import library_folder
from pantocheck.conformance.cases.profile_file import Profile, load_profile
from pantocheck.conformance.command_line.app import app
from pantocheck.conformance.input_files.format_versions import VERSIONED_FORMATS, FileFormat, update_content
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.input_files.toml_file import read_toml
from pantocheck.conformance.own_files.file_check import check_input_file
from pantocheck.conformance.results.results_reading import parse_results
from pantocheck.conformance.schemas import READ_FORMATS, WRITTEN_FORMATS

ROOT = Path(__file__).parents[3]
FROZEN = ROOT / "tests" / "data" / "frozen"
EARLIER = ROOT / "tests" / "data" / "earlier_formats"
PAGE = (ROOT / "docs" / "format-versions.md").read_text("utf-8")


def stated_ids() -> set[str]:
    """Ids in the key `schema` of all models of files."""
    models = [*READ_FORMATS.values(), *WRITTEN_FORMATS.values()]
    fields = [model.model_fields["schema_"] for model in models if "schema_" in model.model_fields]
    return {value for field in fields for value in typing.get_args(field.annotation)}


def test_models_have_the_current_versions() -> None:
    assert stated_ids() == {file_format.id for file_format in VERSIONED_FORMATS.values()}


def test_the_page_states_the_current_versions() -> None:
    rows = re.findall(r"^\| `([a-z-]+)` \| (\d+) \|", PAGE, re.MULTILINE)
    assert {name: int(number) for name, number in rows} == {
        name: each.version for name, each in VERSIONED_FORMATS.items()
    }
    changes = set(re.findall(r"^\| `([a-z-]+/\d+)` \|", PAGE, re.MULTILINE))
    assert changes == {f"{name}/{n}" for name, each in VERSIONED_FORMATS.items() for n in range(2, each.version + 1)}


def rename(content: Mapping[str, Any], where: str) -> dict[str, Any]:
    return {("tension_N" if key == "tension" else key): value for key, value in content.items()}


def convert_unit(content: Mapping[str, Any], where: str) -> dict[str, Any]:
    return {**content, "speed_km_h": 3.6 * content["speed_m_s"]} if "speed_m_s" in content else dict(content)


CHAIN = {"chain": FileFormat("chain", (rename, convert_unit))}


def test_earlier_versions_pass_through_every_later_step() -> None:
    first = {"schema": "pantocheck.chain/1", "tension": 20e3, "speed_m_s": 10.0}
    assert update_content(first, "file", CHAIN) == {
        "schema": "pantocheck.chain/3", "tension_N": 20e3, "speed_m_s": 10.0, "speed_km_h": 36.0
    }  # fmt: skip
    second = {"schema": "pantocheck.chain/2", "tension": 1.0}
    assert update_content(second, "file", CHAIN) == {"schema": "pantocheck.chain/3", "tension": 1.0}
    assert first["tension"] == 20e3  # the content of the caller stays unchanged


@pytest.mark.parametrize("content", [{}, [], {"schema": 5}, {"schema": "other/9"}, {"schema": "pantocheck.none/1"}])
def test_content_without_a_known_version_is_unchanged(content: Any) -> None:
    assert update_content(content, "file", CHAIN) is content


@pytest.mark.parametrize("number", [0, 4, 999999])
def test_a_later_version_is_refused_with_the_versions_that_are_read(number: int) -> None:
    with pytest.raises(InputError, match=rf"version {number} of the format chain; Pantocheck .* reads versions 1 to 3"):
        update_content({"schema": f"pantocheck.chain/{number}"}, "file", CHAIN)


def test_readers_refuse_a_later_version(tmp_path: Path) -> None:
    path = tmp_path / "run.toml"
    path.write_text('schema = "pantocheck.record/2"\n')
    with pytest.raises(InputError, match=r"file 'run.toml', key schema: version 2 of the format record"):
        read_toml(path, "file")
    with pytest.raises(InputError, match=r"version 7 of the format results; Pantocheck .* reads version 1"):
        parse_results(b'{"schema": "pantocheck.results/7"}', "results 'results.json'")


def earlier_profile(tmp_path: Path, need: str) -> Path:
    """Profile of the library at commit 07ce9e7, with this value of `need` in its rules."""
    text = (EARLIER / "acceptance-ac.07ce9e7.toml").read_text("utf-8")
    assert 'need = "if_known"' in text
    path = tmp_path / "profile.toml"
    path.write_text(text.replace('need = "if_known"', f'need = "{need}"'), "utf-8")
    return path


def test_a_profile_of_version_1_is_read(tmp_path: Path) -> None:
    """A rule with `need = "required"` has the meaning of every rule of version 2."""
    profile = load_profile(str(earlier_profile(tmp_path, "required")))
    assert profile.schema_ == "pantocheck.profile/2"
    assert "need" not in Profile.model_fields["rule"].annotation.__args__[0].model_fields
    assert len(profile.rule) == len(load_profile("acceptance-ac").rule)


def test_a_profile_whose_meaning_cannot_be_kept_is_refused(tmp_path: Path) -> None:
    """A rule that could be met by delivering less is not converted in silence."""
    path = earlier_profile(tmp_path, "if_known")
    with pytest.raises(InputError, match=r"rule\[\d+\].need: 'if_known' does not exist in version 2 of profiles"):
        load_profile(str(path))


@pytest.mark.parametrize("path", sorted((library_folder() / "profiles").glob("*.toml")), ids=lambda path: path.stem)
def test_a_file_of_version_1_without_the_removed_key_means_the_same(path: Path, tmp_path: Path) -> None:
    text = path.read_text("utf-8")
    earlier = tmp_path / path.name
    earlier.write_text(text.replace("pantocheck.profile/2", "pantocheck.profile/1"), "utf-8")
    assert load_profile(str(earlier)) == load_profile(str(path))


def test_migrate_writes_a_new_file_and_overwrites_none(tmp_path: Path) -> None:
    path, out = earlier_profile(tmp_path, "required"), tmp_path / "out"
    done = CliRunner().invoke(app, ["migrate", str(path), "--out", str(out)])
    assert done.exit_code == 0, done.stderr
    checked = f"now run pantocheck check {out / 'profile.toml'}"
    assert f"profile 1 converted to 2; comments are not kept; {checked}" in done.output
    assert load_profile(str(out / "profile.toml")) == load_profile(str(path))
    assert 'schema = "pantocheck.profile/2"' in (out / "profile.toml").read_text("utf-8")
    again = CliRunner().invoke(app, ["migrate", str(path), "--out", str(out)])
    assert (again.exit_code, "exists already" in again.stderr) == (2, True)
    current = CliRunner().invoke(app, ["migrate", str(out / "profile.toml"), "--out", str(tmp_path / "more")])
    assert (current.exit_code, "is the current version; no file is written" in current.output) == (0, True)
    assert not (tmp_path / "more").exists()
    plain = CliRunner().invoke(app, ["migrate", str(library_folder() / "sources.toml"), "--out", str(out)])
    assert (plain.exit_code, "states no version of a format" in plain.stderr) == (2, True)


def unpack(path: Path, folder: Path) -> Path:
    """Frozen file of commit 07ce9e7, unpacked under its own name."""
    unpacked = folder / path.stem
    unpacked.write_bytes(lzma.decompress(path.read_bytes()))
    return unpacked


@pytest.mark.parametrize(
    "path", sorted(FROZEN.rglob("results.json.xz")) + sorted(FROZEN.rglob("modes.json.xz")), ids=lambda p: p.parent.name
)
def test_results_and_modes_of_an_earlier_commit_are_read(path: Path, tmp_path: Path) -> None:
    assert check_input_file(unpack(path, tmp_path)).split()[0] in ("results", "modes")


def test_records_and_damping_tables_of_an_earlier_commit_are_read() -> None:
    assert check_input_file(FROZEN / "250.toml").startswith("record: 5184 samples of 1 pantograph")
    for name in ("damping.toml", "damping_with_modal.toml"):
        assert check_input_file(FROZEN / "T1-fit" / name) == "damping file"


@pytest.mark.parametrize("name", ["T1-fit/damping.json.xz", "T1/identification.json.xz"])
def test_a_file_before_the_first_release_is_refused_with_the_missing_keys(name: str, tmp_path: Path) -> None:
    """No command reads these files; the page says so."""
    with pytest.raises(InputError, match=r"field required"):
        check_input_file(unpack(FROZEN / name, tmp_path))
