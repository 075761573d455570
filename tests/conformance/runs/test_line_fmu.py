"""A line as FMU: the record of the built-in passage, state, reset, sources and refusals."""

import functools
import subprocess
import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from helpers.short_cases import change_case
from pantocheck.conformance.app.commands.command_list import app
from pantocheck.conformance.app.self_test.adapter_check import build_short_case, build_twin_case
from pantocheck.conformance.core.extras import is_installed
from pantocheck.conformance.grading.case_grading import grade_case
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.runs import line_fmu
from pantocheck.conformance.runs.line_fmu import FmiVersion, GivenInput, build_line_fmu, name_platform
from pantocheck.conformance.runs.reference_simulator import UnrefinedSimulator
from verification.fmu.coupling_table import compare_quantities
from verification.fmu.fmu_builder import find_missing_tool
from verification.fmu.line_coupling import ImportedLine, open_line, run_exported
from verification.fmu.line_importers import load_ecos, replay_in_ecos
from verification.fmu.line_passages import repeat_passages

CASES = {1: change_case(build_short_case(), mesh=(2.0, 0.004)), 2: change_case(build_twin_case(), mesh=(2.0, 0.004))}
"""Short cases by their number of pantographs."""
ExportLine = Callable[..., Path]
compile_once = functools.cache(line_fmu.compile_library)


@pytest.fixture(scope="session")
def export_line(tmp_path_factory: pytest.TempPathFactory) -> ExportLine:
    """Function that exports the line of a short case, once per kind."""
    if (reason := find_missing_tool()) is not None:
        pytest.skip(reason)
    folder = tmp_path_factory.mktemp("lines")

    def export(number: int = 1, fmi: FmiVersion = "3.0", given: GivenInput = "height") -> Path:
        path = folder / f"{number}-{fmi}-{given}.fmu"
        if not path.exists():
            with pytest.MonkeyPatch.context() as patch:
                patch.setattr(line_fmu, "compile_library", compile_once)  # the same one for all lines
                path.write_bytes(build_line_fmu(CASES[number], fmi, given))
        return path

    return export


@functools.cache
def read_record(number: int = 1) -> Record:
    """Record of the built-in passage of a short case."""
    record = UnrefinedSimulator().run(CASES[number]).record
    assert record is not None
    return record


@pytest.mark.parametrize(("number", "fmi"), [(1, "3.0"), (2, "2.0")])
def test_exported_line_gives_the_quantities_of_the_built_in_passage(
    export_line: ExportLine, number: int, fmi: FmiVersion
) -> None:
    """The same core with the same arithmetic: 1e-6 leaves the iterations, 1e-9 N, and the roundings of positions."""
    from fmpy.validation import validate_fmu

    path, case = export_line(number, fmi), CASES[number]
    assert validate_fmu(str(path)) == []
    found = run_exported(case, path)
    assert compare_quantities(grade_case(case, UnrefinedSimulator().run(case), "secondary"), found)[0] < 1e-6
    assert found.record.state == "consistent"


@pytest.mark.parametrize("fmi", ["2.0", "3.0"])
def test_heads_under_the_forces_of_a_record_have_its_heights(export_line: ExportLine, fmi: FmiVersion) -> None:
    """1e-8 m of 60 mm: the light head takes 1e-6 N of 120 N. Without a force, a head does not touch the wire."""
    record = read_record(2)
    with open_line(export_line(2, fmi, "force")) as line:
        rows = []
        for force in record.force.T:
            line.step("contact_force", force)
            rows.append(np.concatenate([line.get("head_height"), line.get("uplift")]))
    found = np.array(rows).T
    touching = record.force > 0
    assert touching.mean() > 0.95
    assert np.abs(found[:2] - record.contact_height)[touching].max() < 1e-8
    assert np.ptp(record.contact_height) > 0.05
    supports = np.searchsorted(CASES[2].line.geometry.supports, record.support_position)
    assert np.nanmax(np.abs(found[2:][supports] - record.support_uplift)) < 1e-8
    assert np.nanmax(record.support_uplift) > 0.02


def test_second_importer_gives_the_force_of_the_record(export_line: ExportLine) -> None:
    """Ecos, an importer in C++, replays the heights of the record: 0.05 % of 120 N are 0.06 N."""
    try:
        load_ecos()
    except (ImportError, OSError) as error:
        pytest.skip(f"Ecos cannot be loaded: {error}")
    for fmi in ("2.0", "3.0"):
        found = replay_in_ecos(export_line(1, fmi), read_record().contact_height, 0.004)
        assert np.abs(found - read_record().force).max() < 1e-3


def replay(line: ImportedLine, heights: np.ndarray) -> np.ndarray:
    """Forces and uplifts under given heights."""
    rows = []
    for height in heights.T:
        line.step("head_height", height)
        rows.append(np.concatenate([line.get("contact_force"), line.get("uplift")]))
    return np.array(rows)


def test_a_state_a_reset_and_another_instance_give_the_same_bits(export_line: ExportLine) -> None:
    heights = read_record().contact_height[:, :100]
    with open_line(export_line()) as line, open_line(export_line()) as other:
        first = replay(line, heights[:, :40])
        kept = line.save()
        second = replay(line, heights[:, 40:])
        line.restore(kept)
        assert np.array_equal(replay(line, heights[:, 40:]), second)
        line.free(kept)
        line.reset({})
        assert np.array_equal(replay(line, heights), np.concatenate([first, second]))
        assert np.array_equal(replay(other, heights), np.concatenate([first, second]))


