"""Compare results of the suite with the frozen results of commit 07ce9e7 (`tests/data/frozen`).

    python benchmarks/frozen.py write DIR [--drops DIR]     run every command of the comparison, results into DIR
    python benchmarks/frozen.py compare DIR                 compare DIR with the frozen files
    python benchmarks/frozen.py compare DIR --earlier DIR   compare DIR with another folder that `write` has written

`--drops` names the folder of the mass-drop records T1.h5, T2.csv and T3.uff; without it they are not identified. The
new file must hold every id, number and verdict of the frozen file at the same place. It may hold more keys, and more
criteria behind the frozen ones. Texts may differ. The lists `warnings` and `notes` are not compared: a remark may move
to another key, as the near-limit remark moved from `warnings` to `close` of its criterion. The exit code is 1 if a
number differs by more than its tolerance, or if an id, a verdict or a missing key differs in another way than
`INTENDED_CHANGES` states. Smaller differences are counted, and the largest is printed.

Numbers of records agree with the frozen ones to 1e-12, those of identified modes to two units of the last of eight
digits. Results of the reference simulator have changed since: `SIMULATED` states the tolerance of each quantity. With
`--earlier` every number must agree to 1e-12, and no change is intended: this is the comparison for a change of the code
that must not change a number.
"""

import argparse
import json
import lzma
import math
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any

FROZEN = Path(__file__).parent.parent / "tests" / "data" / "frozen"

RUNS = {
    "en50318-2002": ["run", "en50318-2002/*", "--formats", "json"],
    "ac-simple": ["run", "en50318-2018/ac-simple/*", "--jobs", "2", "--formats", "json"],
    "ac-stitched": ["run", "en50318-2018/ac-stitched/*", "--jobs", "2", "--formats", "json"],
    "vovan2015": ["run", "vovan2015/*", "--jobs", "2", "--formats", "json"],
    "damping-study": ["run", "en50318-2002/250", "--damping-study", "--formats", "json"],
    "record-system": [
        *("run", "en50318-2002/*", "--system", "record:en50318-2002/known-passing-code"),
        *("--verdicts", "criteria", "--formats", "json"),
    ],
    # The frozen record: a new one has another digest, which enters the input digest of the results.
    "assess": ["assess", str(FROZEN / "250.h5"), "--profile", "acceptance-ac", "--formats", "json"],
}
"""Arguments of the commands that need no mass-drop record, by folder of their results."""

DROPS = {"T1": "T1.h5", "T2": "T2.csv", "T3": "T3.uff"}
FIT_LINE = "vovan2015/mass-drop/printed"

RUN_FACTS = {"wall_s", "started", "commit", "version", "python", "numpy", "scipy", "numba", "machine", "system"}
"""Keys that belong to the run and not to its results."""

IDENTIFIERS = {"id", "verdict", "quantity", "trust", "unit", "name", "kind", "matrix", "wire", "input_digest"}
"""Keys whose text must not change."""

TEXT_LISTS = {"warnings", "notes"}
"""Lists of remarks, which are not compared (see above)."""

_FACTS = "the record states neither the wave speed nor the space for uplift: two rules are skipped"
_STATISTICS = "published statistics are an unverified record"

_DIGEST = ("is 'sha256:*', was 'sha256:*'", "files of lines and cases have more keys")
_OVERLAYS = ("has another length than 0", "a drop without repetition has a figure, too")
_BANDS = "the second group keeps too few modes: those of overlapping bands are left out"


def _list_digests(cases: int) -> dict[str, tuple[str, str]]:
    """Intended changes of the input digests of some cases."""
    return {f".cases[{number}].input_digest": _DIGEST for number in range(cases)}


INTENDED_CHANGES = {
    "ac-simple/results.json": {
        ".verdict": (
            "is 'info', was 'pass'",
            "only one of five cases has a limit that counts: the other four do not pass",
        ),
        **_list_digests(5),
    },
    "ac-stitched/results.json": _list_digests(3),
    "en50318-2002/results.json": _list_digests(2),
    "T2/identification.json": {".lines[0].overlays": _OVERLAYS},
    "T3/identification.json": {".lines[0].overlays": _OVERLAYS},
    "T1-fit/damping.json": {".modal": ("has another length than 2", _BANDS)},
    "assess/results.json": {
        ".verdict": ("is 'skip', was 'pass'", _FACTS),
        ".cases[0].verdict": ("is 'skip', was 'pass'", _FACTS),
        ".cases[0].input_digest": (
            "is 'sha256:*', was 'sha256:*'",
            "the profile and the facts on the line have more keys",
        ),
        ".cases[0].quantities.0": ("is missing", "the record does not state the span: supports may be missing"),
    },
    "record-system/results.json": {
        ".verdict": ("is 'unverified', was 'pass'", _STATISTICS),
        ".cases[0].verdict": ("is 'unverified', was 'pass'", _STATISTICS),
        ".cases[1].verdict": ("is 'unverified', was 'pass'", _STATISTICS),
        **_list_digests(2),
    },
}
"""Intended changes since the frozen commit, by file and place: pattern of the difference, and its reason.

The verdicts are explained in docs/verdicts.md.
"""

