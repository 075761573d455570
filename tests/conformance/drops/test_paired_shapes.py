"""Shapes of matched modes: computed along the wires, measured at the sensors in the same scale."""

from itertools import pairwise

import numpy as np
import pytest

from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.drops.mode_matching import match_modes
from pantocheck.conformance.drops.paired_shapes import list_paired_shapes
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.results.identified_modes import Mode, SensorShape
from pantocheck.model import Catenary, discretise
from pantocheck.model.modal.modes import compute_modes, deflection_at

SENSORS = (("contact wire", "CW", 130.0), ("contact wire", "CW", 205.5), ("messenger wire", "MW", 77.0))
PHASE = 2.0 * np.exp(0.4j)
"""Factor on the measured shapes: an identification knows a shape up to such a factor."""


@pytest.fixture(scope="module")
def line() -> Catenary:
    return build_catenary(select_cases(["en50318-2002/250"])[0].line)


@pytest.fixture(scope="module")
def measured(line: Catenary) -> list[Mode]:
    """Computed modes as an identification of perfect records would write them, in three groups of eight."""
    mesh = discretise(line, 2.0, tuple(sorted(x for _, _, x in SENSORS)))
    modes = compute_modes(mesh, 24)
    shapes = np.array([deflection_at(mesh, modes, mesh.mesh.row_of[wire, "z"], x) for wire, _, x in SENSORS]).T * PHASE
    return [
        Mode(
            frequency_Hz=float(frequency),
            damping_ratio=0.005,
            damping_ratio_std=1e-6,
            group=1 + i // 8,
            sensor_shape=tuple(
                SensorShape(sensor=number, wire=wire, position_m=x, re=value.real, im=value.imag)
                for number, ((_, wire, x), value) in enumerate(zip(SENSORS, shape, strict=True), 1)
            ),
        )
        for i, (frequency, shape) in enumerate(zip(modes.frequency, shapes, strict=True))
    ]


def test_measured_values_lie_on_the_computed_shape(line: Catenary, measured: list[Mode]) -> None:
    """Perfect records: within 2 % of the largest deflection, from the straight lines between points 3.3 m apart."""
    shapes = list_paired_shapes(match_modes(measured, line, 2.0, "modes"), line)
    assert [shape.group for shape in shapes.modes] == [1] * 8 + [2] * 8
    for shape in shapes.modes:
        assert shape.mac == pytest.approx(1.0, abs=1e-9)
        assert [curve.wire for curve in shape.curves] == ["CW", "MW"]
        assert max(abs(value) for curve in shape.curves for value in curve.value) == pytest.approx(1.0, abs=1e-5)
        curves = {curve.wire: curve for curve in shape.curves}
        for sensor in shape.sensors:
            curve = curves[sensor.wire]
            assert sensor.value == pytest.approx(np.interp(sensor.position_m, curve.position_m, curve.value), abs=0.02)


def test_supports_of_the_line_and_modes_with_several_sensors_are_listed(line: Catenary, measured: list[Mode]) -> None:
    """Ten spans of 60 m."""
    supports = list_paired_shapes(match_modes(measured, line, 2.0, "modes"), line).supports_m
    assert [b - a for a, b in pairwise(supports)] == pytest.approx([60.0] * 10)
    # At a single sensor every shape agrees. At most twelve modes of a group are listed.
    single = [mode.model_copy(update={"sensor_shape": mode.sensor_shape[:1], "group": 1}) for mode in measured]
    assert list_paired_shapes(match_modes(single, line, 2.0, "modes"), line).modes == ()
    one_group = [mode.model_copy(update={"group": 1}) for mode in measured]
    assert len(list_paired_shapes(match_modes(one_group, line, 2.0, "modes"), line).modes) == 12