def test_repeated_passages_are_equal_and_take_no_memory(export_line: ExportLine) -> None:
    """A state has 0.2 MB: losing one per passage makes 40 MB of 200; other memory of the process moves by 4 MB."""
    result = repeat_passages(export_line(), read_record().contact_height[:, 9:300:10], simulated_s=300 * 0.004 * 200)
    assert (result.passages, result.largest_difference) == (200, 0.0)
    assert result.memory_growth_MB < 10.0


def test_position_and_long_steps(export_line: ExportLine) -> None:
    """Speed as parameter and travel as input are one motion; a long step is ten steps with heights on a line.

    1e-6 N of 100 N: rounding of the positions, below 1e-12 m, and of the heights.
    """
    with open_line(export_line()) as line:
        height = line.get("head_height")[0]
        ramp = height + np.linspace(0.0, 1e-3, 21)[None, 1:]
        expected = replay(line, ramp)
        speed = CASES[1].speed
        line.reset({"speed": 0.0})
        for n, value in enumerate(ramp[0], 1):
            line.set({"travel_1": speed * 0.004 * n})
            line.step("head_height", np.array([value]))
        assert line.get("contact_force")[0] == pytest.approx(expected[-1, 0], abs=1e-6)
        line.reset({})
        line.time_step *= 10
        assert replay(line, ramp[:, 9::10])[-1] == pytest.approx(expected[-1], abs=1e-6)
        line.time_step /= 10


def test_another_start_begins_without_a_load(export_line: ExportLine) -> None:
    """A head below the wire feels nothing; raised into it by the height of the first start, it presses upwards."""
    with open_line(export_line(), {"start_1": 130.0}) as line:
        assert line.get("position") == [130.0]
        assert not np.any(np.concatenate([line.get("contact_force"), line.get("uplift")]))
        heights = line.get("head_height") - np.linspace(0.2, 0.0, 50)[None, :].T
        assert replay(line, heights[:10].T)[-1, 0] == 0.0
        forces = replay(line, heights[10:].T)[:, 0]
        assert forces[-1] > 10.0


def test_what_a_line_refuses(export_line: ExportLine, capfd: pytest.CaptureFixture[str]) -> None:
    from fmpy.fmi1 import FMICallException

    def refuse(action: Callable[[], object], reason: str) -> None:
        capfd.readouterr()
        with pytest.raises(FMICallException):
            action()
        shown = capfd.readouterr()
        assert reason in shown.out + shown.err

    with open_line(export_line()) as line:
        height = line.get("head_height")
        refuse(lambda: line.unit.doStep(0.0, 0.005), "no multiple of the time step")
        refuse(lambda: line.unit.doStep(1.0, 0.004), "the last one ended at 0 s")
        refuse(lambda: line.set({"position_1": 1.0}), "cannot be set now")
        refuse(lambda: line.set({"head_height_1": np.nan}), "is set to nan")
        line.step("head_height", height)
        refuse(lambda: line.set({"speed": 1.0}), "cannot be set now")
        line.set({"travel_1": 1e4})
        refuse(lambda: line.step("head_height", height), "leaves the line")


def test_an_image_of_another_description_is_not_loaded(export_line: ExportLine, tmp_path: Path) -> None:
    other = tmp_path / "other.fmu"
    with zipfile.ZipFile(export_line()) as source, zipfile.ZipFile(other, "w") as changed:
        for entry in source.infolist():
            content = source.read(entry)
            changed.writestr(entry, content[:5000] if entry.filename.endswith("line.bin") else content)
    with pytest.raises(Exception, match="instantiate"), open_line(other):
        pass


def test_the_sources_of_an_archive_build_its_library(export_line: ExportLine, tmp_path: Path) -> None:
    """Compiled from the archive alone and without vector instructions of this processor: the same bits."""
    rebuilt, library = tmp_path / "rebuilt.fmu", f"binaries/{name_platform('3.0')}"
    with zipfile.ZipFile(export_line()) as source, zipfile.ZipFile(rebuilt, "w") as changed:
        source.extractall(tmp_path, [name for name in source.namelist() if name.startswith("sources/")])
        command = "cc -std=c11 -O1 -DWIDEST=2 -Wno-psabi -fPIC -shared -o library sources/line_fmu.c -lm"
        subprocess.run(command.split(), cwd=tmp_path, check=True)
        for entry in source.infolist():
            if entry.filename != library:
                changed.writestr(entry, source.read(entry))
        changed.write(tmp_path / "library", library)
    heights = read_record().contact_height[:, :50]
    with open_line(export_line()) as line, open_line(rebuilt) as other:
        assert np.array_equal(replay(line, heights), replay(other, heights))


def test_the_command_writes_an_archive_and_names_a_missing_compiler(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("CC", "no-such-compiler")
    arguments = ["line", "export", "en50318-2002/250", "--fmu", str(tmp_path / "line.fmu")]
    result = CliRunner().invoke(app, arguments)
    assert result.exit_code == 2
    assert "no C compiler 'no-such-compiler'" in result.output
    assert not list(tmp_path.iterdir())
    if find_missing_tool() is None and is_installed("fmpy"):
        monkeypatch.delenv("CC")
        monkeypatch.setattr(line_fmu, "compile_library", compile_once)
        assert CliRunner().invoke(app, arguments).exit_code == 0
        assert zipfile.is_zipfile(tmp_path / "line.fmu")
