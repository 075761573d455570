"""Measurements of the example dossier: the command writes the stored bytes, and the measuring chain is what it says."""

from pathlib import Path

import numpy as np
import pytest

from verification.formulations.dossier_measurements import (
    DOSSIER,
    LOADS_N,
    RUNS,
    move_head,
    read_run,
    series_stiffness,
    write_passage,
    write_response,
    write_statics,
)

pytestmark = pytest.mark.thorough


def test_command_writes_the_stored_files(tmp_path: Path) -> None:
    """Static values, responses and one passage, which takes three seconds; the others are written in the same way."""
    write_statics(tmp_path)
    for load in LOADS_N:
        write_response(tmp_path, load)
    write_passage(tmp_path, RUNS[1])
    written = sorted(tmp_path.iterdir())
    assert len(written) == 8
    for path in written:
        assert path.read_bytes() == (DOSSIER / "measured" / path.name).read_bytes(), path.name


def test_measured_line_has_other_damping() -> None:
    damping = read_run(RUNS[0])["line"]["damping"]
    assert damping["contact_wire"]["stiffness_coefficient_s"] == pytest.approx(1.3 * 5e-5)


def test_head_moves_as_its_dynamic_stiffness_states() -> None:
    """Sinusoidal contact force after the transients: motion of the head within 1 % of the series of springs and masses.

    1 %: the remaining transient after 60 s, and the fit over a whole number of periods.
    """
    chain = read_run(RUNS[0])["pantographs"][0]["chain"]
    step, frequency, contact = 1e-3, 2.0, 1e12
    time = np.arange(0, 60, step)
    height, inertia = move_head(chain, contact, -np.sin(2 * np.pi * frequency * time), step)
    late = time >= 40
    phase = np.exp(-2j * np.pi * frequency * time[late])
    amplitude = 2j * np.mean(height[late] * phase)
    expected = 1 / series_stiffness(chain, np.array([frequency]))[0]
    assert amplitude == pytest.approx(expected, rel=1e-2)
    head = chain["masses_kg"][-1] * (2 * np.pi * frequency) ** 2
    assert 2j * np.mean(inertia[late] * phase) == pytest.approx(-head * expected, rel=1e-2)
