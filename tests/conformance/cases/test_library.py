"""The library: what is in it is what was published, and it is found by id, glob, path or a near miss."""

import pytest

from pantocheck.conformance.cases.library import (
    library_folder,
    list_library,
    load_case,
    overlay_limits,
    read_bibliography,
    read_limits,
    select_cases,
)
from pantocheck.conformance.input_files.input_error import InputError

LIMITS = {  # Wang et al., Table III
    "en50318-2002/250": {
        "mean_force_N": (110, 120),
        "std_force_N": (26, 31),
        "statistical_max_N": (190, 210),
        "statistical_min_N": (20, 40),
        "max_force_N": (175, 210),
        "min_force_N": (50, 75),
        "max_uplift_at_support_mm": (48, 55),
        "contact_loss_pct": (0, 0),
    },
    "en50318-2002/300": {
        "mean_force_N": (110, 120),
        "std_force_N": (32, 40),
        "statistical_max_N": (210, 230),
        "statistical_min_N": (-5, 20),
        "max_force_N": (190, 225),
        "min_force_N": (30, 55),
        "max_uplift_at_support_mm": (55, 65),
        "contact_loss_pct": (0, 0),
    },
}


@pytest.mark.parametrize("name", sorted(LIMITS))
def test_limits_are_the_published_ones_with_their_trust(name):
    (case,) = select_cases([name])
    assert {limit.quantity: (limit.lower, limit.upper) for limit in case.limits} == LIMITS[name]
    assert {limit.trust for limit in case.limits} == {"secondary"}
    assert case.speed == pytest.approx(float(name[-3:]) / 3.6)
    assert case.analysis_section == (240.0, 360.0)


def test_inputs_say_what_is_provisional(case_250):
    provisional = {item.group for item in case_250.inputs if item.trust == "provisional"}
    assert provisional == {
        "case.evaluated_spans",
        "case.filter",
        "line.geometry.encumbrance_m",
        "line.steady_arm.static_share",
        "pantograph 1.uplift_force_N",
        "pantograph 1.chain.uplift_force_on",
        "pantograph 1.chain.base_spring_unstretched",
    }
    notes = " ".join(case_250.notes)
    assert "The other reading, static_share" in notes
    assert 'The other reading, "wire_height"' in notes


def test_every_case_loads_under_the_id_of_its_path_and_its_sources_are_in_the_bibliography():
    for name, path in list_library(library_folder()).items():
        case = load_case(path)
        assert case.id == name
        sources = {key for item in case.inputs for key in item.source}
        sources |= {
            key for limit in case.limits for key in ([limit.source] if isinstance(limit.source, str) else limit.source)
        }
        assert sources <= set(read_bibliography())


def test_globs_ids_and_the_default_find_cases():
    both = ["en50318-2002/250", "en50318-2002/300"]
    assert [case.id for case in select_cases(["en50318-2002/*"])] == both
    assert [case.id for case in select_cases(["en50318-2002/300", "*"])][:2] == both[::-1]
    assert set(both) <= {case.id for case in select_cases([])}
    assert all(case.limits for case in select_cases([]))


@pytest.mark.parametrize("wrong", ["en50318-2002/251", "EN50318-2002/250", "en50318/250", "50318-2002/250"])
def test_unknown_id_gets_the_nearest(wrong):
    with pytest.raises(InputError, match=r"there is no such case(.|\n)*en50318-2002/250"):
        select_cases([wrong])


def test_own_case_by_path_with_files_of_its_own_and_of_the_library(own_case):
    (own,) = select_cases([str(own_case("line.toml", "spans = 10", "spans = 12"))])
    assert own.line.geometry.spans == 12
    path = own_case("250.toml", 'line = "line.toml"', 'line = "en50318-2002/line.toml"')
    assert load_case(path).line.geometry.spans == 10


def test_two_files_with_one_id_are_refused(own_case):
    changed = str(own_case("250.toml", "order = 6", "order = 4"))
    assert len(select_cases([changed, changed])) == 1
    with pytest.raises(InputError, match="two different files have this id"):
        select_cases([changed, "en50318-2002/250"])


def test_required_cases_come_first(own_case, monkeypatch):
    path = own_case("250.toml", 'line = "line', 'requires = ["en50318-2002/300"]\nline = "line')
    assert [case.id for case in select_cases([str(path)])] == ["en50318-2002/300", "en50318-2002/250"]
    path = own_case("250.toml", 'line = "line', 'requires = ["en50318-2002/static"]\nline = "line')
    with pytest.raises(InputError, match=r"key requires: there is no case 'en50318-2002/static'"):
        select_cases([str(path)])


def test_circular_requirement_is_refused(own_case, monkeypatch):
    path = own_case("250.toml", 'line = "line', 'requires = ["en50318-2002/250"]\nline = "line')
    monkeypatch.setattr("pantocheck.conformance.cases.library.list_library", lambda folder: {"en50318-2002/250": path})
    with pytest.raises(InputError, match="requires itself"):
        select_cases(["en50318-2002/250"])


def test_digest_follows_numbers_and_nothing_else(case_250, own_case):
    assert load_case(own_case("250.toml", "title = ", "title = 'other'  #")).digest == case_250.digest
    assert load_case(own_case("250.toml", "upper = 31.0", "upper = 32.0")).digest == case_250.digest
    assert load_case(own_case("line.toml", "vsd2022", "elsewhere")).digest == case_250.digest
    assert load_case(own_case("line.toml", "20e3", "20.001e3")).digest != case_250.digest
    assert load_case(own_case("pantograph.toml", "7.2", "7.3")).digest != case_250.digest


def test_twin_pantographs_start_and_end_on_the_line(own_case):
    path = own_case("250.toml", "[[pantograph]]", "XX")
    text = path.read_text()
    table = text[text.index("XX") : text.index("[filter]")].replace("XX", "[[pantograph]]")
    text = text.replace("XX", "[[pantograph]]").replace("[filter]", table + "[filter]")
    path.write_text(text.replace("speed_km_h", "spacing_m = [150.0]\nspeed_km_h"))
    case = load_case(path)
    assert case.offsets == (0.0, 150.0)
    assert (case.start, case.end) == (60.0, 420.0)
    path.write_text(path.read_text().replace("[150.0]", "[250.0]"))
    with pytest.raises(InputError, match=r"key run_out_m: the first pantograph would run to 610 m on a line of 600 m"):
        load_case(path)
    path.write_text(path.read_text().replace("spacing_m = [250.0]", ""))
    with pytest.raises(InputError, match="0 distances for 2 pantographs"):
        load_case(path)


def test_own_limits_replace_and_add(tmp_path, case_250):
    path = tmp_path / "limits.toml"
    entry = '[[limit]]\ncase = "*/250"\nquantity = "{}"\nupper = {}\ntrust = "primary"\nsource = "my copy"\n'
    path.write_text(entry.format("std_force_N", 30.0) + entry.format("rms_20_50_N", 9.0))
    (case,) = overlay_limits([case_250], read_limits(path))
    limits = {limit.quantity: limit for limit in case.limits}
    assert len(limits) == 9
    assert (limits["std_force_N"].lower, limits["std_force_N"].upper) == (None, 30.0)
    assert limits["std_force_N"].source == "my copy"
    path.write_text(entry.format("std_force_N", 30.0).replace("*/250", "*/251"))
    with pytest.raises(InputError, match=r"no case of this run matches '\*/251'"):
        overlay_limits([case_250], read_limits(path))
