"""Sound files of every reader under fuzz."""

import importlib
import importlib.util
import json
import multiprocessing
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import NamedTuple

import h5py
import numpy as np
import scipy.io

from pantocheck.conformance.app.commands.new_command import read_template
from pantocheck.conformance.cases.library import load_case, select_cases
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.documents.verification import verify_document
from pantocheck.conformance.dossier.dossier_reading import read_dossier
from pantocheck.conformance.drops.drop_record import DropChannel, DropDescription, DropRecord
from pantocheck.conformance.drops.drop_writing import write_drop_csv, write_drop_hdf5, write_drop_uff
from pantocheck.conformance.execution.plan import read_plan
from pantocheck.conformance.execution.runner import run_cases
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.pages.certificate_page import build_certificate
from pantocheck.conformance.pages.pdf import render_pdf
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.record_writing import write_record
from pantocheck.conformance.results.identified_modes import MeasuredLine
from pantocheck.conformance.runs.record_folder import open_record_folder
from verification.attacks.fuzz_uses import (
    CASE,
    PASSING,
    use_answer,
    use_baseline,
    use_digested,
    use_drop,
    use_limits,
    use_logger,
    use_modes,
    use_profile,
    use_record,
)


class Target(NamedTuple):
    """Reader under fuzz: its sound files, the name of the damaged one, and the use of the folder that holds them."""

    name: str
    files: dict[str, bytes]
    damaged: str
    use: Callable[[Path], object]


def build_targets(folder: Path) -> list[Target]:
    """Every reader with a small sound file."""
    return [
        *_record_targets(folder),
        *_logger_targets(folder / "logger"),
        *_case_targets(),
        *_result_targets(),
        *_drop_targets(folder / "drop"),
        Target("modes", {"modes.json": json.dumps(_modes()).encode()}, "modes.json", use_modes),
        Target("answer of a program", {"answer.json": _answer()}, "answer.json", use_answer),
    ]


def _record_targets(folder: Path) -> Iterator[Target]:
    """Contact-force records as CSV and HDF5 with sidecar, and summaries of published values."""
    for suffix in ("csv", "h5"):
        home = folder / suffix
        write_record(home / f"a.{suffix}", _record(), case=CASE, system={"name": "seed", "version": "1"})
        sidecar = (home / "a.toml").read_text()
        free = "\n".join(line for line in sidecar.splitlines() if not line.startswith("sha256"))
        files = {f"a.{suffix}": (home / f"a.{suffix}").read_bytes(), "a.toml": free.encode()}
        yield Target(f"{suffix} table", files, f"a.{suffix}", use_record)
        yield Target(f"{suffix} sidecar", files, "a.toml", use_record)
        with_digest = {**files, "a.toml": sidecar.encode()}
        yield Target(f"{suffix} table, digest known", with_digest, f"a.{suffix}", use_digested)
        if suffix == "csv":
            profile = (library_folder() / "profiles" / "acceptance-ac.toml").read_bytes()
            yield Target("profile", {**files, "p.toml": profile}, "p.toml", use_profile)
    summary = (PASSING / "250.toml").read_bytes()
    failing = summary.replace(b"std_force_N = 27.6", b"std_force_N = 31.5")
    yield Target("summary record", {"a.toml": summary}, "a.toml", use_record)
    yield Target("failing summary record", {"a.toml": failing}, "a.toml", use_record)


def _logger_targets(folder: Path) -> Iterator[Target]:
    """Force record of a logger in every installed format: other names and units, events, arcs and distance pulses."""
    record = _record()
    folder.mkdir(parents=True)
    time, pulses = record.time, np.floor((record.position[0] - 60) / 0.5)
    channels = {"Kraft": record.force[0] / 1000, "Puls": pulses, "UV": (time % 1 < 0.01) * 5.0, "Strom": 400 + 0 * time}
    channels["Tunnel"] = (np.abs(time - 3) < 0.5) * 1.0
    rows = np.column_stack([time, *channels.values()])
    names = ";".join(["Zeit", *channels])
    body = "\n".join(";".join(f"{value:.6f}" for value in row) for row in rows).replace(".", ",")
    (folder / "a.csv").write_bytes(f"Messzug 7\n\n{names}\ns;kN;;V;A;\n{body}\n".encode("cp1252"))
    scipy.io.savemat(folder / "a.mat", {**channels, "t": time}, do_compression=True)
    with h5py.File(folder / "a.h5", "w") as file:
        for name, values in {"Zeit": time, **channels}.items():
            file[f"daq/{name}"] = values
    write_force_uff(folder / "a.uff", time, channels)
    files = ["a.csv", "a.mat", "a.h5", "a.uff"]
    for suffix, package in OPTIONAL_FORMATS.items():
        if importlib.util.find_spec(package) is not None:
            OPTIONAL_WRITERS[suffix](time, channels, folder / f"a.{suffix}")
            files.append(f"a.{suffix}")
    for name in files:
        sidecar = _logger_sidecar(name).encode()
        content = {name: (folder / name).read_bytes(), "a.toml": sidecar}
        yield Target(f"logger: {name}", content, name, use_logger(name))
        if name == "a.csv":
            yield Target("logger: sidecar", content, "a.toml", use_logger(name))


