"""Public interface for mass drops: records, identified modes and fitted damping."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from helpers.computed_modes import ELEMENT, computed_modes
from helpers.exact_decays import build_exact_decay, build_exact_fit
from pantocheck.conformance import (
    FittedDamping,
    IdentifiedLines,
    IdentifiedRecords,
    InputError,
    OpenedDrop,
    open_case,
    open_drop,
    open_modes,
)
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.drops.drop_record import DropChannel, DropDescription, DropRecord
from pantocheck.conformance.drops.identification_analysis import analyse_identification
from pantocheck.conformance.drops.identify import Identification
from pantocheck.conformance.drops.line_fit import build_modes
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.results.identified_modes import MeasuredLine

CASE = open_case("vovan2015/mass-drop/printed").with_({"line.geometry.spans": 5})


@pytest.fixture
def drop() -> OpenedDrop:
    """Drop with two sensors and a decay of one second."""
    signals = np.outer(np.exp(-np.arange(100) / 50), (1.0, -2.0))
    channels = tuple(DropChannel(f"S{i}z", i, "z", "CW", 10.0 * i) for i in (1, 2))
    drop, line = (
        DropDescription(40.0, "CW", 30.0, 0.1),
        MeasuredLine(spans_m=(63.0,), contact_wire_tension_N=20e3, messenger_wire_tension_N=14e3),
    )
    return OpenedDrop(DropRecord("test drop", "test", 100.0, signals, channels, drop=drop, line=line))


@pytest.fixture(scope="module")
def fit() -> FittedDamping:
    """Fit to the computed modes of the line, which have no error."""
    return IdentifiedLines(tuple(computed_modes(build_catenary(CASE.case.line), 5, 4.0))).fit_damping(CASE, ELEMENT)


@pytest.mark.parametrize("suffix", [".csv", ".h5", ".uff"])
def test_a_written_drop_is_read_again(drop: OpenedDrop, tmp_path: Path, suffix: str) -> None:
    again = open_drop(drop.write(tmp_path / f"drop{suffix}"))
    assert again.channels == drop.channels
    # nine digits in a CSV file
    np.testing.assert_allclose(again.signals()["S2z"], drop.record.signals[:, 1], rtol=1e-8)
    np.testing.assert_allclose(again.signals()["time_s"], np.arange(100) / 100, atol=1e-12)


def test_wrong_run_format_drop_or_line_is_named(drop: OpenedDrop, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="there is no run 2"):
        open_drop(drop.write(tmp_path / "drop.csv"), run=2)
    with pytest.raises(InputError, match=r"\.xls.*\n.*\.uff, \.csv, \.h5"):
        drop.write(tmp_path / "drop.xls")
    for number in (0, 4):
        with pytest.raises(InputError, match=f"has 3 mass drops, not drop {number}"):
            CASE.simulate_drop(number)
    with pytest.raises(InputError, match=r"Choose a case with a \[mass_drop\] table"):
        open_case("en50318-2002/250").simulate_drop()
    # The modes state the spans of their record.
    modes = computed_modes(build_catenary(CASE.case.line), 5, 4.0)
    stated = tuple(mode.model_copy(update={"line": MeasuredLine(spans_m=(50.0,) * 5)}) for mode in modes)
    with pytest.raises(InputError, match="the line of the record is not that"):
        IdentifiedLines(stated).fit_damping(CASE, ELEMENT)
    (line,) = drop.plot("S2z").lines
    np.testing.assert_array_equal(line.get_ydata(), drop.record.signals[:, 1])


def test_first_drop_of_a_case_is_simulated(drop: OpenedDrop, monkeypatch: pytest.MonkeyPatch) -> None:
    """The simulation itself is replaced: the interface passes the case and the number of the drop on."""
    asked = []

    def simulate(case: Case, number: int) -> SimpleNamespace:
        asked.append((case.id, number))
        return SimpleNamespace(record=drop.record)

    monkeypatch.setattr("pantocheck.conformance.drops.drop_simulation.simulate_drop", simulate)
    assert CASE.simulate_drop().record is drop.record
    assert asked == [(CASE.id, 1)]


def test_fit_finds_the_coefficients_of_the_line(fit: FittedDamping) -> None:
    """Modes without error; the droppers, which the fit leaves out, have a share of 0.2 % of their damping."""
    damping = CASE.inputs["line"]["damping"]
    assert fit.coefficient("contact_wire", "mass").value == pytest.approx(
        damping["contact_wire"]["mass_coefficient_1_s"], rel=2e-3
    )
    assert len(fit.to_dataframe()["value"]) == len(fit.results.coefficients) >= 4
    assert repr(fit) == f"<FittedDamping {len(fit.results.coefficients)} coefficients>"
    models = fit.models()
    np.testing.assert_allclose(models["Rayleigh"], models["line as it is"], rtol=2e-3)
    assert len(fit.plot().lines) == 4  # the measured points and three models
    with pytest.raises(KeyError):
        fit.coefficient("contact_wire", "viscous")


def test_files_of_a_fit_are_those_of_the_command(fit: FittedDamping, tmp_path: Path) -> None:
    names = [path.name for path in fit.write(tmp_path)]
    assert names == ["damping.toml", "damping_with_modal.toml", "damping.json", "damping.html", "damping.pdf"]
    assert (tmp_path / "damping.toml").read_text("utf-8") == fit.toml


def test_files_of_an_identification_are_those_of_the_command(tmp_path: Path) -> None:
    """Decays of two known modes: the table holds their damping ratios, and modes.json is read again."""
    frequency, ratio = np.array([0.9, 1.8]), np.array([0.005, 0.003])
    poles = 2 * np.pi * frequency * (-ratio + 1j * np.sqrt(1 - ratio**2))
    decay = build_exact_decay(poles, np.array([[1.0, 0.4], [0.7, -0.9]], dtype=complex), "run", duration=60.0)
    solution = build_exact_fit([decay], poles, np.array([1e-4]))
    line = analyse_identification(Identification(solution, build_modes(solution, 2), ()))
    identified = IdentifiedRecords(line.modes, (line,))
    np.testing.assert_allclose(identified.to_dataframe()["damping_ratio"], ratio, rtol=1e-6)
    assert repr(identified) == f"<IdentifiedRecords {len(identified.modes)} modes>"
    assert [path.name for path in identified.write(tmp_path)] == [
        *("modes.json", "identification.json", "identification.html", "identification.pdf")
    ]
    assert open_modes(tmp_path / "modes.json").modes == tuple(mode.rounded() for mode in identified.modes)
    assert len(identified.plot().containers) == 1
