"""Catenary of a case: weight of the droppers, and lateral positions of parallel wires."""

from pathlib import Path

import pytest

from helpers.case_fixtures import EditedCase
from pantocheck.conformance.cases.library import load_case, select_cases
from pantocheck.conformance.line.catenary_model import build_catenary, discretise_line
from pantocheck.conformance.line.elements.dropper import COARSE
from pantocheck.model import Kind, discretise


def test_dropper_masses_belong_to_the_lengths_of_the_loaded_line() -> None:
    """A dropper of 0.117 kg/m has the mass of its length on the line that carries this mass.

    The lengths of the line with droppers without mass are 4 mm wrong. Those of the masses are accurate to 0.1 mm.
    """
    line = select_cases(["en50318-2018/ac-simple/static"])[0].line
    line = line.model_copy(update={"geometry": line.geometry.shorten(3)})
    catenary = build_catenary(line)
    lengths = discretise(catenary, COARSE).state.dropper_length
    errors = [abs(d.mass / 0.117 - length) for d, length in zip(catenary.droppers, lengths, strict=True)]
    assert max(errors) < 1e-4


@pytest.mark.parametrize(("number", "offsets"), [(1, [0.0]), (2, [-0.02, 0.02])])
def test_parallel_contact_wires_lie_on_either_side_of_the_stagger(number: int, offsets: list[float]) -> None:
    """The stagger changes its side at every support; the offset of a wire, half the spacing, does not."""
    line = select_cases(["en50318-2018/ac-simple/static"])[0].line
    geometry = line.geometry.shorten(3).model_copy(update={"stagger_contact_wire_m": 0.2})
    wires = line.contact_wire.model_copy(update={"number": number, "spacing_m": 0.04})
    catenary = build_catenary(line.model_copy(update={"geometry": geometry, "contact_wire": wires}))
    contact = [wire for wire in catenary.wires if wire.kind is Kind.CONTACT_WIRE]
    for wire, offset in zip(contact, offsets, strict=True):
        assert wire.stagger is not None
        assert [x for x, _ in wire.stagger] == list(geometry.span_limits)
        assert [y - offset for _, y in wire.stagger] == pytest.approx([0.2, -0.2, 0.2, -0.2])


def test_supports_fixed_along_the_track_hold_every_messenger_wire() -> None:
    """Two messenger wires over three spans have three stretches each; the axial stiffness is that of one wire."""
    line = select_cases(["en50318-2018/ac-simple/static"])[0].line
    wires = {"number": 2, "spacing_m": 0.04}
    messenger = line.messenger_wire.model_copy(update=wires | {"axial_stiffness_EA_N": 13.8e6})
    tables = {
        "geometry": line.geometry.shorten(3),
        "contact_wire": line.contact_wire.model_copy(update=wires),
        "messenger_wire": messenger,
    }
    stretches = []
    for along_track in ("free", "fixed"):
        support = line.messenger_support.model_copy(update={"along_track": along_track})
        changed = line.model_copy(update=tables | {"messenger_support": support})
        stretches.append(discretise(build_catenary(changed), COARSE).stretches.stiffness)
    assert stretches[0].size == 0
    assert stretches[1] == pytest.approx([13.8e6 / line.geometry.span_m] * 6)


# Cases on one line share its discretised line; a line with other content, or on another mesh, is another one.
def test_cases_on_one_line_share_it() -> None:
    first, second = select_cases(["en50318-2002/250", "en50318-2002/300"])
    assert first.line is not second.line
    line = discretise_line(first.line, 5.0)
    assert discretise_line(second.line, 5.0) is line
    assert discretise_line(first.line, 4.0) is not line


def test_changed_line_is_discretised_anew(edited_case: EditedCase) -> None:
    case = load_case(Path(edited_case("250.toml", {})))
    heavier = case.line.model_copy(
        update={"contact_wire": case.line.contact_wire.model_copy(update={"mass_kg_m": 1.5})}
    )
    line, other = (discretise_line(file, 5.0) for file in (case.line, heavier))
    assert other.beams.mass_per_length.max() > line.beams.mass_per_length.max()
