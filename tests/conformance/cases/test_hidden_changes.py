"""Changes of the damping of a line that its case replaces."""

import pytest

from pantocheck.conformance import InputError, open_case


@pytest.mark.parametrize("key", ["modal", "contact_wire.stiffness_coefficient_s"])
def test_a_change_without_effect_is_refused(key: str) -> None:
    """The case has its own damping of the wires, and modal bands are valid with one fit only."""
    value = [] if key == "modal" else 1e-3
    with pytest.raises(InputError, match=f"line.damping.{key}: has no effect.*\n.*key damping of the case"):
        open_case("vovan2015/mass-drop/printed").with_({f"line.damping.{key}": value})


def test_a_damping_that_the_case_keeps_can_be_changed() -> None:
    case = open_case("vovan2015/mass-drop/printed").with_({"line.damping.stitch_wire.stiffness_coefficient_s": 1e-3})
    assert case.case.line.damping.stitch_wire.stiffness_coefficient_s == 1e-3
