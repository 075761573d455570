"""Variation of a line: tensions, dropper lengths, and their effect on the model and on its derived values."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from helpers.changed_lines import changed_line, changed_tables
from helpers.section_lines import section_line
from helpers.toml_edit import write_toml
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.toml_file import read_model
from pantocheck.conformance.line.catenary_model import build_catenary, build_derived_line
from pantocheck.conformance.line.elements.variation import VARIATION_ELEMENT_M, ListedLengthChanges, Variation
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.model import Catenary, discretise
from pantocheck.model.discretisation.dropper_lengths import compute_unloaded_lengths, hang_on_droppers
from pantocheck.model.discretisation.wire_climate import excess_lengths, fixed_tension

ANCHORED = {"ends": "anchor", "axial_stiffness_EA_N": 12e6, "expansion_coefficient_1_K": 17e-6}


def varied(variation: dict[str, Any], **changes: Any) -> Catenary:
    """Three spans of the line of EN 50318:2002 with a variation."""
    return build_catenary(changed_line({"variation": variation} | changes))


def test_weight_keeps_the_tension_and_a_tolerance_changes_it() -> None:
    """No temperature matters with weights at the ends; the tolerance adds its share."""
    table = {"temperature_change_K": 40.0, "contact_wire": {"tension_change_share": -0.03}}
    catenary = varied(table)
    assert [wire.tension for wire in catenary.wires] == pytest.approx([0.97 * 20e3, 16e3], rel=1e-12)


def test_fixed_wires_follow_the_temperature() -> None:
    """The contact wire loses nearly EA alpha dtheta = 4080 N; the messenger less, because it sags."""
    table = {"temperature_change_K": 20.0, "contact_wire": ANCHORED, "messenger_wire": ANCHORED}
    catenary, nominal = varied(table), build_catenary(changed_line({}))
    excess = excess_lengths(nominal, VARIATION_ELEMENT_M)
    expected = [fixed_tension(w.tension, excess[w.name], 12e6, 20 * 17e-6) for w in nominal.wires]
    assert [wire.tension for wire in catenary.wires] == expected
    assert expected[0] == pytest.approx(20e3 - 4080.0, rel=1e-3)
    assert 16e3 - 4080.0 < expected[1] < 16e3 - 2000.0


def test_droppers_keep_their_lengths_when_the_tension_changes() -> None:
    """A slacker messenger sags, and the contact wire with it: the unloaded lengths are those of the line as built."""
    nominal, catenary = build_catenary(changed_line({})), varied({"messenger_wire": {"tension_change_share": -0.1}})
    lengths = [compute_unloaded_lengths(line, VARIATION_ELEMENT_M) for line in (nominal, catenary)]
    np.testing.assert_allclose(lengths[1], lengths[0], atol=2e-9)
    heights = np.array([dropper.contact_wire_height for dropper in catenary.droppers])
    # Both wires share the weight: of the messenger's sag of 0.6 m a tenth, less the share that the contact wire takes.
    assert -0.1 * 0.6 < heights.min() < -0.01


def test_heights_do_not_depend_on_the_elements() -> None:
    """Elements of 0.5 m and of 0.125 m: the constant in the program states 0.02 mm."""
    nominal = build_catenary(changed_line({}))
    wires = tuple(replace(wire, tension=0.9 * wire.tension) for wire in nominal.wires)
    heights = []
    for element in (VARIATION_ELEMENT_M, 0.125):
        length = compute_unloaded_lengths(nominal, element)
        line = hang_on_droppers(replace(nominal, wires=wires), length, element)
        heights.append([dropper.contact_wire_height for dropper in line.droppers])
    np.testing.assert_allclose(heights[0], heights[1], atol=2e-5)


@pytest.mark.parametrize("number", [1, 2])
def test_listed_length_changes_belong_to_droppers_in_order(number: int) -> None:
    """One longer dropper per span lowers the wire there, on each of its parallel wires."""
    changes = [[0.004 if i == n + 2 else 0.0 for i in range(9)] for n in range(3)]
    catenary = varied(
        {"droppers": {"length_change_m": changes}},
        **({"contact_wire.number": 2, "contact_wire.spacing_m": 0.04} if number == 2 else {}),
    )
    heights = np.array([dropper.contact_wire_height for dropper in catenary.droppers]).reshape(3, 9, number)
    assert [int(np.argmin(span[:, 0])) for span in heights] == [2, 3, 4]
    np.testing.assert_allclose(heights[..., -1], heights[..., 0], atol=1e-9)


def test_listed_length_changes_hold_for_both_sections_of_an_overlap() -> None:
    """The lists belong to the spans of the line; droppers of both sections in an overlap have those of its spans."""
    nominal = section_line(spans=(4, 4))
    spans = [len(schedule.x_m) for schedule in nominal.dropper_schedules]
    changes = tuple(tuple(0.0005 * (n + 1) for _ in range(count)) for n, count in enumerate(spans))
    variation = Variation(droppers=ListedLengthChanges(length_change_m=changes))
    lines = (nominal, nominal.model_copy(update={"variation": variation}))
    lengths = [compute_unloaded_lengths(build_catenary(line), VARIATION_ELEMENT_M) for line in lines]
    positions = np.array([dropper.position for dropper in build_catenary(nominal).droppers])
    expected = 0.0005 * np.searchsorted(nominal.geometry.span_limits, positions)
    np.testing.assert_allclose(lengths[1] - lengths[0], expected, atol=3e-9)


def test_random_length_changes_are_uniform_and_repeatable() -> None:
    """Changes within the tolerance with a mean square of tolerance^2 / 3, to 20 % for 108 droppers (3 sigma)."""
    table = {"droppers": {"tolerance_m": 0.003, "seed": 4}}
    nominal, line = build_catenary(changed_line({}, 12)), changed_line({"variation": table}, 12)
    length = [
        compute_unloaded_lengths(c, VARIATION_ELEMENT_M) for c in (nominal, build_catenary(line), build_catenary(line))
    ]
    change = length[1] - length[0]
    assert np.array_equal(length[1], length[2])
    assert np.abs(change).max() == pytest.approx(0.003, rel=0.1)
    assert np.mean(change**2) == pytest.approx(0.003**2 / 3, rel=0.26)
    other = varied({"droppers": {"tolerance_m": 0.003, "seed": 5}})
    assert other != varied(table)


def test_tolerance_of_zero_is_the_nominal_line() -> None:
    """The first point of a tolerance study, for lengths of droppers and staggers."""
    table = {"droppers": {"tolerance_m": 0.0, "seed": 4}, "supports": {"stagger_tolerance_m": 0.0, "seed": 4}}
    nominal, line = (build_catenary(changed_line(STAGGERED | tables)) for tables in ({}, {"variation": table}))
    assert [wire.stagger for wire in line.wires] == [wire.stagger for wire in nominal.wires]
    lengths = [compute_unloaded_lengths(catenary, VARIATION_ELEMENT_M) for catenary in (nominal, line)]
    np.testing.assert_allclose(lengths[1], lengths[0], atol=2e-9)  # equilibrium of the line at rest


def test_derived_values_state_the_varied_line() -> None:
    """A program receives the varied tension as a stretch, and the heights that the droppers give."""
    tables = {"contact_wire": {"tension_change_share": 0.05}, "droppers": {"tolerance_m": 0.003, "seed": 1}}
    file = changed_line({"variation": tables})
    catenary = build_catenary(file)
    derived = build_derived_line(file, discretise(catenary, 1.0))
    (stretch,) = derived.contact_wire.stretches
    assert (stretch.from_m, stretch.to_m, stretch.tension_N) == (0.0, 180.0, 21e3)
    assert derived.messenger_wire.stretches == ()
    heights = [z for span in derived.droppers.contact_wire_height_m for z in span]
    assert heights == pytest.approx([d.contact_wire_height for d in catenary.droppers], rel=1e-5, abs=1e-9)


@pytest.mark.parametrize(
    ("variation", "message"),
    [
        ({"contact_wire": {"ends": "anchor"}}, "variation.contact_wire.axial_stiffness_EA_N: missing for a wire"),
        ({"droppers": {"length_change_m": [[0.0] * 9] * 2}}, "2 lists with 18 changes for 3 spans with 27 droppers"),
        ({"droppers": {"tolerance_m": 0.003}}, "seed"),
    ],
)
def test_impossible_variations_are_refused(variation: dict[str, Any], message: str, tmp_path: Any) -> None:
    """Each problem names its key and what is needed."""
    write_toml(tmp_path / "line.toml", changed_tables({"variation": variation}))
    with pytest.raises(InputError) as error:
        read_model(tmp_path / "line.toml", LineFile, "line")
    assert message in str(error.value)


STAGGERED = {"geometry.stagger_contact_wire_m": 0.2}


def test_stagger_changes_at_every_support_and_the_droppers_keep_their_lengths() -> None:
    """Changes within the tolerance, at the supports and not at the anchors, with a mean square of tolerance^2 / 3."""
    table = {"supports": {"stagger_tolerance_m": 0.03, "seed": 2}}
    nominal = build_catenary(changed_line(STAGGERED, 20))
    catenary = build_catenary(changed_line(STAGGERED | {"variation": table}, 20))
    before, after = (np.array(line.contact_wires[0].stagger) for line in (nominal, catenary))
    change = (after - before)[:, 1]
    assert np.array_equal(before[:, 0], after[:, 0])
    assert change[0] == change[-1] == 0.0
    assert np.abs(change).max() <= 0.03
    assert np.mean(change[1:-1] ** 2) == pytest.approx(0.03**2 / 3, rel=0.6)  # 19 supports: 3 sigma
    assert [wire.stagger for wire in catenary.wires[1:]] == [wire.stagger for wire in nominal.wires[1:]]
    lengths = [compute_unloaded_lengths(line, VARIATION_ELEMENT_M) for line in (nominal, catenary)]
    np.testing.assert_allclose(lengths[1], lengths[0], atol=2e-9)


def test_stagger_changes_are_the_same_on_both_wires_of_an_overlap() -> None:
    """The tolerance is that of the support, which holds the wires of both sections."""
    nominal = section_line("en50318-2018/ac-simple", spans=(4, 4))
    table = Variation.model_validate({"supports": {"stagger_tolerance_m": 0.03, "seed": 2}})
    line = nominal.model_copy(update={"variation": table})
    changes: dict[float, set[float]] = {}
    for before, after in zip(build_catenary(nominal).contact_wires, build_catenary(line).contact_wires, strict=True):
        plan = list(zip(before.stagger or (), after.stagger or (), strict=True))
        for (x, y), (_, moved) in plan[1:-1]:
            changes.setdefault(x, set()).add(round(moved - y, 9))
        assert all(plan[end][0] == plan[end][1] for end in (0, -1))
    assert all(len(values) == 1 for values in changes.values())
    assert tuple(sorted(changes)) == nominal.geometry.supports


def test_stagger_changes_of_a_line_without_stagger_are_refused() -> None:
    """Its model has no lateral motion."""
    table = {"supports": {"stagger_tolerance_m": 0.03, "seed": 2}}
    with pytest.raises(ValueError, match="varies the stagger of a line without a stagger"):
        changed_line({"variation": table})
