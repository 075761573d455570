"""Influence of the start: what separated a third code from the reference simulator, and where it ends."""

from pantocheck.model import discretise
from verification.formulations.start_influence import ELEMENT, SPANS, build_line, compare_starts


def test_two_starts_of_one_kernel_differ_behind_a_short_run_in_and_not_behind_a_long_one() -> None:
    """A run-in of 1.5 spans leaves 5 N of difference, one of eight spans less than a quarter of it."""
    line = discretise(build_line(SPANS, 0.0), 2 * ELEMENT)
    near, far = compare_starts(line, 480.0), compare_starts(line, 115.0)
    assert near[2] > 4.0
    assert far[2] < near[2] / 4
    assert abs(near[1]) > 0.5
