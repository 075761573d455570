"""Saved settings: cases and campaigns that the other commands accept, and that replace nothing."""

import os
from pathlib import Path

import pytest

from pantocheck.conformance.app.commands.explore_command import open_explorer
from pantocheck.conformance.app.explorer.explored_case import ExploredCase
from pantocheck.conformance.app.explorer.saved_settings import save_campaign, save_case
from pantocheck.conformance.campaigns.campaign_preparation import read_campaign
from pantocheck.conformance.cases.library import load_case, select_cases
from pantocheck.conformance.core.input_error import InputError

TRAINS = [case.id for case in select_cases(["*/*"]) if not case.is_static]


def explore(name: str, *changed: str) -> ExploredCase:
    return open_explorer(name, changed, (), None)[0]


@pytest.mark.parametrize("name", TRAINS)
def test_saved_case_has_the_inputs_of_its_setting(name: str, tmp_path: Path) -> None:
    """The digest covers everything that a system computes with; a study and a second reading are not saved."""
    explored = explore(name)
    values = {slider.id: slider.high for slider in explored.sliders[1:3]}
    path = save_case(explored, values, tmp_path / "out", "saved")
    saved, changed = load_case(path), explored.change(values)[0].without_study()
    assert saved.id == "own/saved"
    assert saved.line.damping.model_dump(exclude={"trust", "source", "note", "provisional"}) == (
        changed.line.damping.model_dump(exclude={"trust", "source", "note", "provisional"})
    )
    assert saved.digest == changed.digest
    assert not saved.limits
    assert {group.trust for group in saved.inputs} == {"provisional"}  # a changed copy has no published origin
    assert sorted(file.name for file in (tmp_path / "out").iterdir()) == ["saved"]


def test_saved_case_of_a_user_keeps_his_limits(tmp_path: Path) -> None:
    """Two generations: limits of a library case are left out, those that a user adds to his copy stay his own."""
    first = save_case(explore("en50318-2002/250"), {}, tmp_path, "first")
    first.write_text(first.read_text() + '\n[[limit]]\nquantity = "std_force_N"\nupper = 25.0\n')
    second = save_case(explore(str(first)), {"speed_km_h": 260.0}, tmp_path, "second")
    (limit,) = load_case(second).limits
    assert (limit.quantity, limit.upper, limit.trust) == ("std_force_N", 25.0, "own")
    campaign = read_campaign(save_campaign(explore(str(first)), {}, tmp_path, "own", ("speed_km_h", (200.0, 300.0, 2))))
    assert campaign.file.cases == (str(first.resolve()),)


def test_nothing_is_replaced(tmp_path: Path) -> None:
    explored = explore("en50318-2002/250")
    (tmp_path / "taken").mkdir()
    (tmp_path / "kept.toml").write_text("kept")
    os.symlink(tmp_path / "nowhere.toml", tmp_path / "link.toml")
    with pytest.raises(InputError, match="exists already"):
        save_case(explored, {}, tmp_path, "taken")
    for name in ("kept", "link"):
        with pytest.raises(InputError, match="exists already"):
            save_campaign(explored, {}, tmp_path, name, ("speed_km_h", (200.0, 300.0, 3)))
    for name in ("", "..", "a/b", ".hidden", "x" * 61, "a\n"):
        with pytest.raises(InputError, match="cannot be used"):
            save_case(explored, {}, tmp_path, name)
    assert (tmp_path / "kept.toml").read_text() == "kept"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["kept.toml", "link.toml", "taken"]


def test_campaign_varies_one_slider_at_a_setting(tmp_path: Path) -> None:
    """Three factors of the damping, each for all its coefficients together; a standing speed stays, unless varied."""
    explored = explore("en50318-2002/250", "speed_km_h=270")
    (damping,) = [slider.id for slider in explored.sliders if slider.is_factor]
    path = save_campaign(explored, {damping: 3.0}, tmp_path, "damping", (damping, (1.0, 2.0, 3)))
    prepared = read_campaign(path)
    assert prepared.file.set == ("speed_km_h=270",)
    assert prepared.design.count_runs() == 3
    path = save_campaign(explored, {damping: 3.0}, tmp_path, "speed", ("speed_km_h", (200.0, 300.0, 3)))
    prepared = read_campaign(path)
    assert [text.partition("=")[0] for text in prepared.file.set] == [*explored.sliders[4].keys]
    assert prepared.file.vary[0].columns == {"speed_km_h": (200.0, 250.0, 300.0)}  # type: ignore[union-attr]


@pytest.mark.parametrize(
    ("varied", "message"),
    [
        (("speed_km_h", (1.0, 300.0, 3)), "outside of its range"),
        (("speed_km_h", (200.0, 300.0, 1)), "Give 2 to 1000"),
        (("speed", (200.0, 300.0, 3)), "not on this page"),
    ],
)
def test_wrong_ranges_leave_no_file(varied: tuple[str, tuple[float, ...]], message: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=message):
        save_campaign(explore("en50318-2002/250"), {}, tmp_path / "out", "new", varied)
    assert not (tmp_path / "out").exists()
