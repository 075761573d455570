"""Frequency responses and repeatability of a drop."""

import numpy as np
import pytest

from pantocheck.conformance.core.units import STANDARD_GRAVITY
from pantocheck.conformance.drops.decay_kernel import FrequencyBand
from pantocheck.conformance.drops.decay_preparation import prepare_decay
from pantocheck.conformance.drops.drop_record import DropChannel, DropDescription, DropRecord
from pantocheck.conformance.drops.identification_analysis import compute_frequency_response
from pantocheck.conformance.drops.identify import identify_modes
from pantocheck.conformance.drops.repeatability import compare_records
from pantocheck.conformance.results.identified_modes import MeasuredLine

RATE, RELEASE, MASS = 50.0, 5.0, 20.0
MODAL_MASS = 100.0  # [kg]
FREQUENCY, RATIO = np.array([0.9, 1.7, 2.6]), np.array([0.006, 0.004, 0.003])


def build_record(
    name: str,
    random: np.random.Generator,
    noise: float = 0.002,
    shift: float = 0.0,
    other: float = 1.0,
    tension: float = 1.0,
) -> DropRecord:
    """Three oscillators released by a step force m g: x'' = F/M exp(-d t) (cos w t - d/w sin w t).

    A factor on the tension of the line changes every frequency by its square root.
    """
    t = np.arange(int(90 * RATE)) / RATE - RELEASE - shift
    force = MASS * STANDARD_GRAVITY
    signal = np.zeros((t.size, 2))
    for j, (f, z) in enumerate(zip(np.sqrt(tension) * FREQUENCY, RATIO, strict=True)):
        decay, omega = 2 * np.pi * f * z, 2 * np.pi * f * np.sqrt(1 - z**2)
        after = np.maximum(t, 0)
        motion = np.exp(-decay * after) * (np.cos(omega * after) - decay / omega * np.sin(omega * after))
        signal += np.outer(np.where(t >= 0, force / MODAL_MASS * motion, 0), (1.0, 0.5 * (-other) ** j))
    signal += noise * random.standard_normal(signal.shape)
    channels = (DropChannel("S1_z", 1, "z", "CW", 10.0), DropChannel("S2_z", 2, "z", "CW", 30.0))
    drop, line = DropDescription(MASS, "CW", 10.0, RELEASE), MeasuredLine(spans_m=(60.0,))
    return DropRecord(name, "synthetic", RATE, signal, channels, drop=drop, line=line)


def test_response_is_that_of_the_oscillators_measured_and_identified() -> None:
    """Accelerance sum -w^2 / (M (w0^2 - w^2 + 2 i z w0 w)) at half-power lines of the strongest mode."""
    # Within 6 %, the most that the record's end can do: what rings on after 85 s, exp(-2.9) = 6 % of the slowest mode,
    # is missing from its peak (it lacks 5.8 % in the measured and 5.6 % in the identified response; 3.0 and 2.7 % at
    # 1.7 Hz, 1.2 and 1.5 % at 2.6 Hz). The release is known to one sample: w dt = 0.11 rad at 0.9 Hz turns the phase,
    # not the magnitude.
    (identification,) = identify_modes((build_record("one", np.random.default_rng(1)),), highest=4.0)
    response = compute_frequency_response(identification.fit, identification.fit.records[0])
    omega = 2 * np.pi * response.frequency
    omega_0 = 2 * np.pi * FREQUENCY
    terms = -(omega[:, None] ** 2) / (
        MODAL_MASS * (omega_0**2 - omega[:, None] ** 2 + 2j * RATIO * omega_0 * omega[:, None])
    )
    exact = terms.sum(axis=1)
    for f in FREQUENCY:
        near = np.abs(response.frequency - f) < 0.02
        for h in (response.measured, response.identified):
            assert np.abs(h[near, 0]).max() == pytest.approx(np.abs(exact[near]).max(), rel=0.06)
    low = response.frequency < 3.0
    left = np.linalg.norm((response.measured - response.identified)[low])
    assert left < 0.03 * np.linalg.norm(response.measured[low])


def test_repeats_correlate_and_another_line_does_not() -> None:
    random = np.random.default_rng(3)
    first, again = build_record("first", random), build_record("again", random, shift=0.13)
    (identification,) = identify_modes((first, again), highest=4.0)
    same = compare_records(tuple(record.decay for record in identification.fit.records))
    assert same.verdict == "repeatable"
    assert min(c.correlation_at_start for c in same.comparisons) > 0.999
    other = build_record("other", random, other=-1.0)
    (changed,) = identify_modes((first, other), highest=4.0)
    different = compare_records(tuple(record.decay for record in changed.fit.records))
    assert different.verdict == "not repeatable"
    assert "S2_z" in different.reason


@pytest.mark.parametrize(
    ("change", "verdict"),
    [
        ({"other": 0.8}, "repeatable"),  # 0.984 at the start
        ({"other": 0.6}, "not repeatable"),  # 0.931 at the start, 0.965 a minute later
        ({"tension": 1.001}, "repeatable"),  # 0.969 a minute later
        ({"tension": 1.002}, "not repeatable"),  # 0.880 a minute later, 0.9995 at the start
    ],
)
def test_repeatable_drop_correlates_by_98_and_later_by_95_percent(change: dict[str, float], verdict: str) -> None:
    """Another shape shows at the start; a tension that differs by 0.2 % turns the phase by 0.4 rad within a minute."""
    # The correlations are those of records without noise, shifted by the delay that is fitted at the start. The noise
    # permits 0.9998; the release is known to a sample of 20 ms, which moves the windows and not the phases.
    random = np.random.default_rng(4)
    records = build_record("first", random), build_record("second", random, **change)
    found = compare_records(tuple(prepare_decay(record, FrequencyBand.up_to(4.0, RATE)) for record in records))
    assert found.verdict == verdict
    (second,) = (comparison for comparison in found.comparisons if comparison.channel == "S2_z")
    shifts = ({}, {**change, "shift": -second.shift_s})
    exact = [build_record("exact", random, noise=0.0, **keys).signals[:, 1] for keys in shifts]
    for begin, correlation in ((1.5, second.correlation_at_start), (60.0, second.correlation_later)):
        window = slice(round((RELEASE + begin) * RATE), round((RELEASE + begin + 10) * RATE))
        assert correlation == pytest.approx(np.corrcoef(*(signal[window] for signal in exact))[0, 1], abs=0.003)
