"""Cases from dictionaries, and lines and pantographs from their files."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pantocheck.conformance import InputError, build_case, open_case, open_line, open_pantograph

LINE = "en50318-2002/line.toml"
PANTOGRAPH = "en50318-2002/pantograph.toml"


def test_case_built_of_the_parts_of_a_library_case_has_its_digest(tmp_path: Path) -> None:
    """The digest covers everything that a system computes with."""
    library = open_case("en50318-2002/250")
    keys = {
        key: value
        for key, value in library.inputs["case"].items()
        if key not in ("id", "title", "line", "pantograph", "limit", "edition", "superseded_by", "source", "trust")
    }
    case = build_case(tmp_path, LINE, [PANTOGRAPH], **keys, uplift_force_N=120.0)
    assert case.id == f"own/{tmp_path.name}"
    assert case.case.digest == library.with_({"pantograph.uplift_force_N": 120.0}).case.digest


def test_parts_given_as_dictionaries_are_written(tmp_path: Path) -> None:
    """Two pantographs: one of the library, and a chain of one mass."""
    own = {"chain": {"masses_kg": [10.0], "stiffness_N_m": [4000.0], "damping_N_s_m": [0.0]}, "title": "Own"}
    line = open_case("en50318-2002/250").inputs["line"] | {"title": "Own line"}
    pantographs = [PANTOGRAPH, own | {"contact": {"stiffness_N_m": 50e3}}]
    keys: dict[str, Any] = {"speed_km_h": 200, "evaluated_spans": [5, 6], "spacing_m": [60], "uplift_force_N": 110.0}
    case = build_case(tmp_path / "new" / "case", line, pantographs, **keys)
    written = sorted(path.name for path in (tmp_path / "new" / "case").iterdir())
    assert written == ["case.toml", "line.toml", "pantograph-2.toml"]
    assert [pantograph.title for pantograph in case.case.pantographs][1] == "Own"
    assert case.case.line.title == "Own line"
    # One mass on a spring: f = sqrt(k / m) / 2 pi = 3.1831 Hz; its apparent mass at f0 / 2 is m (1 - 4) = -3 m.
    pantograph = open_pantograph(tmp_path / "new" / "case" / "pantograph-2.toml")
    assert pantograph.frequencies_Hz == pytest.approx([3.18310], rel=1e-5)
    assert pantograph.apparent_mass_kg(3.18310 / 2) == pytest.approx([-30.0], rel=1e-4)


def test_line_and_pantograph_of_a_file_are_those_of_its_cases() -> None:
    line, same = open_line(LINE), open_case("en50318-2002/250").line
    assert line.file == same.file
    assert np.array_equal(line.span_limits, same.span_limits)
    pantograph = open_pantograph(PANTOGRAPH)
    frequency_Hz = np.array([1.0, 5.0])
    (curve,) = pantograph.plot(frequency_Hz).lines
    assert curve.get_ydata() == pytest.approx(np.abs(pantograph.apparent_mass_kg(frequency_Hz)))
    (whole,) = pantograph.plot().lines
    assert whole.get_xdata()[[0, -1]] == pytest.approx([0.5, 50.0])
    assert pantograph.model.force == pytest.approx([0.0, 0.0])  # no uplift force


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (lambda folder: open_line("none.toml"), "there is no file 'none.toml'"),
        (lambda folder: open_line(LINE, element_m=0.0), "found 0 m"),
        (lambda folder: open_pantograph(LINE), "unknown key"),
        (lambda folder: open_pantograph(PANTOGRAPH).apparent_mass_kg([0.0]), "found 0 Hz"),
        (lambda folder: build_case(folder, LINE, [PANTOGRAPH], uplift_force_N=1.0, speed=3), "did you mean speed_km_h"),
        (lambda folder: build_case(folder, {"title": None}, []), "Give text, numbers"),
    ],
)
def test_wrong_parts_are_named(tmp_path: Path, build: Any, message: str) -> None:
    with pytest.raises(InputError, match=message):
        build(tmp_path)