REPLACED = {"vovan2015/results.json", "damping-study/results.json"}
"""Files whose cases or damping models were replaced since the frozen commit: compared with `--earlier` only."""

RENEWED = re.compile(r"\.(uncertainty|close)(\.|\[|$)")
"""Places of results.json with another meaning since the frozen commit, which are not compared with the frozen files.

The uncertainty was that from the length of the record alone; it is combined from several components, and decides which
criteria are close to a limit (docs/uncertainty.md).
"""

TOLERANCE = 1e-12

PRINTED = 2.01e-7
"""Tolerance of identified modes, which are rounded to eight digits: two units of the last digit."""

SMALLEST = 1e-8
"""Size below which a difference is not relative: imaginary parts of real mode shapes are rounding errors."""

MODAL = re.compile(r"\.models\.Rayleigh \+ modal\[")
"""Ratios in the bands of modal damping, which follow from the number of bands."""

"""Largest relative difference that a reordering of sums by the compiler may cause."""

SIMULATED_FILES = {f"{name}/results.json" for name in ("en50318-2002", "ac-simple", "ac-stitched")}
"""Files with results of the reference simulator."""

FITTED = {"T1-fit/damping.json": 0.03}
"""Tolerance of files with a fit to modes of the reference simulator; a variance inflation changes most, by 1.8 %."""

SIMULATED = {
    "mean_force_N": 0.001,
    "std_force_N": 0.03,
    "std_force_50_N": 0.03,
    "cov_20": 0.03,
    "cov_50": 0.03,
    "rms_0_5_N": 0.03,
    "rms_5_20_N": 0.05,
    "rms_20_50_N": 0.08,
    "max_force_N": 0.03,
    "min_force_N": 0.20,
    "statistical_max_N": 0.02,
    "statistical_min_N": 0.20,
    "max_uplift_at_support_mm": 0.005,
    "contact_height_range_mm": 0.05,
    "elasticity": 0.006,
    "natural_frequency_Hz": 0.002,
    "mode_frequency_Hz": 0.002,
    "damping_ratio": 0.005,
    "largest_damping_ratio": 0.005,
    "damping_decrease_pct": 0.005,
    "damping_rise_pct": 0.005,
    "dropper_transition": 0.12,
    "contact_loss_pct": 0.2,
    "change_": math.inf,
    "rear_over_front": math.inf,
    "damping_gain": math.inf,
}
"""Tolerance by quantity, or by the begin of its name, in `SIMULATED_FILES`.

The frozen commit had no residual flexibility of the wires at droppers, supports and arms. At its default mesh it was
wrong by 2.4 % in the standard deviation, 7 % in 20-50 Hz, 2.1 % in the maximum and 17 % in the minimum of a trailing
pantograph. The change of each quantity may be as large as this error. Quantities that are not
listed agree to `TOLERANCE`. Infinite: a small difference of two simulations, of which only the verdict is compared.
"""

DERIVED = re.compile(
    r"\.criteria\[\d+\]\.(value|margin|spread|discretisation_error)|\.(spread|traces|uplift|charts)[.\[]"
)
"""Places in `SIMULATED_FILES` that follow from the quantities, or are histories; they are not compared."""


def write(folder: Path, drops: Path | None) -> None:
    """Run every command of the comparison."""
    for name, arguments in RUNS.items():
        _pantocheck(*arguments, "--out", folder / name)
    if drops is not None:
        for name, file in DROPS.items():
            _pantocheck("identify", drops / file, "--out", folder / name)
        # The library has no line with the spans of T1; the fit compares numbers, not coefficients with their truth.
        modes = folder / "T1" / "modes.json"
        _pantocheck("fit-damping", modes, "--line", FIT_LINE, "--other-line", "--out", folder / "T1-fit")


def _pantocheck(*arguments: str | Path) -> None:
    program = Path(sys.executable).parent / "pantocheck"
    command = [str(program), *map(str, arguments)]
    print("+", " ".join(command[1:]), flush=True)
    done = subprocess.run(
        command, env=os.environ | {"SOURCE_DATE_EPOCH": "1790000000"}, capture_output=True, text=True, check=False
    )
    if done.returncode not in (0, 1):
        raise SystemExit(f"{done.stderr}\nexit code {done.returncode}")


