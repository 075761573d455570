"""Plan of an identification: poles, bands, channels and stretches of the user, and the classical method."""

import re
from pathlib import Path

import numpy as np
import pytest

from helpers.synthetic_drops import SyntheticDrop, drop
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.drops.drop_record import DropChannel, DropDescription, DropRecord
from pantocheck.conformance.drops.identification_plan import IdentificationPlan, read_identification_plan
from pantocheck.conformance.drops.identify import identify_modes
from pantocheck.conformance.results.identified_modes import MeasuredLine, Mode

FREQUENCY = np.array([0.9, 1.0, 1.9, 2.1])
RATIO = np.array([0.004, 0.004, 0.003, 0.003])


@pytest.fixture(scope="module")
def synthetic() -> SyntheticDrop:
    """Four separate modes: the closest are 0.1 Hz apart, twelve half-power bandwidths."""
    omega = 2 * np.pi * FREQUENCY
    poles = -RATIO * omega + 1j * omega * np.sqrt(1 - RATIO**2)
    return drop(np.random.default_rng(9), poles, duration=120.0, rate=20.0, noise=0.002)


def build_record(synthetic: SyntheticDrop, disturbance: RealArray | float = 0.0) -> DropRecord:
    channels = tuple(DropChannel(f"S{i}_z", i, "z", "CW", 20.0 * i) for i in range(synthetic.samples.shape[1]))
    facts, line = DropDescription(20, "CW", 100, 5.0), MeasuredLine(spans_m=(60.0,) * 2)
    signals = synthetic.samples + disturbance
    return DropRecord("T", "T", synthetic.rate, signals, channels, drop=facts, line=line)


def identify(record: DropRecord, **plan: object) -> tuple[Mode, ...]:
    (found,) = identify_modes((record,), 3.0, plan=IdentificationPlan.model_validate(plan))
    return found.modes


def frequencies(modes: tuple[Mode, ...]) -> list[float]:
    return [round(mode.frequency_Hz, 2) for mode in modes]


@pytest.mark.parametrize(
    ("plan", "expected"),
    [
        ({}, [0.9, 1.0, 1.9, 2.1]),
        ({"pole": [{"frequency_Hz": 1.0, "action": "drop"}]}, [0.9, 1.9, 2.1]),
        ({"pole": [{"frequency_Hz": 0.9, "action": "keep"}]}, [0.9, 1.0, 1.9, 2.1]),
        ({"pole": [{"frequency_Hz": f} for f in (0.9, 1.0)]}, [0.9, 1.0, 1.9, 2.1]),  # the search adds the others
        ({"band": [{"from_Hz": 1.5, "to_Hz": 2.5}]}, [1.9, 2.1]),
        ({"band": [{"from_Hz": 1.5, "to_Hz": 2.5, "order": 2}]}, [1.9, 2.1]),
        ({"highest_Hz": 1.5}, [0.9, 1.0]),
    ],
)  # fmt: skip
def test_poles_and_bands_of_the_plan(synthetic: SyntheticDrop, plan: dict[str, object], expected: list[float]) -> None:
    assert frequencies(identify(build_record(synthetic), **plan)) == expected


def test_order_of_a_band_removes_the_weakest_pole_and_adds_the_strongest(synthetic: SyntheticDrop) -> None:
    record = build_record(synthetic)
    assert len(identify(record, band=[{"from_Hz": 1.5, "to_Hz": 2.5, "order": 1}])) == 1
    # A third pole is added although the data show two; it does not move the others.
    modes = identify(record, band=[{"from_Hz": 1.5, "to_Hz": 2.5, "order": 3}])
    assert len(modes) == 3
    assert {1.9, 2.1} <= set(frequencies(modes))


