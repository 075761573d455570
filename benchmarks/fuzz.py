"""Byte-level fuzz of every reader: damaged files are refused with one message, or read; any other outcome is a failure.

    python benchmarks/fuzz.py --seconds 600 [--seed 1] [--keep FOLDER]

Each round damages one file of a small seed corpus (bytes flipped, cut, doubled, swapped for tokens that break parsers),
gives it to its reader under a time limit, and grades what was read. Three things are failures:

* a traceback: any exception other than `InputError`, or a crash of the process;
* a hang: more than `SLOWEST_S` seconds;
* a false pass: a passing verdict that does not follow from its own numbers, or from a file whose digest is wrong.

The failing input is kept, its name printed; the exit code is 1 if there was any.
"""

import argparse
import logging
import random
import re
import shutil
import signal
import sys
import tempfile
import time
import traceback
from collections import Counter
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

import numpy as np

from pantocheck.conformance.authenticity.recomputation import find_discrepancies
from pantocheck.conformance.authenticity.verification import verify_certificate
from pantocheck.conformance.cases.library import library_folder, load_case, overlay_limits, read_limits, select_cases
from pantocheck.conformance.cases.profile_file import load_profile
from pantocheck.conformance.grading.assessed_record import load_assessed_record
from pantocheck.conformance.grading.baseline import compare_with_baseline
from pantocheck.conformance.grading.profile_grading import assess_record
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.plan import read_plan
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.record_writing import write_record
from pantocheck.conformance.records.sidecar_tables import LineTable
from pantocheck.conformance.reports.certificate.certificate_page import build_certificate
from pantocheck.conformance.reports.formats.pdf import render_pdf
from pantocheck.conformance.results.results_format import Results
from pantocheck.conformance.results.results_reading import read_results
from pantocheck.conformance.runner import run_cases
from pantocheck.conformance.systems.record_folder import open_record_folder

SLOWEST_S = 20
CASE = "en50318-2002/250"
PASSING = library_folder() / "en50318-2002" / "known-passing-code"

TOKENS = tuple(
    text.encode()
    for text in (
        "nan", "inf", "-inf", "1e999", "-1e308", "1e-320", "0", "-1", "9" * 400, "true", "null", '""', "[]", "{}",
        "[[", "'''", '"""', "\\u0000", "\x00", "\ufeff", "\u202e", "é", "\r", "\n\n", "=", ",", ",,", ";", "#", "0x1p9",
        "../../etc/passwd", "C:\\x", "1_000", "1.5.2", "2026-11-20", "1979-05-27T07:32:00Z", "." * 50, "a" * 5000,
        "pantograph = 99", "\n[line]\n", "\n[[limit]]\n", "speed_km_h = 0.0\n", "speed_km_h = 1e300\n",
    )
)  # fmt: skip


class Falsehood(AssertionError):
    """A passing verdict that does not follow from the file: the one defect that a conformance suite must not have."""


class Target(NamedTuple):
    """Reader under fuzz: its sound files, the name of the damaged one, and the use of the folder that holds them."""

    name: str
    files: dict[str, bytes]
    damaged: str
    use: Callable[[Path], object]


def damage(content: bytes, chance: random.Random) -> bytes:
    """Damage a file at one or more random places."""
    data = bytearray(content)
    for _ in range(chance.choice((1, 1, 1, 2, 4, 16))):
        place = chance.randrange(len(data) + 1)
        span = chance.choice((1, 1, 4, 30, 1000))
        match chance.randrange(8):
            case 0:
                data[place : place + 1] = bytes([chance.randrange(256)])
            case 1:
                del data[place : place + span]
            case 2:
                data = data[:place]
            case 3:
                data[place:place] = data[place : place + span] * chance.choice((1, 2, 50))
            case 4:
                data[place : place + chance.choice((0, 1, 3))] = chance.choice(TOKENS)
            case 5:
                data[place : place + span] = chance.randbytes(min(span, 50))
            case 6:
                data = _replace_number(data, chance)
            case _:
                data = _swap_lines(data, chance)
    return bytes(data)


def _replace_number(data: bytearray, chance: random.Random) -> bytearray:
    """Replace a number by another one, which random bytes seldom do."""
    found = list(re.finditer(rb"-?\d+(\.\d+)?([eE][-+]?\d+)?", data))
    if not found:
        return data
    number = chance.choice(found)
    other = chance.choice((b"0", b"-1", b"1e9", b"1e300", b"nan", b"99999999999999999999", b"0.5", b"-0.0", b"2"))
    return data[: number.start()] + other + data[number.end() :]


