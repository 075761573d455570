"""Response records: kinds, units, column names and signs; every refusal names the place."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import pyuff

from helpers.response_records import (
    FREQUENCY,
    apparent_mass_columns,
    chain_stiffness,
    polar_columns,
    read_pantograph,
    write_response,
)
from helpers.toml_edit import edit_toml
from pantocheck.conformance.core.hdf5_table import write_hdf5_table
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.uff_table import write_data_sets
from pantocheck.conformance.pantograph.response_record import RESPONSE_FORMS, ResponseKind, read_response

STIFFNESS = chain_stiffness(read_pantograph())
S = 2j * np.pi * FREQUENCY
RESPONSES: dict[ResponseKind, Any] = {
    "dynamic_stiffness": STIFFNESS,
    "impedance": STIFFNESS / S,
    "apparent_mass": STIFFNESS / S**2,
    "receptance": 1 / STIFFNESS,
    "mobility": S / STIFFNESS,
    "accelerance": S**2 / STIFFNESS,
}


@pytest.mark.parametrize("kind", RESPONSES)
@pytest.mark.parametrize("form", ["polar", "cartesian"])
def test_every_kind_gives_the_dynamic_stiffness(tmp_path: Path, kind: ResponseKind, form: str) -> None:
    """Twelve digits in the table."""
    response, unit = RESPONSES[kind], RESPONSE_FORMS[kind].unit
    columns = polar_columns(response, unit)
    if form == "cartesian":
        columns = {"frequency_Hz": FREQUENCY, f"real_{unit}": response.real, f"imaginary_{unit}": response.imag}
    record = read_response(write_response(tmp_path, columns, kind=kind))
    assert record.stiffness == pytest.approx(STIFFNESS, rel=1e-9)
    assert RESPONSE_FORMS[kind].from_stiffness(STIFFNESS, FREQUENCY) == pytest.approx(response, rel=1e-12)


def test_units_scale_and_order_are_converted(tmp_path: Path) -> None:
    """Stiffness in N/mm, halved by the scale; phase in rad; frequencies in kHz, falling."""
    columns = {
        "frequency_kHz": FREQUENCY[::-1] / 1000,
        "modulus_N_mm": np.abs(STIFFNESS[::-1]) / 500,
        "phase_rad": np.angle(STIFFNESS[::-1]),
    }
    record = read_response(write_response(tmp_path, columns, kind="dynamic_stiffness", scale=0.5))
    assert record.frequency == pytest.approx(FREQUENCY, rel=1e-11)
    assert record.stiffness == pytest.approx(STIFFNESS, rel=1e-9)
    assert record.row.tolist() == list(range(FREQUENCY.size, 0, -1))


def test_columns_of_another_program_are_named_in_the_sidecar(tmp_path: Path) -> None:
    """A column that the sidecar does not name is ignored."""
    table = apparent_mass_columns(STIFFNESS)
    names = {"frequency_Hz": "Frequency", "modulus_kg": "Magnitude", "phase_deg": "Phase angle"}
    columns = {names[key]: values for key, values in table.items()} | {"coherence": np.ones(FREQUENCY.size)}
    record = read_response(write_response(tmp_path, columns, columns=names))
    assert record.stiffness == pytest.approx(STIFFNESS, rel=1e-9)


def test_force_of_opposite_direction_is_reversed(tmp_path: Path) -> None:
    path = write_response(tmp_path, apparent_mass_columns(-STIFFNESS), force_and_motion="opposite_directions")
    assert read_response(path).stiffness == pytest.approx(STIFFNESS, rel=1e-9)


@pytest.mark.parametrize("wrong", [-STIFFNESS, STIFFNESS.conj()])
def test_head_that_delivers_energy_is_refused(tmp_path: Path, wrong: Any) -> None:
    with pytest.raises(InputError, match=r"deliver energy: .*\n  Give force_and_motion = .opposite_directions"):
        read_response(write_response(tmp_path, apparent_mass_columns(wrong)))


def test_uncertainty_of_the_table_precedes_that_of_the_sidecar(tmp_path: Path) -> None:
    stated = {"modulus_uncertainty_pct": 2.0, "phase_uncertainty_deg": 1.0}
    columns = apparent_mass_columns(STIFFNESS)
    record = read_response(write_response(tmp_path, columns, **stated))
    assert record.uncertainty is not None
    assert (record.uncertainty.modulus[0], record.uncertainty.phase[0]) == pytest.approx((0.02, np.pi / 180))
    columns["modulus_uncertainty_pct"] = np.linspace(3, 4, FREQUENCY.size)
    record = read_response(write_response(tmp_path, columns, **stated))
    assert record.uncertainty is not None
    assert record.uncertainty.modulus[[0, -1]] == pytest.approx([0.03, 0.04])
    assert record.uncertainty.phase[0] == pytest.approx(np.pi / 180)


def test_hdf5_file_holds_one_data_set_per_column(tmp_path: Path) -> None:
    columns = apparent_mass_columns(STIFFNESS)
    write_response(tmp_path, columns, file="measured.h5")
    write_hdf5_table(tmp_path / "measured.h5", {}, {name: values.tolist() for name, values in columns.items()})
    assert read_response(tmp_path / "measured.h5").stiffness == pytest.approx(STIFFNESS, rel=1e-12)


THREE = np.array([1.0, 2.0, 3.0])


@pytest.mark.parametrize(
    ("columns", "sidecar", "message"),
    [
        ({}, {"rows": 4}, "has 3 rows, the sidecar states 4"),
        ({"frequency_Hz": np.array([1.0, 0.0, np.nan])}, {}, "rows 2, 3: the frequency is missing or not positive"),
        ({"frequency_Hz": np.array([1.0, 2.0, 1.0])}, {}, "row 3: the frequency occurs before"),
        ({"modulus_kg": np.array([1.0, 0.0, np.inf])}, {}, "'modulus_kg', row 3: the value is infinite"),
        ({"modulus_kg": np.array([1.0, 0.0, np.nan])}, {}, "row 2: the response is 0"),
        ({"modulus_kg": np.array([1.0, -1.0, 1.0])}, {}, "the modulus is negative in row 2"),
        ({"modulus_kg": np.full(3, np.nan)}, {}, "holds no measured value"),
        ({"modulus_uncertainty_pct": -THREE}, {"phase_uncertainty_deg": None}, "uncertainty of the modulus"),
        ({"modulus_N_m": THREE}, {}, r"column 'modulus_N_m': unknown column.\n  For this kind, .* modulus_kg"),
        ({"modulus": THREE}, {}, r"column 'modulus': unknown column.\n  .*did you mean modulus_kg"),
        ({"modulus_t": THREE}, {}, "column 'modulus_t': repeats modulus_kg"),
        ({"real_kg": THREE}, {}, "has modulus_kg and phase_deg and real_kg"),
        ({}, {"columns": {"frequency_Hz": "f"}}, r"key columns.frequency_Hz: the table has no column 'f'"),
        ({}, {"columns": {"frequency": "frequency_Hz"}}, r"key columns.frequency: unknown column"),
        ({}, {"columns": {"frequency_Hz": "frequency_Hz"}}, "has no response"),
        ({}, {"kind": "aparent_mass"}, "key kind"),
        ({}, {"phase_uncertainty_deg": 1.0}, "key modulus_uncertainty_pct: missing, although"),
        ({}, {"file": "../measured.csv"}, "key file: found the path"),
        ({}, {"static_force_N": None}, "key static_force_N: missing"),
    ],
)
def test_response_that_cannot_be_read_is_refused(
    tmp_path: Path, columns: dict[str, Any], sidecar: dict[str, Any], message: str
) -> None:
    valid = {"frequency_Hz": THREE, "modulus_kg": THREE, "phase_deg": -10 * THREE}
    with pytest.raises(InputError, match=message):
        read_response(write_response(tmp_path, valid | columns, **sidecar))


def write_universal(path: Path, response: np.ndarray, types: tuple[int, int]) -> None:
    """Frequency responses of a universal file, with uneven frequencies; `types` are those of both axes."""
    write_data_sets(
        path,
        [
            dict(
                pyuff.prepare_58(
                    binary=0, func_type=4, rsp_node=1, rsp_dir=3, ref_node=1, ref_dir=3, ord_data_type=6,
                    num_pts=row.size, data=row, x=FREQUENCY, abscissa_spacing=0, abscissa_min=float(FREQUENCY[0]),
                    abscissa_inc=0.0, abscissa_spec_data_type=18, abscissa_axis_units_lab="Hz",
                    ordinate_spec_data_type=types[0], ordinate_axis_units_lab="NONE",
                    orddenom_spec_data_type=types[1], orddenom_axis_units_lab="NONE", z_axis_spec_data_type=0,
                    z_axis_axis_units_lab="NONE", id1="head", id2="NONE", id3="NONE", id4="NONE", id5="NONE",
                )
            )
            for row in np.atleast_2d(response)
        ],
    )  # fmt: skip


def test_frequency_response_of_a_universal_file(tmp_path: Path) -> None:
    """Acceleration over force is an accelerance; uneven frequencies of ASCII data have six digits."""
    accelerance = RESPONSES["accelerance"]
    columns = {"frequency_Hz": FREQUENCY, "real_m_s2_N": accelerance.real, "imaginary_m_s2_N": accelerance.imag}
    table = write_response(tmp_path, columns, kind="accelerance", static_force_N=70.0)
    sidecar = edit_toml(table.with_suffix(".toml"), {"file": "measured.uff"})
    universal = tmp_path / "measured.uff"
    write_universal(universal, accelerance, (12, 13))
    np.testing.assert_allclose(read_response(universal).stiffness, STIFFNESS, rtol=2e-5)
    edit_toml(sidecar, {"kind": "receptance"})
    with pytest.raises(InputError, match=r"column 'real_m_s2_N': unknown column"):
        read_response(universal)
    universal.unlink()
    write_universal(universal, np.vstack([accelerance, accelerance]), (12, 13))
    with pytest.raises(InputError, match="holds 2 frequency responses"):
        read_response(universal)
    universal.unlink()
    write_universal(universal, accelerance, (12, 9))
    with pytest.raises(InputError, match="holds no time response"):
        read_response(universal)
