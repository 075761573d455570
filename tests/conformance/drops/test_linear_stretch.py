"""Choice of the linear part of a decay: droppers that slacken at its start, and records without such a part."""

from dataclasses import replace

import numpy as np
import pytest

from helpers.surrogate_drops import LineModes, build_line_modes, make_record
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.drops.drop_record import DropRecord
from pantocheck.conformance.drops.identification_analysis import analyse_identification
from pantocheck.conformance.drops.identify import identify_modes
from pantocheck.conformance.pages.identification_page import list_record_blocks
from verification.tables.field_records import LINES, REST, Disturbance

LAST_SLACK = 24.0
"""Last impulse of a dropper after the release [s]."""


@pytest.fixture(scope="module")
def modes() -> LineModes:
    return build_line_modes(next(iter(LINES)))


def strike(record: DropRecord, modes: LineModes) -> DropRecord:
    """Record with an impulse of a dropper every 0.7 s until the last one, each of a fifth of the motion."""
    random = np.random.default_rng(3)
    time = record.time - REST
    signals = record.signals.copy()
    omega = 2 * np.pi * modes.frequency
    for at in np.append(np.arange(0.5, LAST_SLACK, 0.7), LAST_SLACK):
        after = time >= at
        decay = np.exp(np.outer(time[after] - at, omega * (1j - modes.ratio)))
        kick = random.standard_normal((omega.size, signals.shape[1])) * 0.2 * np.exp(-at / 40)
        signals[after] += 0.05 * (decay @ kick).imag
    return replace(record, signals=signals)


def test_decay_starts_after_the_last_slack_dropper(modes: LineModes) -> None:
    """The first minute is no decay; the part after the last impulse is, and its modes are true."""
    made = make_record(modes, np.random.default_rng(2), Disturbance(), sensors=3, minutes=1.5)
    (found,) = identify_modes((strike(made.record, modes),), 3.0)
    decay = found.fit.records[0].decay
    start = decay.linear.start - decay.release.time
    # The windows are a second long, and so is each side of their filter; two of them may begin late.
    assert LAST_SLACK - 1.0 < start < LAST_SLACK + 2.0
    assert any(f"used from {start:.1f} s after the release; beyond, the residual" in text for text in found.warnings)
    certain = [mode for mode in found.modes if mode.certain]
    assert len(certain) >= 0.8 * np.sum(modes.frequency < 3.0)
    for mode in certain:
        nearest = np.argmin(np.abs(made.frequency - mode.frequency_Hz))
        assert mode.damping_ratio == pytest.approx(made.ratio[nearest], abs=4 * mode.damping_ratio_std)
    line = analyse_identification(found)
    assert all(9.5 < (sensor.onset_s or 0.0) < 14.0 for sensor in line.records[0].sensors)
    time, ratio = (np.array(values) for values in (line.records[0].residual_time_s, line.records[0].residual_over_rest))
    assert ratio[time < LAST_SLACK - 6].min() > 5
    assert np.median(ratio[time > LAST_SLACK + 6]) == pytest.approx(1.0, abs=0.3)
    assert "choice of the used part" in repr(list(list_record_blocks(line)))


def test_record_without_a_linear_part_is_refused_with_its_residual(modes: LineModes) -> None:
    """A record that ends 8 s after the last impulse; no cause is stated, but the residual at each sensor."""
    made = make_record(modes, np.random.default_rng(2), Disturbance(), sensors=3, minutes=1.5)
    struck = strike(made.record, modes)
    short = replace(struck, signals=struck.signals[: int((REST + LAST_SLACK + 8.0) * struck.rate)].copy())
    with pytest.raises(
        InputError, match=r"no part of 10 s or longer .* residual from 0.3 to .* Hz is .* at S1_z, S2_z"
    ):
        identify_modes((short,), 2.0)
