"""Records with a measured force: known modes lie within their intervals, and the coherence is stated."""

from pathlib import Path

import numpy as np
import pytest
import scipy

from helpers.command_line import pantocheck
from pantocheck.conformance.core.array_types import ComplexArray, RealArray
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.drops.drop_record import DropChannel, DropRecord
from pantocheck.conformance.drops.forced_response import ForcedIdentification, identify_forced
from pantocheck.conformance.results.identified_modes import MeasuredLine, read_modes

RATE, DURATION = 50.0, 240.0
FREQUENCY = np.array([0.85, 0.90, 0.95, 1.70, 1.80, 1.90])
RATIO = np.array([0.0025, 0.0020, 0.0022, 0.0018, 0.0017, 0.0019])
CHANNELS = tuple(DropChannel(f"S{i}", i, "z", "CW", 20.0 * i) for i in range(1, 5))


def shaker_force(random: np.random.Generator) -> RealArray:
    """Random force of 50 N below 5 Hz, which neither begins nor ends at rest."""
    taps = scipy.signal.firwin(401, 5.0, fs=RATE)
    return 50 * scipy.signal.lfilter(taps, 1.0, random.standard_normal(int(RATE * DURATION) + 2000))


def hammer_force(random: np.random.Generator) -> RealArray:
    """One blow of 0.2 s, after 5 s of rest."""
    time = np.arange(int(RATE * DURATION) + 2000) / RATE
    start = 2000 / RATE + 5.0
    inside = (time > start) & (time < start + 0.2)
    return np.where(inside, 800 * np.sin(np.pi * (time - start) / 0.2) ** 2, 0.0)


def respond(force: RealArray, random: np.random.Generator, noise: float) -> DropRecord:
    """Displacement of six modes under a force that is linear between samples, and noise on every channel."""
    omega = 2 * np.pi * FREQUENCY
    poles: ComplexArray = omega * (-RATIO + 1j * np.sqrt(1 - RATIO**2))
    shapes = random.standard_normal((6, 4))
    time = np.arange(force.size) / RATE
    motion = np.zeros((force.size, 4))
    for pole, shape in zip(poles, shapes, strict=True):
        system = scipy.signal.StateSpace([[0, 1], [-(abs(pole) ** 2), 2 * pole.real]], [[0], [1e-2]], [[1, 0]], [[0]])
        motion += np.outer(scipy.signal.lsim(system, force, time)[1], shape)
    kept = slice(2000, None)
    signals = motion[kept] + noise * motion[kept].std() * random.standard_normal(motion[kept].shape)
    line = MeasuredLine(spans_m=(60.0,) * 3)
    return DropRecord("T", "T", RATE, signals, CHANNELS, quantity="displacement", line=line, force=force[kept])


def deviations(found: ForcedIdentification) -> RealArray:
    """Errors of frequency and damping ratio of the six modes, in standard deviations, (12,)."""
    assert len(found.modes) == 6
    frequency = [
        (mode.frequency_Hz - f) / mode.frequency_std_Hz for mode, f in zip(found.modes, FREQUENCY, strict=True)
    ]
    ratio = [(mode.damping_ratio - z) / mode.damping_ratio_std for mode, z in zip(found.modes, RATIO, strict=True)]
    return np.array(frequency + ratio)


@pytest.mark.parametrize("make_force", [shaker_force, hammer_force])
@pytest.mark.parametrize("seed", [1, 2])
def test_known_modes_lie_within_their_intervals(make_force: object, seed: int) -> None:
    """Twelve values a record: none beyond four standard deviations, and their RMS near one."""
    random = np.random.default_rng(seed)
    found = identify_forced(respond(make_force(random), random, noise=0.02), 2.5)
    error = deviations(found)
    assert np.abs(error).max() < 4
    assert np.sqrt(np.mean(error**2)) < 1.6
    assert found.misfit == pytest.approx(1.0, abs=0.1)
    assert all(mode.certain and mode.phase_collinearity > 0.99 for mode in found.modes)


def test_coherence_is_stated_and_falls_with_noise() -> None:
    """Near the modes, the coherence is high; a channel of noise alone has that of some ten averages, about a tenth."""
    random = np.random.default_rng(3)
    record = respond(shaker_force(random), random, noise=0.02)
    signals = record.signals.copy()
    signals[:, 3] = random.standard_normal(signals.shape[0])
    noisy = DropRecord("T", "T", RATE, signals, CHANNELS, force=record.force)
    responses = identify_forced(noisy, 2.5).responses
    inside = (responses.frequency > 0.7) & (responses.frequency < 2.0)
    assert np.median(responses.coherence[inside, 0]) > 0.6
    assert np.median(responses.coherence[inside, 3]) < 0.3


def test_record_without_force_is_refused() -> None:
    record = DropRecord("T", "T", RATE, np.random.default_rng(0).standard_normal((1000, 4)), CHANNELS)
    with pytest.raises(InputError, match="no force channel"):
        identify_forced(record)


def test_command_reads_the_force_channel_and_writes_responses(tmp_path: Path) -> None:
    """The force is the column in kN; its direction is -z, so that the sign of every shape changes."""
    random = np.random.default_rng(4)
    record = respond(shaker_force(random), random, noise=0.02)
    columns = np.column_stack([1e3 * record.signals, -1e-3 * record.force])
    np.savetxt(tmp_path / "shaker.csv", columns, delimiter=",", header="S1,S2,S3,S4,F", comments="")
    rows = [(i, f"S{i}", i, "+z", "mm") for i in range(1, 5)] + [(5, "F", 0, "-z", "kN")]
    channels = "".join(
        f'[[channel]]\ncolumn = {c}\nname = "{name}"\nsensor = {s}\ndirection = "{d}"\nunit = "{unit}"\n'
        for c, name, s, d, unit in rows
    )
    sidecar = f"[test]\nspans_m = [60.0, 60.0, 60.0]\n[record]\nsampling_rate_hz = {RATE}\n{channels}"
    (tmp_path / "shaker.toml").write_text(sidecar, encoding="utf-8")
    result = pantocheck("drop", "identify", tmp_path / "shaker.csv", "--highest", "2.5", "--out", tmp_path / "out")
    assert result.exit_code == 0, result.output
    text = " ".join(result.output.split())
    assert "6 modes identified from 1 record with a measured force" in text
    assert "coherence at the modes" in text
    refused = pantocheck(
        "drop", "identify", tmp_path / "shaker.csv", "--method", "classical", "--out", tmp_path / "out"
    )
    assert refused.exit_code == 2
    modes = read_modes(tmp_path / "out" / "modes.json")
    assert [mode.damping_ratio for mode in modes] == pytest.approx(RATIO, rel=0.1)
    head = (tmp_path / "out" / "responses-1.csv").read_text(encoding="utf-8").splitlines()[0].split(",")
    assert head[0] == "frequency_Hz"
    assert len(head) == 1 + 3 * 4
