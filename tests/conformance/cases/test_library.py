"""Library: published numbers, and selection of cases by id, glob and path."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from helpers.case_fixtures import EditedCase
from helpers.toml_edit import write_toml
from pantocheck.conformance.campaigns.campaign_preparation import PreparedCampaign, find_campaign_file, read_campaign
from pantocheck.conformance.cases import catalogue
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.catalogue import Catalogue
from pantocheck.conformance.cases.library import (
    list_library,
    load_case,
    overlay_limits,
    read_bibliography,
    read_limits,
    select_cases,
)
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.execution.plan import Plan, prepare_plan
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.records.record_signals import evaluate_record
from pantocheck.conformance.runs.reference_simulator import ReferenceSimulator

NAMES = ["mean_force_N", "std_force_N", "statistical_max_N", "statistical_min_N", "max_force_N", "min_force_N"]
LIMITS = {  # Wang et al., Table III; the last ones are those of max_uplift_at_support_mm and contact_loss_pct
    "en50318-2002/250": ((110, 120), (26, 31), (190, 210), (20, 40), (175, 210), (50, 75), (48, 55), (0, 0)),
    "en50318-2002/300": ((110, 120), (32, 40), (210, 230), (-5, 20), (190, 225), (30, 55), (55, 65), (0, 0)),
}


@pytest.mark.parametrize("name", sorted(LIMITS))
def test_limits_are_the_published_ones_with_their_trust(name: str) -> None:
    (case,) = select_cases([name])
    names = (*NAMES, "max_uplift_at_support_mm", "contact_loss_pct")
    expected = dict(zip(names, LIMITS[name], strict=True))
    assert {limit.quantity: (limit.lower, limit.upper) for limit in case.limits} == expected
    assert {limit.trust for limit in case.limits} == {"secondary"}
    assert case.speed == pytest.approx(float(name[-3:]) / 3.6)
    assert case.analysis_section == (240.0, 360.0)


def test_inputs_name_provisional_keys(case_250: Case) -> None:
    provisional = {item.group for item in case_250.inputs if item.trust == "provisional"}
    uplift = {
        f"pantograph 1.{key}" for key in ("uplift_force_N", "chain.uplift_force_on", "chain.base_spring_unstretched")
    }
    line = {"line.geometry.encumbrance_m", "line.steady_arm.static_share"}
    assert provisional == {"case.evaluated_spans", "case.filter", "pantograph 1.uplift_force_N"} | line | uplift
    notes = " ".join(case_250.notes)
    assert "The other reading, static_share" in notes
    assert 'The other reading, "wire_height"' in notes


def test_every_case_loads_under_the_id_of_its_path_and_its_sources_are_in_the_bibliography() -> None:
    for name, path in list_library(library_folder()).items():
        case = load_case(path)
        assert case.id == name
        sources = {key for item in case.inputs for key in item.source}
        stated = [limit.source for limit in case.limits]
        sources |= {key for source in stated for key in ([source] if isinstance(source, str) else source)}
        assert sources <= set(read_bibliography())


def test_globs_ids_and_the_default_find_cases() -> None:
    both = ["en50318-2002/250", "en50318-2002/300"]
    assert [case.id for case in select_cases(["en50318-2002/*"])] == both
    assert [case.id for case in select_cases(["en50318-2002/300", "*"])][:2] == both[::-1]
    assert set(both) <= {case.id for case in prepare_plan(Plan()).cases}
    assert all(case.limits for case in prepare_plan(Plan()).cases)


@pytest.mark.parametrize("wrong", ["en50318-2002/251", "EN50318-2002/250", "en50318/250", "50318-2002/250"])
def test_message_names_the_nearest_ids(wrong: str) -> None:
    with pytest.raises(InputError, match=r"there is no case with this id(.|\n)*en50318-2002/250"):
        select_cases([wrong])


def test_files_of_a_case_and_required_cases_are_found(edited_case: EditedCase) -> None:
    (case,) = select_cases([str(edited_case("line.toml", {"geometry.spans": 12}))])
    assert case.line.geometry.spans == 12
    path = edited_case("250.toml", {"line": "en50318-2002/line.toml"})
    assert load_case(path).line.geometry.spans == 10
    path = edited_case("250.toml", {"requires": ["en50318-2002/300"]})
    assert [case.id for case in select_cases([str(path)])] == ["en50318-2002/300", "en50318-2002/250"]
    path = edited_case("250.toml", {"requires": ["en50318-2002/static"]})
    with pytest.raises(InputError, match=r"key requires: there is no case 'en50318-2002/static'"):
        select_cases([str(path)])


def test_circles_and_doubles_are_refused(edited_case: EditedCase, monkeypatch: pytest.MonkeyPatch) -> None:
    changed = str(edited_case("250.toml", {"filter.order": 4}))
    assert len(select_cases([changed, changed])) == 1
    with pytest.raises(InputError, match="two different files have this id"):
        select_cases([changed, "en50318-2002/250"])
    path = edited_case("250.toml", {"requires": ["en50318-2002/250"]})
    monkeypatch.setattr(catalogue, "list_library", lambda _: {"en50318-2002/250": path})
    with pytest.raises(InputError, match="requires itself"):
        select_cases(["en50318-2002/250"], (), Catalogue())  # another catalogue than the cached one


@pytest.mark.parametrize(
    ("file", "changes", "same"),
    [
        ("250.toml", {"title": "another title"}, True),
        ("250.toml", {"limit.1.upper": 32.0}, True),
        ("line.toml", {"contact_wire.source": "another source"}, True),
        ("250.toml", {"filter.cutoff_Hz": 20.1}, False),
        ("line.toml", {"contact_wire.tension_N": 20.001e3}, False),
        ("line.toml", {"contact_wire.mass_kg_m": 1.36}, False),
        ("line.toml", {"droppers.mass_kg": 0.1}, False),
        ("pantograph.toml", {"chain.masses_kg": [15.0, 7.3]}, False),
    ],
)
def test_digest_depends_on_numbers_only(
    case_250: Case, edited_case: EditedCase, file: str, changes: dict[str, Any], same: bool
) -> None:
    assert (load_case(edited_case(file, changes)).digest == case_250.digest) is same


def test_two_pantographs_start_and_end_on_the_line(two_pantograph_case: Case, edited_case: EditedCase) -> None:
    file = two_pantograph_case.file
    assert two_pantograph_case.offsets == (0.0, 150.0)
    assert (two_pantograph_case.start, two_pantograph_case.end) == (60.0, 420.0)
    pantographs = [use.model_dump(mode="json", exclude_none=True) for use in file.pantograph]
    path = edited_case("250.toml", {"spacing_m": [250.0], "pantograph": pantographs})
    with pytest.raises(InputError, match=r"run_out_m: the first pantograph would run to 610 m, but the line is 600 m"):
        load_case(path)
    path = edited_case("250.toml", {"pantograph": pantographs})
    with pytest.raises(InputError, match="0 distances for 2 pantographs"):
        load_case(path)


def test_limits_of_a_user_replace_and_add_in_the_named_cases(tmp_path: Path, case_250: Case) -> None:
    path = tmp_path / "limits.toml"
    entry = {"case": "*/250", "trust": "primary", "source": "my copy"}
    deviation, band = ({"quantity": "std_force_N", "upper": 30.0}, {"quantity": "rms_20_50_N", "upper": 9.0})
    write_toml(path, {"limit": [entry | deviation, entry | band]})
    (case,) = overlay_limits([case_250], read_limits(path))
    limits = {limit.quantity: limit for limit in case.limits}
    assert len(limits) == 9
    assert (limits["std_force_N"].lower, limits["std_force_N"].upper) == (None, 30.0)
    assert (limits["std_force_N"].trust, limits["std_force_N"].source) == ("own", ["own limit", "my copy"])
    write_toml(path, {"limit": [entry | deviation | {"case": "*/251"}]})
    with pytest.raises(InputError, match=r"no case of this run matches '\*/251'"):
        overlay_limits([case_250], read_limits(path))
    path = tmp_path / "limits.toml"
    path.write_text(
        '[[limit]]\ncase = "*/250"\nquantity = "std_force_N"\nupper = 99.0\ntrust = "primary"\nsource = "my copy"\n'
    )
    cases = overlay_limits(select_cases(["en50318-2002/*"]), read_limits(path))
    upper = {case.id: limit.upper for case in cases for limit in case.limits if limit.quantity == "std_force_N"}
    assert upper == {"en50318-2002/250": 99.0, "en50318-2002/300": 40.0}


@pytest.mark.parametrize(
    ("pantograph", "message"), [(1, "std_force_N already has a limit"), (2, "there is no pantograph 2")]
)
def test_limit_given_twice_or_for_a_missing_pantograph_is_refused(
    edited_case: EditedCase, pantograph: int, message: str
) -> None:
    limit = {"quantity": "std_force_N", "trust": "primary", "source": "own"}
    limits = [{**limit, "pantograph": 1, "upper": 31.0}, {**limit, "pantograph": pantograph, "upper": 99.0}]
    with pytest.raises(InputError, match=message):
        load_case(edited_case("250.toml", {"limit": limits}))


# Campaigns of the library: their runs, the sources of their variations, and the spacings of a regulation.
RUNS = {
    "ac-simple-damping": 12,
    "ac-simple-damping-uncertainty": 64,
    "ac-simple-irregularity": 48,
    "ac-simple-spacing": 133,
    "ac-simple-speed": 32,
    "ac-simple-tolerances": 128,
    "ac-simple-tsi-spacing": 17,
}


def read(name: str) -> PreparedCampaign:
    return read_campaign(find_campaign_file(f"campaigns/{name}"))


def test_all_campaigns_of_the_library_are_tested() -> None:
    assert sorted(path.stem for path in (library_folder() / "campaigns").glob("*.toml")) == sorted(RUNS)


@pytest.mark.parametrize(("name", "runs"), RUNS.items())
def test_campaign_of_the_library_is_valid_and_states_its_sources(name: str, runs: int) -> None:
    """Reading it also reads the cases of its first designs."""
    prepared = read(name)
    assert prepared.design.count_runs() == runs
    sampling = prepared.file.sampling
    for table in (*prepared.file.vary, *(() if sampling is None else sampling.input)):
        assert {"trust", "source"} <= table.model_fields_set
        sources = [table.source] if isinstance(table.source, str) else table.source
        assert set(sources) <= set(read_bibliography())


def test_designs_of_campaigns_follow_the_regulation_or_differ_in_their_seeds() -> None:
    """TSI ENE table 4.2.13, column B, as another document prints it: the trust is that of a secondary source."""
    prepared = read("ac-simple-tsi-spacing")
    assert prepared.file.vary[0].trust == "secondary"
    for run in prepared.design.list_runs():
        speed, spacing = run.inputs["speed_km_h"], run.inputs["spacing_m"]
        assert spacing == (200 if speed >= 250 else 85 if speed > 120 else 15 if speed > 80 else 8)
    # Seeds are whole numbers; 128 of them from 2^31 numbers are equal with a probability of 4e-6.
    keys = ("line.variation.droppers.seed", "line.variation.supports.seed")
    for key in keys:
        seeds = [run.inputs[key] for run in read("ac-simple-tolerances").design.list_runs()]
        assert all(isinstance(seed, int) for seed in seeds)
        assert len(set(seeds)) == 128


# Open points of the sources of the 2002 model: results in its notes for the other readings.
def values(case: Case) -> dict:
    record = ReferenceSimulator().run_unrefined(case).record
    return evaluate_record(record, case.file.filter).values[1]


@pytest.mark.parametrize(("speed", "deviation", "mean"), [(250, 32.9, 116.5), (300, 38.2, 115.7)])
def test_other_readings_have_the_values_of_the_notes(speed: int, deviation: float, mean: float) -> None:
    """Printed to a tenth in the notes; the first is above the limit of 31 N at 250 km/h."""
    # An arm without a static share, and a base spring that is unstretched at the wire and carries part of the force.
    (case,) = select_cases([f"en50318-2002/{speed}"])
    arm = case.line.steady_arm.model_copy(update={"static_share": "none"})
    found = values(replace(case, line=case.line.model_copy(update={"steady_arm": arm})))
    assert found["std_force_N"] == pytest.approx(deviation, abs=0.06)
    (pantograph,) = case.pantographs
    chain = pantograph.chain.model_copy(update={"base_spring_unstretched": "wire_height"})
    found = values(replace(case, pantographs=(pantograph.model_copy(update={"chain": chain}),)))
    assert found["mean_force_N"] == pytest.approx(mean, abs=0.06)