def _logger_sidecar(file: str) -> str:
    group = "daq/" if file.endswith(".h5") else ""
    time = f'time_s = {{ column = "{group}Zeit", unit = "s" }}\n' if file.endswith((".csv", ".h5")) else ""
    return f"""schema = "pantocheck.record/1"
file = "{file}"
speed_km_h = 250.0
pantographs = 1
filter_applied_Hz = "none"
evaluated_m = [240.0, 360.0]
[columns]
{time}force_1_N = {{ column = "{group}Kraft", unit = "kN" }}
[position]
kind = "counter"
column = "{group}Puls"
metres_per_pulse = 0.5
start_m = 60.0
[track]
zero_km = 0.0
kilometres = "increasing"
[[event]]
kind = "overlap"
from_km = 0.25
to_km = 0.26
exclude = "for the fuzz"
[[event_channel]]
column = "{group}Tunnel"
kind = "tunnel"
[[arc]]
pantograph = 1
detector = "{group}UV"
above = 2.5
current = {{ column = "{group}Strom", unit = "A" }}
nominal_current_A = 600.0
"""


def _case_targets() -> Iterator[Target]:
    """Case with line and pantograph, limits, plan and dossier."""
    home = library_folder() / "en50318-2002"
    case = {name: (home / name).read_bytes() for name in ("250.toml", "line.toml", "pantograph.toml")}
    for name in case:
        yield Target(f"case: {name}", case, name, lambda path: load_case(path / "250.toml"))
    limits = b'[[limit]]\nquantity = "std_force_N"\nlower = 20.0\nupper = 25.0\ntrust = "primary"\nsource = "own"\n'
    yield Target("limits", {"l.toml": limits}, "l.toml", use_limits)
    plan = (
        b'cases = ["en50318-2002/*"]\nsystem = "record:x"\nformats = ["json"]\nbaseline = "b.json"\ndrift_pct = 2.0\n'
    )
    yield Target("plan", {"p.toml": plan}, "p.toml", lambda path: read_plan(path / "p.toml"))
    dossier = read_template("dossier").encode()
    yield Target("dossier", {"d.toml": dossier}, "d.toml", lambda path: read_dossier(path / "d.toml"))


def _result_targets() -> Iterator[Target]:
    """Results as baseline and as attachment of a certificate."""
    results = run_cases(select_cases([CASE]), open_record_folder(PASSING))
    yield Target("results as baseline", {"r.json": results.to_json()}, "r.json", use_baseline(results))
    # Threads of the typesetter do not survive a fork: a round that renders would wait for them forever.
    with ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as pool:
        pdf = pool.submit(render_pdf, build_certificate(results)).result()
    yield Target("certificate", {"c.pdf": pdf}, "c.pdf", lambda path: verify_document(path / "c.pdf"))


def _drop_targets(folder: Path) -> Iterator[Target]:
    """Records of a mass drop in every installed format, and their sidecar."""
    record = _drop_record()
    folder.mkdir(parents=True)
    names = ("a.csv", "a.h5", "binary.uff", "ascii.uff", "version_5.mat", "version_7_3.mat")
    write_drop_csv(record, folder / "a.csv")
    sidecar = (folder / "a.toml").read_bytes()
    write_drop_hdf5((record, record), folder / "a.h5")
    write_drop_uff(record, folder / "binary.uff", "binary")
    write_drop_uff(record, folder / "ascii.uff", "ascii")
    vectors = {channel.name: record.signals[:, k] for k, channel in enumerate(record.channels)}
    # Compressed, as MATLAB saves: scipy itself crashes on some uncompressed files with a false size.
    scipy.io.savemat(folder / "version_5.mat", {**vectors, "fs": record.rate}, do_compression=True)
    with h5py.File(folder / "version_7_3.mat", "w") as file:
        for name, vector in vectors.items():
            file.create_dataset(name, data=vector[None, :], compression="gzip")
        file["fs"] = np.array([[record.rate]])
    for suffix, package in OPTIONAL_FORMATS.items():
        if importlib.util.find_spec(package) is None:
            print(f"format {suffix} is not tried: {package} is not installed", flush=True)
        else:
            OPTIONAL_WRITERS[suffix](record.time, vectors, folder / f"a.{suffix}")
            names += (f"a.{suffix}",)
    for name in names:
        files = {name: (folder / name).read_bytes(), f"{Path(name).stem}.toml": sidecar}
        yield Target(f"drop: {name}", files, name, use_drop(name))
    files = {"a.csv": (folder / "a.csv").read_bytes(), "a.toml": sidecar}
    yield Target("drop: sidecar", files, "a.toml", use_drop("a.csv"))