def differences(frozen: Any, new: Any, path: str = "", key: str = "") -> Iterator[tuple[str, float | str]]:
    """Every number with its relative difference, and every other difference with its text."""
    if isinstance(frozen, dict):
        if not isinstance(new, dict):
            yield path, f"is {type(new).__name__}, was an object"
            return
        for name, value in frozen.items():
            if name in RUN_FACTS or name in TEXT_LISTS:
                continue
            if name not in new:
                yield f"{path}.{name}", "is missing"
            else:
                yield from differences(value, new[name], f"{path}.{name}", name)
    elif isinstance(frozen, list):
        if not isinstance(new, list) or len(new) < len(frozen) or (len(new) > len(frozen) and key != "criteria"):
            yield path, f"has another length than {len(frozen)}"
            return
        for i, (old, now) in enumerate(zip(frozen, new, strict=False)):
            yield from differences(old, now, f"{path}[{i}]", key)
    elif isinstance(frozen, bool) or frozen is None:
        if new != frozen:
            yield path, f"is {new!r}, was {frozen!r}"
    elif isinstance(frozen, int | float):
        if not isinstance(new, int | float):
            yield path, f"is {new!r}, was {frozen!r}"
        else:
            yield path, 0.0 if new == frozen else abs(new - frozen) / max(abs(frozen), abs(new), SMALLEST)
    elif key in IDENTIFIERS and new != frozen:
        yield path, f"is {new!r}, was {frozen!r}"


def _remove_intended(
    differing: list[tuple[str, float | str]], intended: dict[str, tuple[str, str]]
) -> tuple[list[tuple[str, float | str]], list[tuple[str, float | str]]]:
    """Differences without the intended ones, and a fault for every intended difference that is not there."""
    texts = {place: value for place, value in differing if isinstance(value, str)}
    present = {place for place, (pattern, _) in intended.items() if fnmatchcase(texts.get(place, ""), pattern)}
    missing = [(place, f"{intended[place][0]} expected") for place in intended if place not in present]
    return [(place, value) for place, value in differing if place not in present], list(missing)


def tolerance(name: str, place: str) -> float:
    """Tolerance of the difference at a place of a file; infinite where numbers follow from others or are histories."""
    if name.endswith("results.json") and RENEWED.search(place):
        return math.inf
    if name == "T1-fit/damping.json" and MODAL.search(place):
        return math.inf
    if name not in SIMULATED_FILES:
        return FITTED.get(name, PRINTED if name.startswith(("T1/", "T2/", "T3/")) else TOLERANCE)
    if DERIVED.search(place):
        return math.inf
    quantity = re.search(r"\.quantities\.\d+\.(\w+)", place)
    start = next((start for start in SIMULATED if quantity is not None and quantity[1].startswith(start)), None)
    return TOLERANCE if start is None else SIMULATED[start]


def _read_pairs(folder: Path, earlier: Path | None) -> Iterator[tuple[str, Any, Any]]:
    """Name, earlier content and new content of every file; the frozen files are the default of the earlier ones."""
    root, pattern = (FROZEN, "*.json.xz") if earlier is None else (earlier, "*.json")
    for path in sorted(root.rglob(pattern)):
        name = path.relative_to(root).with_name(path.name.removesuffix(".xz"))
        if not (folder / name).is_file():
            print(f"{name}: not written, not compared")
            continue
        content = path.read_bytes()
        old = json.loads(lzma.decompress(content) if earlier is None else content)
        yield str(name), old, json.loads((folder / name).read_text())


def compare(folder: Path, earlier: Path | None) -> bool:
    """Compare a folder with the frozen files, or with an earlier folder; true if there is no fault."""
    agreed = True
    for name, old, new in _read_pairs(folder, earlier):
        if earlier is None and name in REPLACED:
            continue
        intended = INTENDED_CHANGES.get(name, {}) if earlier is None else {}
        remaining, missing = _remove_intended(list(differences(old, new)), intended)
        tolerances = [tolerance(name, place) if earlier is None else TOLERANCE for place, _ in remaining]
        judged = [(*pair, allowed) for pair, allowed in zip(remaining, tolerances, strict=True) if allowed < math.inf]
        faults = [
            *missing,
            *((place, value) for place, value, allowed in judged if isinstance(value, str) or value > allowed),
        ]
        numbers = [value for _, value, _ in judged if isinstance(value, float)]
        changed = [value for value in numbers if value > 0]
        print(
            f"{name}: {len(numbers)} numbers, {len(numbers) - len(changed)} bit-identical, "
            f"largest relative difference {max(changed, default=0.0):.2g}, {len(faults)} faults"
        )
        for place, value in faults[:10]:
            print(f"  {place}: {value}")
        agreed &= not faults
    return agreed


def main() -> None:
    """Entry point."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("action", choices=("write", "compare"))
    parser.add_argument("folder", type=Path)
    parser.add_argument("--drops", type=Path)
    parser.add_argument("--earlier", type=Path)
    options = parser.parse_args()
    if options.action == "write":
        write(options.folder, options.drops)
    else:
        raise SystemExit(0 if compare(options.folder, options.earlier) else 1)


if __name__ == "__main__":
    main()
