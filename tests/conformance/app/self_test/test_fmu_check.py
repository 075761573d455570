"""`pantocheck pantograph check`: a good FMU, and broken ones, each refused with its reason."""

import tempfile
import zipfile
from pathlib import Path

import numpy as np
import pytest

from helpers.command_line import pantocheck
from helpers.fmu_fixtures import WriteFmu, damage
from helpers.response_records import chain_stiffness, polar_columns, scale_head, write_response
from pantocheck.conformance.app.self_test.fmu_check import check_fmu
from pantocheck.conformance.pantograph.pantograph_file import PantographFile
from pantocheck.conformance.pantograph.response_record import read_response
from pantocheck.conformance.runs import fmu_process

STEP = 0.01
"""Time step of the coupling [s]; half of it is checked, too."""


def findings(file: object, step: float = STEP) -> dict[str, tuple[str, str]]:
    return {found.subject: (found.state, found.text) for found in check_fmu(file, 120.0, step).findings}


def test_a_chain_as_fmu_passes(write_fmu: WriteFmu, tmp_path: Path) -> None:
    write_fmu()
    answer = pantocheck("pantograph", "check", tmp_path / "fmu" / "model.fmu", "--step", STEP)
    assert answer.exit_code == 0, answer.output
    shown = " ".join(answer.output.split())
    assert "Nothing is wrong." in shown
    assert "differs from the linear model of the file by 0.00%" in shown
    states = [line.split()[0] for line in answer.output.splitlines() if line.split()[:1] in (["ok"], ["note"])]
    assert states == ["ok"] * 8 + ["note"]
    answer = pantocheck("pantograph", "check", tmp_path / "other.fmu")
    assert answer.exit_code == 2
    assert "other.toml or fmu.toml" in answer.output


def test_an_fmu_without_rollback_is_told_so(write_fmu: WriteFmu) -> None:
    found = findings(write_fmu(has_state=False, version=3))
    assert found["rollback"][0] == "note"
    assert "wrong" not in {state for state, _ in found.values()}


@pytest.mark.parametrize(
    ("fault", "subject", "reason"),
    [
        ("sign", "run", "check the sign of its force"),
        ("delay", "run", "whether its height answers within the step"),
        ("energy", "energy", "the head delivers energy"),
        ("crash", "run", "was ended by SIGSEGV"),
        ("hang", "run", "gave no answer within 1 s"),
        ("abort", "run", "failed with status 3"),
        ("not a number", "run", "must be finite numbers"),
        ("noise", "rollback", "the state is not restored"),
    ],
)
def test_a_broken_fmu_is_refused_with_its_reason(
    write_fmu: WriteFmu, monkeypatch: pytest.MonkeyPatch, fault: str, subject: str, reason: str
) -> None:
    monkeypatch.setattr(fmu_process, "STEP_LIMIT", 1.0)
    step = 0.004 if fault == "energy" else STEP  # in longer steps the head comes to no rest
    state, text = findings(write_fmu(fault=fault), step)[subject]
    assert state == "wrong"
    assert reason in text


def test_a_wrong_mass_and_a_wrong_static_force_are_found(write_fmu: WriteFmu) -> None:
    """The mass by the response; the FMU has its own 120 N, the check asks for 130 N."""
    file = write_fmu()
    heavier = file.chain.model_copy(update={"masses_kg": (15.0, 9.0)})
    own = file.fmu.model_copy(update={"uplift_force_N": None})
    found = check_fmu(file.model_copy(update={"chain": heavier, "fmu": own}), 130.0, STEP).findings
    wrong = {finding.subject: finding.text for finding in found if finding.state == "wrong"}
    assert set(wrong) == {"static force", "response"}
    assert "Correct mass, springs and dampers" in wrong["response"]


def write_measured(folder: Path, pantograph: PantographFile) -> Path:
    """Sidecar of the apparent mass of a chain from 0.6 to 19 Hz."""
    frequency = np.geomspace(0.6, 19.0, 80)
    mass = chain_stiffness(pantograph, frequency) / -((2 * np.pi * frequency) ** 2)
    table = write_response(folder, polar_columns(mass, "kg", frequency), static_force_N=120.0)
    return table.with_suffix(".toml")


