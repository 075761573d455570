"""Cases on one line share its discretised line; a line with other content, or on another mesh, is another one."""

from pathlib import Path

from helpers.case_fixtures import EditedCase
from pantocheck.conformance.cases.library import load_case, select_cases
from pantocheck.conformance.line.line_discretisation import discretise_line


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
