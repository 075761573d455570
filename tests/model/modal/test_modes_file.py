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


@pytest.mark.parametrize("value", ["NaN", "Infinity"])
def test_values_that_are_not_finite_are_refused(tmp_path: Path, value: str) -> None:
    text = '[{"frequency_Hz": %s, "damping_ratio": 0.005, "damping_ratio_std": 0.0, "sensor_shape": []}]'
    (tmp_path / "modes.json").write_text(text % value, encoding="utf-8")
    with pytest.raises(InputError, match="frequency_Hz"):
        read_modes(tmp_path / "modes.json")