def _swap_lines(data: bytearray, chance: random.Random) -> bytearray:
    lines = data.split(b"\n")
    i, j = chance.randrange(len(lines)), chance.randrange(len(lines))
    lines[i], lines[j] = lines[j], lines[i]
    return bytearray(b"\n".join(lines))


def build_targets(folder: Path) -> list[Target]:
    """Every reader with a small sound file."""
    tables: dict[str, dict[str, bytes]] = {}
    for suffix in ("csv", "h5"):
        home = folder / suffix
        write_record(home / f"a.{suffix}", _record(), case=CASE, system={"name": "seed", "version": "1"})
        sidecar = (home / "a.toml").read_text()
        free = "\n".join(line for line in sidecar.splitlines() if not line.startswith("sha256"))
        tables[suffix] = {f"a.{suffix}": (home / f"a.{suffix}").read_bytes(), "a.toml": free.encode()}
        tables[f"{suffix} with digest"] = {**tables[suffix], "a.toml": sidecar.encode()}
    home = library_folder() / "en50318-2002"
    case = {name: (home / name).read_bytes() for name in ("250.toml", "line.toml", "pantograph.toml")}
    summary = {"a.toml": (PASSING / "250.toml").read_bytes()}
    failing = {"a.toml": summary["a.toml"].replace(b"std_force_N = 27.6", b"std_force_N = 31.5")}
    limits = b'[[limit]]\nquantity = "std_force_N"\nlower = 20.0\nupper = 25.0\ntrust = "primary"\nsource = "own"\n'
    plan = (
        b'cases = ["en50318-2002/*"]\nsystem = "record:x"\nformats = ["json"]\nbaseline = "b.json"\ndrift_pct = 2.0\n'
    )
    results = run_cases(select_cases([CASE]), open_record_folder(PASSING))
    profile = (library_folder() / "profiles" / "acceptance-ac.toml").read_bytes()
    with_digest = [
        Target(f"{suffix} table, digest known", tables[f"{suffix} with digest"], f"a.{suffix}", use_digested)
        for suffix in ("csv", "h5")
    ]
    tabled = [
        Target(f"{suffix} {what}", tables[suffix], name, use_record)
        for suffix in ("csv", "h5")
        for what, name in (("table", f"a.{suffix}"), ("sidecar", "a.toml"))
    ]
    return [
        *tabled,
        *with_digest,
        *(Target(f"case: {name}", case, name, lambda path: load_case(path / "250.toml")) for name in case),
        Target("summary record", summary, "a.toml", use_record),
        Target("failing summary record", failing, "a.toml", use_record),
        Target("limits", {"l.toml": limits}, "l.toml", use_limits),
        Target("plan", {"p.toml": plan}, "p.toml", lambda path: read_plan(path / "p.toml")),
        Target("profile", {**tables["csv"], "p.toml": profile}, "p.toml", use_profile),
        Target("results as baseline", {"r.json": results.to_json()}, "r.json", use_baseline(results)),
        Target(
            "certificate",
            {"c.pdf": render_pdf(build_certificate(results.to_dict()))},
            "c.pdf",
            lambda p: verify_certificate(p / "c.pdf"),
        ),
    ]


def _record() -> Record:
    """Short synthetic record of the case; its sine fails on the extremes."""
    rate, speed = 200.0, 250 / 3.6
    time_s = np.arange(int(5.2 * rate)) / rate
    position = 60 + speed * time_s
    force = 119 + 39 * np.sin(2 * np.pi * position / 60) + 5 * np.sin(2 * np.pi * 12 * time_s)
    supports = np.array([240.0, 300.0, 360.0])
    uplift = 0.05 * np.exp(-(((position - supports[:, None]) / 5) ** 2))
    return Record(time_s, speed, position[None], force[None], (240.0, 360.0), None, None, supports, uplift)


def use_record(folder: Path) -> None:
    """Grade a record as the run of a case, and assess it."""
    try:
        system = open_record_folder(folder)
    except InputError:
        pass
    else:
        # `run` is called directly because the runner would hide an unexpected exception.
        (case,) = select_cases([CASE])
        with suppress(InputError):
            system.run(case)
        check(run_cases([case], system))
    profile = load_profile("acceptance-ac")
    check(assess_record(load_assessed_record(folder / "a.toml", profile, LineTable(wave_speed_m_s=120.0)), profile))


