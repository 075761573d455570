"""Every check applies to every pantograph: the same fault is found in the first and in the second alone."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from helpers.extreme_runs import list_problems
from helpers.record_fixtures import change
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.quantities.filters import Filter
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.record_signals import RecordSignals

NOISE = Filter(cutoff_Hz=100.0)(np.random.default_rng(1).normal(0.0, 12.0, 20_000), 1000.0)
"""Force between the cut-off of 20 Hz and 100 Hz from a fixed seed [N]."""


FAULTS: dict[str, tuple[str, Callable[[Record, int], Record]]] = {
    "starts inside the section": ("coverage", lambda record, row: change(record, "position", row, lambda x: x + 400.0)),
    "too fast": ("motion", lambda record, row: change(record, "position", row, lambda x: x[0] + 1.01 * (x - x[0]))),
    "too slow": ("motion", lambda record, row: change(record, "position", row, lambda x: x[0] + 0.992 * (x - x[0]))),
    "shifted": ("support passing", lambda record, row: change(record, "position", row, lambda x: x + 10.0)),
    "not filtered": (
        "roll-off",
        lambda record, row: change(
            replace(record, filter_applied_Hz=20.0), "force", row, lambda force: force + NOISE[: force.size]
        ),
    ),
    "gain": ("dynamics", lambda record, row: change(record, "force", row, lambda force: 1.05 * force)),
    "dead height": ("dynamics", lambda record, row: change(record, "contact_height", row, lambda z: 0.0 * z)),
}


def contradictions(case: Case, record: Record) -> dict[str, str]:
    findings = list_problems(case, RecordSignals(record, case.file.filter))
    return {name: finding.text for name, finding in findings.items() if finding.kind == "contradiction"}


def test_doubt_of_the_first_hides_no_contradiction(two_pantograph_case: Case, record: Record) -> None:
    assert list_problems(two_pantograph_case, RecordSignals(record, two_pantograph_case.file.filter)) == {}
    # Noise of the first at which the roll-off is doubted, five times this noise in the second.
    weak = 0.75 / 4.3  # At full noise, the implied content is 4.3 times that below the cut-off; 0.5 to 1 is a doubt.
    stated = replace(record, filter_applied_Hz=20.0)
    doubted = change(stated, "force", 0, lambda force: force + weak * NOISE[: force.size])
    low_pass = two_pantograph_case.file.filter
    assert list_problems(two_pantograph_case, RecordSignals(doubted, low_pass))["roll-off"].kind == "doubt"
    both = change(doubted, "force", 1, lambda force: force + 5 * weak * NOISE[: force.size])
    assert "pantograph 2" in contradictions(two_pantograph_case, both)["roll-off"]


@pytest.mark.parametrize("row", [0, 1])
@pytest.mark.parametrize("fault", FAULTS)
def test_fault_of_one_pantograph_is_found(two_pantograph_case: Case, record: Record, fault: str, row: int) -> None:
    check, damage = FAULTS[fault]
    ((name, text),) = contradictions(two_pantograph_case, damage(record, row)).items()
    assert name == check
    assert f"pantograph {row + 1}" in text