def test_a_measured_response_refutes_another_head(write_fmu: WriteFmu, tmp_path: Path) -> None:
    """A head of 1.5 times the mass: beyond 20 % from some frequency on."""
    measured = write_measured(tmp_path, scale_head(write_fmu(), 1.5))
    answer = pantocheck("pantograph", "check", tmp_path / "fmu" / "model.fmu", "--step", STEP, "--response", measured)
    assert answer.exit_code == 1, answer.output
    assert "measured.csv supports the FMU up to" in " ".join(answer.output.split())


def test_a_measured_response_is_compared_with_the_fmu_and_not_with_its_file(
    write_fmu: WriteFmu, tmp_path: Path
) -> None:
    """The head of the file is a tenth heavier than both, or 10 %; 3 % is left to the interpolation at resonance."""
    file = write_fmu()
    record = read_response(write_measured(tmp_path, file))
    found = {row.subject: row for row in check_fmu(scale_head(file, 1.1), 120.0, STEP, [record]).findings}
    assert found["measured"].state == "ok"
    assert float(found["measured"].text.split()[-1].rstrip("%.")) < 3.0


def check_damaged(fmu: Path, folder: Path, seed: int) -> int:
    """Check a damaged FMU; exit code. Archive, model description or library is damaged, with valid checksums inside."""
    whole, path = fmu.read_bytes(), folder / "model.fmu"
    if seed % 3 == 0:
        path.write_bytes(damage(whole, seed // 3))
    else:
        with zipfile.ZipFile(fmu) as source, zipfile.ZipFile(path, "w") as target:
            for name in source.namelist():
                content, is_library = source.read(name), name.endswith(".so")
                if seed % 3 == 1 and not is_library:
                    content = damage(content, seed // 3)
                if seed % 3 == 2 and is_library:  # its head or its end alone: changed code may do anything
                    content = damage(content[:64], seed // 3) + content[64:] if seed % 2 else content[: 50 * seed]
                target.writestr(name, content)
    answer = pantocheck("pantograph", "check", path, "--step", 0.01)
    assert answer.exit_code in (0, 1, 2), (seed, answer.output)
    assert "internal error" not in answer.output, (seed, answer.output)
    assert "Traceback" not in answer.output, (seed, answer.output)
    return answer.exit_code


def check_all_damaged(write: WriteFmu, folder: Path, monkeypatch: pytest.MonkeyPatch, seeds: range) -> float:
    """Share of damaged FMUs that are refused; nothing but their copies is in any folder afterwards."""
    monkeypatch.setattr(fmu_process, "STEP_LIMIT", 2.0)
    monkeypatch.setattr(fmu_process, "LOAD_LIMIT", 20.0)
    write()
    place, temporary = folder / "damaged", folder / "temporary"
    place.mkdir()
    temporary.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(temporary))
    (place / "fmu.toml").write_bytes((folder / "fmu" / "fmu.toml").read_bytes())
    codes = [check_damaged(folder / "fmu" / "model.fmu", place, seed) for seed in seeds]
    assert sorted(path.name for path in folder.iterdir()) == ["damaged", "fmu", "temporary"]
    assert sorted(path.name for path in place.iterdir()) == ["fmu.toml", "model.fmu"]
    assert not list(temporary.iterdir())
    return sum(code != 0 for code in codes) / len(codes)


def test_damaged_fmus_give_a_reason(write_fmu: WriteFmu, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert check_all_damaged(write_fmu, tmp_path, monkeypatch, range(6)) >= 0.5


@pytest.mark.thorough
def test_200_damaged_fmus_give_a_reason(write_fmu: WriteFmu, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Changed texts, dates and unused functions leave some of them whole."""
    assert check_all_damaged(write_fmu, tmp_path, monkeypatch, range(6, 206)) >= 0.7