def _write_tdms(time: RealArray, channels: dict[str, RealArray], path: Path) -> None:
    nptdms = importlib.import_module("nptdms")
    step = {"wf_increment": float(time[1] - time[0])}
    with nptdms.TdmsWriter(str(path)) as writer:
        writer.write_segment(
            [nptdms.ChannelObject("group", name, np.array(values), step) for name, values in channels.items()]
        )


def _write_mdf(time: RealArray, channels: dict[str, RealArray], path: Path) -> None:
    asammdf = importlib.import_module("asammdf")
    with asammdf.MDF(version="4.10") as file:
        file.append([asammdf.Signal(np.array(values), time, name=name) for name, values in channels.items()])
        file.save(path, overwrite=True)


def write_force_uff(path: Path, time: RealArray, channels: dict[str, RealArray]) -> None:
    """Universal file of force channels: mass-drop record with the names of the channels."""
    sensors = tuple(DropChannel(name, number, "z", "CW", 1.0) for number, name in enumerate(channels, 1))
    rate = float(1 / (time[1] - time[0]))
    signals = np.column_stack(list(channels.values()))
    drop, line = (
        DropDescription(30.0, "CW", 33.0, 1.5),
        MeasuredLine(spans_m=(60.0, 54.0), contact_wire_tension_N=20e3, messenger_wire_tension_N=15e3),
    )
    record = DropRecord("force", "fuzz", rate, signals, sensors, "acceleration", drop, line)
    write_drop_uff(record, path, "binary")


OPTIONAL_FORMATS = {"tdms": "nptdms", "mf4": "asammdf"}
"""Package that writes an optional format."""
OPTIONAL_WRITERS: dict[str, Callable[[RealArray, dict[str, RealArray], Path], None]] = {
    "tdms": _write_tdms,
    "mf4": _write_mdf,
}


def _drop_record() -> DropRecord:
    """Record of noise at three sensors, 4 s at 100 Hz."""
    channels = (
        DropChannel("S1_z", 1, "z", "CW", 12.0),
        DropChannel("S1_y", 1, "y", "CW", 12.0),
        DropChannel("S2_z", 2, "z", "MW", 40.5),
    )
    signals = np.random.default_rng(0).standard_normal((400, 3))
    drop, line = (
        DropDescription(30.0, "CW", 33.0, 1.5),
        MeasuredLine(spans_m=(60.0, 54.0), contact_wire_tension_N=20e3, messenger_wire_tension_N=15e3),
    )
    return DropRecord("drop", "fuzz", 100.0, signals, channels, "acceleration", drop, line)


def _modes() -> list[dict[str, object]]:
    """Two modes as modes.json holds them."""
    shape = [
        {"sensor": k, "wire": "CW", "position_m": 10.0 * k, "re": 1.0 / k, "im": 0.01, "std": 0.001} for k in (1, 2)
    ]
    line = {"spans_m": [60.0] * 10, "contact_wire_tension_N": 20000.0, "messenger_wire_tension_N": 16000.0}
    facts = {"damping_ratio": 0.01, "damping_ratio_std": 1e-4, "sensor_shape": shape, "record": "a", "line": line}
    return [{"frequency_Hz": f, "frequency_std_Hz": 1e-3, "group": 1, "certain": True, **facts} for f in (1.0, 1.1)]


def _answer() -> bytes:
    digest = "0" * 64
    record = {name: {"file": f"a.{name}", "sha256": digest} for name in ("sidecar", "table")}
    static = {"presag_mm": 55.0, "dropper_length_m": [1.0, 1.1, 1.2]}
    return json.dumps({"message": "delivered", "id": 1, "record": record, "static": static, "notes": ["a"]}).encode()


def _record() -> Record:
    """Short synthetic record of the case; its sine fails on the extremes."""
    rate, speed = 200.0, 250 / 3.6
    time_s = np.arange(int(5.2 * rate)) / rate
    position = 60 + speed * time_s
    force = 119 + 39 * np.sin(2 * np.pi * position / 60) + 5 * np.sin(2 * np.pi * 12 * time_s)
    supports = np.array([240.0, 300.0, 360.0])
    uplift = 0.05 * np.exp(-(((position - supports[:, None]) / 5) ** 2))
    return Record(time_s, speed, position[None], force[None], (240.0, 360.0), None, None, supports, uplift)
