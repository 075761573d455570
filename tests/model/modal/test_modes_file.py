"""File modes.json: one model writes and reads it."""

from pathlib import Path

import pytest

from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.json_file import write_model
from pantocheck.conformance.results.identified_modes import Mode, ModesFile, SensorShape, read_modes

MODE = Mode(
    frequency_Hz=4 / 3,
    damping_ratio=0.01 / 3,
    damping_ratio_std=1e-6 / 3,
    sensor_shape=(SensorShape(sensor=1, wire="CW", position_m=20.25, re=1.0, im=-1e-3 / 3),),
)


def test_rounded_mode_equals_the_mode_of_the_file(tmp_path: Path) -> None:
    """A fit in memory and a fit of the file use the same digits; rounding twice changes nothing."""
    write_model(tmp_path / "modes.json", ModesFile((MODE,)))
    (mode,) = read_modes(tmp_path / "modes.json")
    assert mode == MODE.rounded() == MODE.rounded().rounded()
    assert mode.frequency_Hz == 1.3333333


STATED = {"frequency_Hz": "0.5", "damping_ratio": "0.9", "damping_ratio_std": "0.0", "sensor_shape": "[]"}


def read_values(path: Path, values: dict[str, str]) -> Mode:
    text = ", ".join(f'"{key}": {value}' for key, value in values.items())
    path.write_text("[{" + text + "}]", encoding="utf-8")
    return read_modes(path)[0]


@pytest.mark.parametrize(
    ("key", "value"),
    [
        *(("frequency_Hz", value) for value in ("NaN", "Infinity", "0.0")),
        *(("damping_ratio", value) for value in ("0.0", "1.0")),
        ("damping_ratio_std", "-1e-9"),
        ("line", '{"spans_m": [NaN]}'),
    ],
)
def test_values_that_no_decay_has_are_refused(tmp_path: Path, key: str, value: str) -> None:
    assert read_values(tmp_path / "modes.json", STATED).certain
    with pytest.raises(InputError, match=key):
        read_values(tmp_path / "modes.json", STATED | {key: value})
