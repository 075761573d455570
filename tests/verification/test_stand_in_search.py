"""Search of the stand-in: repeated, it writes the damping file of the library."""

import numpy as np
import pytest

from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.line.library_folder import library_folder
from verification.tables import stand_in_search


@pytest.fixture(scope="module")
def line() -> stand_in_search.GroupedLine:
    (case,) = select_cases([stand_in_search.CASE])
    return stand_in_search.group_line(case)


@pytest.mark.thorough
def test_search_is_repeatable_without_findings_that_are_held_out(line: stand_in_search.GroupedLine) -> None:
    """All candidates of all rounds, about 3 s: nothing else shows that no number was chosen by hand."""
    (case,) = select_cases([stand_in_search.CASE])
    limits = stand_in_search.select_imposed(case)
    chosen, agreeing = stand_in_search.search(line, limits)
    ratio = stand_in_search.damping_of_groups(chosen, line.frequency)
    written = stand_in_search.write_damping(ratio, line)
    assert written == (library_folder() / "vovan2015" / "damping" / "stand-in.toml").read_text(encoding="utf-8")
    margins = stand_in_search.grade_damping(ratio, line, limits)
    others = [
        stand_in_search.grade_damping(stand_in_search.damping_of_groups(p, line.frequency), line, limits)
        for p in agreeing
    ]
    assert min(margins) > max(map(min, others))
    assert {limit.finding.role for limit in limits} == {"imposed"}
    assert len(limits) == 7


def test_damping_of_groups_by_hand(line: stand_in_search.GroupedLine) -> None:
    """0.2 %, 90 % of it, 80 % of that, and then proportional to the root of the frequency."""
    ratio = stand_in_search.damping_of_groups(np.array([np.log10(0.002), 0.9, 0.8, 0.5]), line.frequency)
    assert ratio[:3] == pytest.approx([0.002, 0.0018, 0.00144], abs=5e-6)
    assert ratio[5] == pytest.approx(0.00144 * np.sqrt(line.frequency[5] / line.frequency[2]), abs=5e-6)
    assert line.frequency[:3] == pytest.approx([0.87, 1.75, 2.63], abs=0.02)
