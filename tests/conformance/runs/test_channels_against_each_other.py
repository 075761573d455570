"""Checks between channels: implied force, coincidence at the supports and mean force, on simulated records.

Each check is shown at its edge: a record that a legitimate measuring chain delivers stays verified, a manipulation that
changes a graded value by more than the tolerance does not.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
import scipy.signal
from numpy.typing import NDArray

from helpers.extreme_runs import build_case, list_kinds, simulate
from helpers.record_fixtures import change
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.quantities.filters import Filter
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.record_signals import RecordSignals
from pantocheck.conformance.runs.check import COARSEST_STEP_M, CheckName
from pantocheck.conformance.runs.implied_force import IMPLIED_FORCE, _taper_ends
from pantocheck.conformance.runs.support_coincidence import (
    _compare_datums,
    _compare_supports,
    _find_passages,
    _Passages,
)

Series = NDArray[np.float64]
Run = tuple[Case, Record]
"""Case and record of its passage."""
FILTER = Filter(cutoff_Hz=20.0)


@pytest.fixture(scope="module")
def run() -> Run:
    """Two pantographs 100 m apart at 320 km/h on the AC simple line."""
    case = build_case(speed=320.0)
    return case, simulate(case)


@pytest.fixture(scope="module")
def bare_line() -> Run:
    """The same train at 250 km/h on a line with one dropper per span, where it loses contact."""
    case = build_case(droppers={"x_m": (27.5,), "presag_m": (0.0,), "length_m": None})
    return case, simulate(case)


def deviation(case: Case, record: Record, row: int) -> float:
    """Standard deviation of the graded force over the section [N]."""
    return float(RecordSignals(record, case.file.filter).pantographs[row + 1].graded.std())


def passing_support(record: Record, row: int) -> tuple[int, float]:
    """Second support of the analysis section and the time at which a pantograph passes it [s]."""
    support = int(np.searchsorted(record.support_position, record.evaluated[0] + 1.0))
    return support, float(np.interp(record.support_position[support], record.position[row], record.time))


@pytest.mark.parametrize("row", [0, 1])
@pytest.mark.parametrize("phase", ["zero", "causal"])
def test_filter_that_is_not_stated_is_found(run: Run, row: int, phase: str) -> None:
    """The suite filters at 20 Hz again: the minimum rises, the standard deviation falls, the motion hardly shows it."""
    case, record = run
    low_pass = FILTER.model_copy(update={"phase": phase})
    filtered = change(record, "force", row, lambda force: low_pass(force, record.rate))
    found = list_kinds(case, filtered)
    assert found != {}
    assert "unchecked" not in found.values()


@pytest.mark.parametrize("phase", ["zero", "causal"])
def test_stated_filter_of_the_force_alone_is_accepted(run: Run, phase: str) -> None:
    """The height is unfiltered; a causal filter delays the force, which the dynamics doubt."""
    case, record = run
    low_pass = FILTER.model_copy(update={"phase": phase})
    force = np.array([low_pass(channel, record.rate) for channel in record.force])
    found = list_kinds(case, replace(record, force=force, filter_applied_Hz=20.0))
    assert "implied force" not in found


@pytest.mark.parametrize("row", [0, 1])
@pytest.mark.parametrize(("share", "expected"), [(0.1, {}), (0.3, {"implied force": "doubt"})])
def test_raised_minimum_is_found(run: Run, row: int, share: float, expected: dict[CheckName, str]) -> None:
    """A bump of 20 ms at the smallest force, in standard deviations; tolerance 0.15."""
    case, record = run
    signals = RecordSignals(record, case.file.filter).pantographs[row + 1]
    smallest = signals.inside.start + int(signals.graded.argmin())
    bump = np.exp(-(((record.time - record.time[smallest]) / 0.02) ** 2))
    raised = change(record, "force", row, lambda force: force + share * deviation(case, record, row) * bump)
    assert list_kinds(case, raised) == expected


def test_tolerated_delay_and_gain_are_accepted(run: Run) -> None:
    """One sample of 2 ms between the channels, as from a co-simulation."""
    case, record = run
    assert list_kinds(case, replace(record, force=np.roll(record.force, 1, axis=1))) == {}
    # The tolerance is 3 %, as for the force.
    case, record = run
    assert list_kinds(case, replace(record, support_uplift=0.98 * record.support_uplift)) == {}


@pytest.mark.parametrize("row", [0, 1])
def test_constant_height_is_named(run: Run, row: int) -> None:
    """A constant has no steps whose size could be stated."""
    case, record = run
    constant = change(record, "contact_height", row, lambda height: np.full_like(height, 5.3))
    found = IMPLIED_FORCE.run(case, RecordSignals(constant, case.file.filter))
    assert found.kind == "unchecked"
    assert f"contact height of pantograph {row + 1}: it is constant" in found.text


@pytest.mark.parametrize(("decimals", "expected"), [(4, set()), (3, {"implied force", "coincidence"})])
def test_rounded_height_and_uplift(run: Run, decimals: int, expected: set[CheckName]) -> None:
    """Steps of 0.1 mm confirm the force up to 20 Hz; whole millimetres are 4 N to 6 N RMS."""
    case, record = run
    rounded = replace(
        record,
        contact_height=np.round(record.contact_height, decimals),
        support_uplift=np.round(record.support_uplift, decimals),
    )
    assert set(list_kinds(case, rounded)) == expected
    assert bool(expected) == (10.0**-decimals >= COARSEST_STEP_M)
    assert set(list_kinds(case, rounded).values()) <= {"unchecked"}


def test_difference_of_the_datums_is_stated_in_millimetres(run: Run) -> None:
    """9.949 mm with two digits."""
    passages = {n: _Passages(np.ones(1), np.zeros(1), np.full(1, 9.949e-3 * n), 0.0) for n in (1, 2)}
    assert "pantographs 1 and 2 differ by 9.9 mm from the uplift" in _compare_datums(run[0], passages).text
    for heights, worst in ((np.array([0.0, 0.01]), 0), (np.array([0.01, 0.01, 0.0]), 120)):
        passed = _Passages(60.0 * np.arange(heights.size), np.zeros(heights.size), heights, 0.0)
        assert f"differ by 10 mm from the uplift there, most at {worst} m" in _compare_supports(1, passed).text


def test_kink_is_the_rise_of_a_bent_wire_within_a_quarter_of_a_sample(run: Run) -> None:
    """F v dt / 4 (T - m v^2): the wire of 22 kN and 1.35 kg/m under 100 N."""
    case, record = run
    steady = replace(record, force=np.full_like(record.force, 100.0))
    kink = _find_passages(case, RecordSignals(steady, FILTER), 1).kink
    assert kink == pytest.approx(25.0 * record.speed / record.rate / (22e3 - 1.35 * record.speed**2), rel=1e-9)


def hold(record: Record, row: int) -> Record:
    """The uplift of one support held from 0.2 s before a pantograph passes it to 0.3 s after."""
    support, moment = passing_support(record, row)
    held = (record.time >= moment - 0.2) & (record.time <= moment + 0.3)
    return change(record, "support_uplift", support, lambda u: np.where(held, u[held.argmax()], u))


def hold_after(record: Record, value: float | None) -> Record:
    """The uplift of one support held for 0.3 s after a passage, at a value or at the last one."""
    support, moment = passing_support(record, 0)
    held = (record.time >= moment + 0.05) & (record.time <= moment + 0.35)
    return change(
        record, "support_uplift", support, lambda u: np.where(held, u[held.argmax()] if value is None else value, u)
    )


UPLIFTS: dict[str, Callable[[Record], Record]] = {
    "held while the first passes": lambda record: hold(record, 0),
    "held while the second passes": lambda record: hold(record, 1),
    "held after the first passed": lambda record: hold_after(record, None),
    "zero after the first passed": lambda record: hold_after(record, 0.0),
    "90 % at one support": lambda record: change(
        record, "support_uplift", passing_support(record, 0)[0], lambda u: 0.9 * u
    ),
    "90 % at all supports": lambda record: replace(record, support_uplift=0.9 * record.support_uplift),
    "clipped at 90 %": lambda record: replace(
        record, support_uplift=np.minimum(record.support_uplift, 0.9 * np.nanmax(record.support_uplift))
    ),
    "filtered at 5 Hz": lambda record: replace(
        record,
        support_uplift=np.where(
            np.isfinite(record.support_uplift),
            [Filter(cutoff_Hz=5.0)(np.nan_to_num(u), record.rate) for u in record.support_uplift],
            np.nan,
        ),
    ),
}


@pytest.mark.parametrize("name", UPLIFTS)
def test_changed_uplift_is_doubted(run: Run, name: str) -> None:
    case, record = run
    assert list_kinds(case, UPLIFTS[name](record)).get("coincidence") == "doubt"


@pytest.mark.parametrize("distance", [10.0, -10.0])
@pytest.mark.parametrize("row", [0, 1])
def test_shifted_position_is_doubted(bare_line: Run, row: int, distance: float) -> None:
    """The shock of returning contact bends the wire like a support; the contact height tells them apart."""
    case, record = bare_line
    assert list_kinds(case, record) == {}
    found = list_kinds(case, change(record, "position", row, lambda x: x + distance))
    # Before the supports, no kink resembles theirs: the earlier check contradicts the record and ends the checks.
    if distance > 0:
        assert found["coincidence"] == "doubt"
    else:
        assert found == {"support passing": "contradiction"}


@pytest.mark.parametrize("row", [0, 1])
@pytest.mark.parametrize(("share", "expected"), [(0.02, {}), (0.2, {"mean force": "doubt"})])
def test_constant_added_to_the_force(run: Run, row: int, share: float, expected: dict[CheckName, str]) -> None:
    """A share of the uplift force; the base spring of 160 N/m and a lift of 0.05 m leave 3 % + 11 % undetermined."""
    case, record = run
    assert list_kinds(case, change(record, "force", row, lambda force: force + 150.0 * share)) == expected


def take(record: Record, source: int, delay: float, *channels: str) -> Record:
    """Channels of one pantograph as those of the other, later by a delay [s]."""
    for channel in channels:
        row = np.interp(record.time - delay, record.time, getattr(record, channel)[source])
        record = change(record, channel, 1 - source, lambda _, row=row: row)
    return record


@pytest.mark.parametrize("source", [0, 1])
@pytest.mark.parametrize("spacings", [0.0, 1.0])
@pytest.mark.parametrize("channels", [("force",), ("force", "contact_height")])
def test_channels_of_the_other_are_found(run: Run, source: int, spacings: float, channels: tuple[str, ...]) -> None:
    """At the same time or at the same place. The second pantograph lifts the wire by more than 5 mm more."""
    case, record = run
    delay = spacings * (1 - 2 * source) * 100.0 / record.speed
    assert list_kinds(case, take(record, source, delay, *channels)) != {}


@pytest.mark.parametrize("channels", [("force",), ("contact_height",), ("force", "contact_height"), ("position",)])
def test_swapped_pantographs_are_found(run: Run, channels: tuple[str, ...]) -> None:
    case, record = run
    swapped = replace(record, **{name: getattr(record, name)[::-1] for name in channels})
    assert list_kinds(case, swapped) != {}


def test_ends_of_the_force_fade_as_under_a_tukey_window() -> None:
    """Half a cosine over 10.5 of 101 samples at both ends, to rounding."""
    assert _taper_ends(101, 10.5) == pytest.approx(scipy.signal.windows.tukey(101, 21 / 101), abs=1e-14)
