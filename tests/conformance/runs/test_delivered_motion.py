"""Moving picture from delivered shapes: those of the reference simulator come back, and damaged files are refused."""

import hashlib
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import find_entries, load_entry
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.records.record_writing import write_record
from pantocheck.conformance.runs.command_system import DeliveryRefused, read_delivery
from pantocheck.conformance.runs.delivered_motion import build_delivered_motion
from pantocheck.conformance.runs.protocol_messages import DeliveredAnswer
from pantocheck.conformance.runs.record_folder import open_record_folder
from pantocheck.conformance.runs.reference_simulator import SimulatorWithMotion
from pantocheck.conformance.runs.system import Delivered

KINDS = ("contact_wire", "messenger_wire")


@pytest.fixture(scope="module")
def case() -> Case:
    [entry] = find_entries(["en50318-2002/250"])
    return load_entry(entry)


@pytest.fixture(scope="module")
def simulated(case: Case) -> Delivered:
    outcome = SimulatorWithMotion().run(case)
    assert isinstance(outcome, Delivered)
    return outcome


def list_arrays(simulated: Delivered) -> dict[str, Any]:
    """Data sets of the shapes of a simulated passage."""
    motion, shape = simulated.motion, simulated.line_shape
    assert motion is not None
    assert shape is not None
    assert motion.slack is not None
    arrays: dict[str, Any] = {
        "time_s": motion.start_s + motion.step_s * np.arange(motion.slack.frames),
        "dropper_position_m": motion.dropper_m,
        "dropper_slack": motion.slack.decode(),
    }
    for wire in motion.wires:
        kind = shape.side.curves[wire.curve].kind
        arrays |= {f"{kind}_position_m": wire.x_m, f"{kind}_rise_m": wire.rise_mm.decode() / 1000}
    return arrays


def write_shapes(path: Path, arrays: dict[str, Any]) -> Path:
    with h5py.File(path, "w") as file:
        for name, values in arrays.items():
            file[name] = values
    return path


def write_run(folder: Path, case: Case, simulated: Delivered) -> Path:
    """Record with shapes; returns its sidecar."""
    assert simulated.record is not None
    write_shapes(folder / "shapes.h5", list_arrays(simulated))
    system = {"name": "other", "version": "1"}
    further = {"case_digest": case.digest, "shapes": "shapes.h5"}
    return write_record(folder / "run.csv", simulated.record, case=case.id, system=system, further=further)


def test_shapes_of_the_reference_simulator_come_back(case: Case, simulated: Delivered, tmp_path: Path) -> None:
    """Half a step of 0.1 mm at the kept points; between them straight lines miss the wire by the stated error."""
    path = write_shapes(tmp_path / "shapes.h5", list_arrays(simulated))
    assert simulated.record is not None
    delivered = build_delivered_motion(case, simulated.record, path)
    first, second = simulated.motion, delivered.motion
    assert first is not None
    assert second is not None
    assert delivered.line_shape == simulated.line_shape
    assert len(second.wires) == len(first.wires) == 2
    frames = second.wires[0].rise_mm.frames
    begin = round((second.start_s - first.start_s) / first.step_s)
    for before, after in zip(
        sorted(first.wires, key=lambda wire: wire.curve), sorted(second.wires, key=lambda wire: wire.curve), strict=True
    ):
        kept = np.isin(np.round(before.x_m, 3), np.round(after.x_m, 3))
        expected = before.rise_mm.decode()[begin : begin + frames, kept]
        np.testing.assert_allclose(after.rise_mm.decode(), expected, atol=0.51 * after.rise_mm.step + 1e-6)
    # The force is that of the record at the nearest sample, as in the simulated picture.
    force = first.pantographs[0].force_N.decode()[begin : begin + frames]
    np.testing.assert_allclose(second.pantographs[0].force_N.decode(), force, atol=0.06)
    np.testing.assert_array_equal(second.slack.decode(), first.slack.decode()[begin : begin + frames])


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"time_s": None}, "data set time_s, is missing"),
        ({"time_s": np.arange(260) ** 2}, "not evenly spaced"),
        ({"time_s": np.arange(260)[::-1] * 0.1}, "not evenly spaced"),  # backwards
        ({"time_s": np.arange(260) * 0.1}, "found frames from 0 s to 25.9 s"),
        ({"contact_wire_rise_m": np.zeros((3, 4))}, "has the shape (3, 4)"),
        ({"contact_wire_rise_m": "unit"}, "Give the rise over the line at rest in metres"),
        ({"contact_wire_rise_m": "gap"}, "not finite"),
        ({"contact_wire_position_m": "back"}, "the positions do not increase"),
        ({"contact_wire_2_position_m": "copy", "contact_wire_2_rise_m": "copy"}, "has the contact wire 2"),
    ],
)
def test_damaged_shapes_are_refused(
    case: Case, simulated: Delivered, tmp_path: Path, changes: dict[str, Any], message: str
) -> None:
    arrays = list_arrays(simulated)
    for name, change in changes.items():
        if change is None:
            del arrays[name]
        elif isinstance(change, str):
            values = np.array(arrays[name.replace("_2", "")])
            arrays[name] = {"unit": 1e6 * values, "gap": values + np.inf, "back": values[::-1], "copy": values}[change]
        else:
            arrays[name] = change
    assert simulated.record is not None
    with pytest.raises(InputError) as error:
        build_delivered_motion(case, simulated.record, write_shapes(tmp_path / "shapes.h5", arrays))
    assert message in str(error.value).replace("\n  ", " ").replace(": ", ", ")


def test_records_and_programs_deliver_shapes(case: Case, simulated: Delivered, tmp_path: Path) -> None:
    sidecar = write_run(tmp_path, case, simulated)
    outcome = open_record_folder(tmp_path).run(case)
    assert isinstance(outcome, Delivered)
    assert outcome.motion is not None
    names = {"sidecar": sidecar.name, "table": "run.csv", "shapes": "shapes.h5"}
    files = {
        key: {"file": name, "sha256": hashlib.sha256((tmp_path / name).read_bytes()).hexdigest()}
        for key, name in names.items()
    }
    answer = DeliveredAnswer.model_validate({"message": "delivered", "id": 1, "record": files})
    assert read_delivery(case, answer, tmp_path, 1.0).motion == outcome.motion
    (tmp_path / "other.h5").write_bytes((tmp_path / "shapes.h5").read_bytes())
    files["shapes"]["file"] = "other.h5"
    answer = DeliveredAnswer.model_validate({"message": "delivered", "id": 1, "record": files})
    with pytest.raises(DeliveryRefused, match=r"the sidecar names the shapes 'shapes\.h5'"):
        read_delivery(case, answer, tmp_path, 1.0)