def test_excluded_stretch_and_channel_leave_the_damping_ratios(synthetic: SyntheticDrop) -> None:
    """A shock of 0.5 s after 90 s spoils the record; without it, every ratio is within three standard deviations."""
    time = np.arange(synthetic.samples.shape[0]) / synthetic.rate
    shock = np.where((time > 90) & (time < 90.5), 3.0, 0.0)[:, None] * synthetic.samples.std()
    plan = {"exclude": [{"record": "T", "from_s": 80.0, "to_s": 92.0}], "exclude_channels": ["S1_z"], "highest_Hz": 1.5}
    (found,) = identify_modes((build_record(synthetic, shock),), 3.0, plan=IdentificationPlan.model_validate(plan))
    assert found.fit.records[0].decay.linear.end <= 80.0
    assert frequencies(found.modes) == [0.9, 1.0]
    for mode, ratio in zip(found.modes, RATIO[:2], strict=True):
        assert abs(mode.damping_ratio - ratio) < 3 * mode.damping_ratio_std
        assert {shape.sensor for shape in mode.sensor_shape} == set(range(synthetic.samples.shape[1])) - {1}


@pytest.mark.parametrize(
    ("plan", "message"),
    [
        ({"exclude_channels": ["other"]}, "no record has this channel"),
        ({"exclude": [{"from_s": 0.0, "to_s": 200.0}]}, "the plan leaves 0.0 s"),
        ({"pole": [{"frequency_Hz": 1.5, "action": "drop"}]}, "no pole is there to drop"),
    ],
)
def test_plan_that_does_not_fit_the_record_is_refused(
    synthetic: SyntheticDrop, plan: dict[str, object], message: str
) -> None:
    with pytest.raises(InputError, match=message):
        identify(build_record(synthetic), **plan)


def test_plan_file_names_unknown_keys_and_wrong_bands(tmp_path: Path) -> None:
    path = tmp_path / "plan.toml"
    pole = "[[pole]]\nfrequency_Hz = 1.0\ndamping_ratio = "
    for text in ("[[band]]\nfrom_Hz = 2.0\nto_Hz = 1.0\norders = 3\n", f"{pole}1.0\n"):
        path.write_text(text, encoding="utf-8")
        with pytest.raises(InputError):
            read_identification_plan(path)
    path.write_text(f'method = "classical"\n{pole}0.6\n', encoding="utf-8")
    plan = read_identification_plan(path)
    assert plan.method == "classical"
    assert plan.pole[0].pole == pytest.approx(2 * np.pi * complex(-0.6, 0.8))  # 0.6^2 + 0.8^2 = 1


def test_every_sensor_of_a_mode_has_its_own_error(synthetic: SyntheticDrop) -> None:
    """Noise on one channel raises the error there most."""
    noise = np.zeros_like(synthetic.samples)
    noise[:, 0] = np.random.default_rng(1).standard_normal(noise.shape[0]) * 0.2 * synthetic.samples.std()
    for mode in identify(build_record(synthetic, noise)):
        first, *others = (shape.error for shape in mode.sensor_shape)
        assert first > max(others)


def test_classical_poles_are_right_alone_and_merge_close_modes(synthetic: SyntheticDrop) -> None:
    """Separate modes agree with the truth to 5 %. Two close modes become one pole."""
    modes = identify(build_record(synthetic), method="classical")
    assert frequencies(modes) == [0.9, 1.0, 1.9, 2.1]
    assert [mode.damping_ratio for mode in modes] == pytest.approx(RATIO, rel=0.05)
    # Two modes less than two lines apart are one peak.
    omega = 2 * np.pi * np.array([0.9, 0.915])
    pair = drop(np.random.default_rng(4), -0.001 * omega + 1j * omega, duration=120.0, rate=20.0, noise=0.002)
    assert len(identify(build_record(pair))) == 2
    assert len(identify(build_record(pair), method="classical")) == 1
    (left,) = identify(build_record(pair), pole=[{"frequency_Hz": 0.915, "action": "drop"}])
    assert left.frequency_Hz == pytest.approx(0.9, abs=1e-3)


def test_plan_of_the_documentation_is_valid(tmp_path: Path) -> None:
    page = (Path(__file__).parents[3] / "docs" / "identification.md").read_text(encoding="utf-8")
    (block,) = (
        part for part in re.findall(r"```toml\n(.*?)```", page, re.DOTALL) if "[[pole]]" in part and "[[band]]" in part
    )
    (tmp_path / "plan.toml").write_text(block, encoding="utf-8")
    plan = read_identification_plan(tmp_path / "plan.toml")
    assert (plan.highest_Hz, plan.band[0].order, plan.pole[0].action) == (7.0, 6, "start")
    assert plan.exclude_channels == ("S3_z",)
    assert plan.exclude[0].to_s == 92.0