def use_digested(folder: Path) -> None:
    """Require that a table which contradicts its digest is refused."""
    use_record(folder)
    raise Falsehood("a table that contradicts its digest was read")


def use_limits(folder: Path) -> None:
    """Replace the limits of the case, and grade the passing code."""
    check(run_cases(overlay_limits(select_cases([CASE]), read_limits(folder / "l.toml")), open_record_folder(PASSING)))


def use_profile(folder: Path) -> None:
    """Assess a sound record by a damaged profile."""
    profile = load_profile(str(folder / "p.toml"))
    check(assess_record(load_assessed_record(folder / "a.toml", profile, LineTable(wave_speed_m_s=120.0)), profile))


def use_baseline(results: Results) -> Callable[[Path], None]:
    """Compare sound results with damaged ones; grade the damaged ones once more, as `verify` does."""

    def use(folder: Path) -> None:
        damaged_results = read_results(folder / "r.json")
        find_discrepancies(damaged_results.to_dict())
        check(compare_with_baseline(results, damaged_results, 1.0, "r.json"))

    return use


def check(results: Results) -> None:
    """Require consistent results, and for a case in `error` a reason that the suite formulated."""
    found = find_discrepancies(results.to_dict())
    if found and results.verdict in {"pass", "info"}:
        raise Falsehood(f"{results.verdict}: {found[0]}")
    for case in results.cases:
        raised = (case.reason or "").split(":")[0].endswith(("Error", "Exception", "Warning"))
        if case.verdict == "error" and raised and not (case.reason or "").startswith("InputError"):
            raise Falsehood(f"the runner caught {case.reason}")
        if case.verdict == "pass" and any(item.value is None for item in case.criteria):
            raise Falsehood("a criterion without a value passed")


def run_round(target: Target, folder: Path, chance: random.Random) -> str:
    """Give a damaged file to its reader; the outcome is `read`, `refused` or an exception."""
    content = damage(target.files[target.damaged], chance)
    for name, original in target.files.items():
        (folder / name).write_bytes(content if name == target.damaged else original)
    if target.use is use_digested and content == target.files[target.damaged]:
        return "read"
    try:
        target.use(folder)
    except InputError as error:
        if "\n  " not in str(error) or not error.found or len(str(error)) > 3000:
            raise Falsehood(f"a message without place, fault or hint: {str(error)[:200]!r}") from None
        return "refused"
    return "read"


class Hang(BaseException):
    """A reader exceeds the time limit."""


def _hang(*_: object) -> None:
    raise Hang(f"more than {SLOWEST_S} s")


def campaign(seconds: float, seed: int, keep: Path) -> int:
    """Fuzz all readers in turn until the time is over, and return the number of failures."""
    chance, outcomes, failures = random.Random(seed), Counter[tuple[str, str]](), 0
    signal.signal(signal.SIGALRM, _hang)
    with tempfile.TemporaryDirectory() as name:
        seeds, scratch = Path(name, "seeds"), Path(name, "scratch")
        all_targets = build_targets(seeds)
        end = time.monotonic() + seconds
        rounds = 0
        while time.monotonic() < end:
            target = all_targets[rounds % len(all_targets)]
            rounds += 1
            shutil.rmtree(scratch, ignore_errors=True)
            scratch.mkdir()
            signal.alarm(SLOWEST_S)
            try:
                outcomes[target.name, run_round(target, scratch, chance)] += 1
            except (Exception, Hang) as error:
                failures += 1
                outcomes[target.name, "FAILED"] += 1
                kept = keep / f"{failures:03d}"
                signal.alarm(0)
                shutil.copytree(scratch, kept, dirs_exist_ok=True)
                (kept / "why.txt").write_text("".join(traceback.format_exception(error)))
                print(f"{target.name}: {type(error).__name__}: {str(error)[:160]}  [{kept}]", flush=True)
            finally:
                signal.alarm(0)
    for (target_name, outcome), count in sorted(outcomes.items()):
        print(f"{target_name:28} {outcome:8} {count:7}")
    print(f"{rounds} rounds, {failures} failures")
    return failures


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--seconds", type=float, default=600.0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--keep", type=Path, default=Path("fuzz-failures"))
    options = parser.parse_args()
    logging.getLogger("pypdf").setLevel(logging.CRITICAL)  # it warns of every object of a damaged file
    sys.exit(bool(campaign(options.seconds, options.seed, options.keep)))


if __name__ == "__main__":
    main()
