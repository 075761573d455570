"""Converged values of the reference cases, confirmed by the second formulation; writes reference_cases/converged/.

python -m verification.formulations.converged_values [CASE ...] [--runs runs.json] [--out reference_cases/converged]

Every case runs at fixed uplift forces: on the reference simulator with elements of 1 m, 0.5 m and 0.25 m, and in
the second formulation with points 0.25 m and 0.125 m apart. Finished runs are kept in a file.
"""

import argparse
from collections.abc import Iterator
from pathlib import Path

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.runs.command_system import build_case_message
from verification.formulations.converged_extrapolation import (
    AGREEMENT_PCT,
    Extrapolation,
    difference_pct,
    extrapolate,
    extrapolate_pair,
)
from verification.formulations.converged_runs import MESHES, SPACINGS, Runs, complete_runs
from verification.formulations.difference_arrays import build_model
from verification.formulations.difference_line import build_line
from verification.formulations.library_passages import PASSAGES

CASES = (*PASSAGES, "en50318-2018/ac-simple/static", "en50318-2018/ac-stitched/static")
SECOND = "explicit finite differences, verification/formulations/finite_differences.py"
BANDS = ("std_force_N", "rms_0_5_N", "rms_5_20_N", "rms_20_50_N")
"""Quantities of a pantograph that must agree before any of its values is stored."""


def write_file(case: Case, runs: Runs) -> str:
    """Content of the file of converged values of a case."""
    steps = [build_model(build_line(build_case_message(case)), spacing).arrays.step for spacing in SPACINGS]
    lines = [
        "# Written by verification/formulations/converged_values.py; do not edit.",
        'schema = "pantocheck.converged/1"',
        f'case = "{case.id}"',
        f'case_digest = "{case.digest}"',
        'trust = "computed"',
        *([f"uplift_force_N = {runs['uplift_forces']}"] if runs["uplift_forces"] else []),
        "",
        "[reference]",
        'name = "reference simulator"',
        f"spacing_m = {[mesh[0] for mesh in MESHES]}",
        f"time_step_s = {[mesh[1] for mesh in MESHES]}",
        "",
        "[second]",
        f'name = "{SECOND}"',
        f"spacing_m = {list(SPACINGS)}",
        f"time_step_s = {[float(f'{step:.6g}') for step in steps]}",
    ]
    return "\n".join([*lines, *_list_values(runs)]) + "\n"


def _list_values(runs: Runs) -> Iterator[str]:
    reference = {key: extrapolate_key(runs, key) for key in runs["reference"][f"{MESHES[0][0]:g}"]}
    differences = {key: _difference(runs, reference, key) for key in reference}
    for key in sorted(reference, key=lambda name: (name.startswith("0|"), name.split("|")[0])):
        owner, quantity = key.split("|")
        bands = [abs(differences[f"{owner}|{band}"]) for band in BANDS if f"{owner}|{band}" in differences]
        header = [f'quantity = "{quantity}"', *([f"pantograph = {owner}"] if owner != "0" else [])]
        if max([*bands, abs(differences[key])]) > AGREEMENT_PCT:
            reason = f"the two formulations differ by {differences[key]:+.2f} %"
            if abs(differences[key]) <= AGREEMENT_PCT:
                reason = f"a band of this pantograph differs by more than {AGREEMENT_PCT:g} % between the formulations"
            yield from ("", "[[omitted]]", *header, f'reason = "{reason}"')
            continue
        entry, second = reference[key], second_value(runs, key)
        half_width = max(entry.half_width, abs(second - entry.value))
        yield from ("", "[[value]]", *header, f"value = {entry.value:.6g}", f"half_width = {half_width:.3g}")
        if key in runs["start"]:
            yield f"start_half_width = {runs['start'][key]:.3g}"
        yield from ([f"order = {entry.order:.2f}"] if entry.order is not None else [])
        yield from (f"second_value = {second:.6g}", f"difference_pct = {differences[key]:.3f}")


def extrapolate_key(runs: Runs, key: str) -> Extrapolation:
    """Converged value of the reference simulator."""
    coarse, middle, fine = (runs["reference"][f"{mesh[0]:g}"][key] for mesh in MESHES)
    return extrapolate((coarse, middle, fine))


def second_value(runs: Runs, key: str) -> float:
    """Extrapolated value of the second formulation."""
    coarse, fine = (runs["second"][f"{spacing:g}"][key] for spacing in SPACINGS)
    return extrapolate_pair(coarse, fine)


def _difference(runs: Runs, reference: dict[str, Extrapolation], key: str) -> float:
    owner, quantity = key.split("|")
    mean = reference.get(f"{owner}|mean_force_N")
    return difference_pct(quantity, reference[key].value, second_value(runs, key), None if mean is None else mean.value)


def main() -> None:
    """Run and write."""
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("cases", nargs="*", default=CASES, metavar="CASE")
    options.add_argument("--runs", type=Path, default=Path("converged-runs.json"), help="file of finished runs")
    options.add_argument("--out", type=Path, default=Path("reference_cases/converged"), help="folder to write to")
    chosen = options.parse_args()
    known = {case.id: case for case in select_cases(chosen.cases)}
    for case in (known[name] for name in chosen.cases):
        runs = complete_runs(case, chosen.runs, print)
        path = chosen.out / f"{case.id}.toml"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(write_file(case, runs), encoding="utf-8")


if __name__ == "__main__":
    main()
