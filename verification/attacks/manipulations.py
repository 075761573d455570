"""Manipulation campaign: no manipulation of a record or case that does not pass may make it pass.

    python -m verification.attacks.manipulations OUT [--count 2500] [--seed 20261121] [--only NUMBER] [--group GROUP]

The base of each trial is a run of the reference simulator that does not pass, for a stated reason. One to three
manipulations of the grammar (`manipulation_grammar.py`) change its files. The suite then grades them as
`pantocheck run` or `pantocheck assess` would. A verdict with exit code 0 is a wrong PASS: its files are kept in
OUT/wrong, and the exit code is 1. `--only` repeats one trial and keeps its files. `--group` draws from one group of the
grammar alone. OUT/runs keeps the simulated runs for the next call.
"""

import argparse
import random
import shutil
import sys
import tempfile
from collections import Counter
from collections.abc import Callable
from copy import deepcopy
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w

from pantocheck.conformance.app.commands.command_output import EXIT_CODES
from pantocheck.conformance.cases.library import overlay_limits, read_limits, select_cases
from pantocheck.conformance.cases.profile_file import load_profile
from pantocheck.conformance.comparison.profile_grading import assess_record
from pantocheck.conformance.core.csv_table import write_csv_table
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.toml_file import read_toml
from pantocheck.conformance.execution.runner import run_cases
from pantocheck.conformance.grading.assessed_record import load_assessed_record
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.quantities.evaluation import Evaluation
from pantocheck.conformance.records.record_reading import read_record
from pantocheck.conformance.records.record_signals import evaluate_record
from pantocheck.conformance.records.record_writing import write_record
from pantocheck.conformance.records.sidecar_tables import LineTable
from pantocheck.conformance.results.results_format import Results
from pantocheck.conformance.runs.record_folder import open_record_folder
from pantocheck.conformance.runs.reference_simulator import ReferenceSimulator
from pantocheck.conformance.runs.system import Delivered
from verification.attacks.manipulation_dossier import Dossier
from verification.attacks.manipulation_grammar import MANIPULATIONS

SOURCE = library_folder() / "en50318-2002"

COMPARED = frozenset(
    {
        "mean_force_N", "std_force_N", "std_force_50_N", "max_force_N", "min_force_N", "statistical_max_N",
        "statistical_min_N", "contact_loss_pct", "max_uplift_at_support_mm", "contact_height_range_mm",
    }
)  # fmt: skip
"""Quantities that the cases of the campaign limit."""


OUTSIDE = 1e-4
"""Relative distance of a value outside its limit, whose record is then thinned and rounded."""


@dataclass(frozen=True)
class Base:
    """Subject that does not pass."""

    name: str
    """Reason why it does not pass."""
    dossier: Dossier
    """Its files."""
    groups: frozenset[str]
    """Groups of manipulations that apply; a group that could repair the fault of the base is left out."""
    grade: Callable[[Path], Results]
    """Grading of a folder with the files."""


def write_dossier(folder: Path, dossier: Dossier) -> None:
    """Write the files of a dossier: `case/250.toml` with line and pantograph, `record/a.csv` with sidecar, limits."""
    for name, table in (("250", dossier.case), ("line", dossier.line), ("pantograph", dossier.pantograph)):
        _write_toml(folder / "case" / f"{name}.toml", table)
    _write_toml(folder / "record" / "a.toml", dossier.sidecar)
    if dossier.limits is not None:
        _write_toml(folder / "limits.toml", dossier.limits)
    columns = np.column_stack(list(dossier.columns.values())) if dossier.columns else np.zeros((0, 0))
    write_csv_table(folder / "record" / "a.csv", list(dossier.columns), columns, 12)


def _write_toml(path: Path, table: dict[str, Any]) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(tomli_w.dumps(table), encoding="utf-8")


def grade_run(folder: Path) -> Results:
    """Grade as `pantocheck run` does."""
    cases = select_cases([str(folder / "case" / "250.toml")])
    if (folder / "limits.toml").exists():
        cases = overlay_limits(cases, read_limits(folder / "limits.toml"))
    return run_cases(cases, open_record_folder(folder / "record"))


def grade_assessment(uplift_space_mm: float) -> Callable[[Path], Results]:
    """Grade as `pantocheck assess` does, with a space for uplift."""

    def grade(folder: Path) -> Results:
        profile = load_profile("acceptance-ac")
        line = LineTable(wave_speed_m_s=120.0, uplift_space_mm=uplift_space_mm)
        return assess_record(load_assessed_record(folder / "record" / "a.toml", profile, line), profile)

    return grade


@dataclass
class Runs:
    """Runs of the reference simulator, computed once: a train of two pantographs, a weaker one, and a single one."""

    folder: Path
    evaluations: dict[str, Evaluation] = field(default_factory=dict)

    def load(self, name: str, uplift_force_N: float, twin: bool) -> Dossier:
        """Files of a run that passes a case with wide limits on both sides of each value."""
        files = {key: read_toml(SOURCE / f"{key}.toml", "file") for key in ("250", "line", "pantograph")}
        case = files["250"]
        case["id"], case["pantograph"][0]["uplift_force_N"] = f"own/{name}", uplift_force_N
        if twin:
            case["evaluated_spans"], case["spacing_m"] = [4, 5, 6], [100.0]
            case["pantograph"].append(deepcopy(case["pantograph"][0]))
        dossier = Dossier(case, files["line"], files["pantograph"], {}, {}, None)
        path = self.folder / f"{name}.h5"
        with tempfile.TemporaryDirectory() as scratch:
            write_dossier(Path(scratch), dossier)
            (loaded,) = select_cases([str(Path(scratch, "case", "250.toml"))])
        if not path.exists():
            print(f"run {name} ...", flush=True)
            outcome = ReferenceSimulator().run_unrefined(loaded)
            assert isinstance(outcome, Delivered)
            assert outcome.record is not None
            write_record(path, outcome.record, case=loaded.id)
        record, _ = read_record(path)
        supports = loaded.line.geometry.span_limits
        evaluation = evaluate_record(record, loaded.file.filter, supports)
        self.evaluations[name] = evaluation
        sidecar = read_toml(path.with_suffix(".toml"), "sidecar")
        dossier.sidecar = {key: value for key, value in sidecar.items() if key not in {"sha256", "case_digest"}}
        dossier.sidecar["file"] = "a.csv"
        assert record.contact_height is not None
        assert record.support_uplift is not None
        dossier.columns = {"time_s": record.time}
        for stem, rows in (
            ("position_{}_m", record.position),
            ("force_{}_N", record.force),
            ("contact_height_{}_m", record.contact_height),
            ("uplift_{}_m", record.support_uplift),
        ):
            dossier.columns |= {stem.format(i): row for i, row in enumerate(rows, 1)}
        case["limit"] = [
            _limit(quantity, owner, value - 0.2 * abs(value) - 1, value + 0.2 * abs(value) + 1)
            for owner, quantities in evaluation.values.items()
            for quantity, value in quantities.items()
            if quantity in COMPARED and isinstance(value, float)
        ]
        return dossier


def _limit(quantity: str, owner: int, lower: float, upper: float) -> dict[str, Any]:
    limit = {"quantity": quantity, "lower": lower, "upper": upper, "trust": "secondary", "source": "campaign"}
    return {**limit, "pantograph": owner} if owner else limit


def build_bases(runs: Runs) -> tuple[list[tuple[str, Dossier]], list[Base]]:
    """Runs that pass, and bases that do not."""
    twin, weak, single = (
        runs.load("twin", 120.0, True),
        runs.load("weak", 90.0, True),
        runs.load("single", 135.0, False),
    )
    twin.other = weak
    every = frozenset(group for group, _ in MANIPULATIONS)
    record_only = every - {"case", "limits"}
    bases = []

    def add(name: str, dossier: Dossier, groups: frozenset[str] = record_only, grade: Any = grade_run) -> None:
        bases.append(Base(name, dossier, groups, grade))

    def tightened(quantity: str, owner: int, **bounds: float) -> Dossier:
        dossier = twin.copy()
        others = [e for e in dossier.case["limit"] if (e["quantity"], e.get("pantograph", 0)) != (quantity, owner)]
        (limit,) = (e for e in twin.case["limit"] if e not in others)
        dossier.case["limit"] = [*others, {**limit, **bounds}]
        return dossier

    values = runs.evaluations["twin"].values
    start, end = twin.sidecar["evaluated_m"]
    supports = twin.sidecar["support_position_m"]
    inside = [i for i, x in enumerate(supports, 1) if start <= x <= end]
    uplift = {i: 1e3 * float(np.nanmax(twin.columns[f"uplift_{i}_m"])) for i in inside}
    worst = max(uplift, key=lambda i: uplift[i])
    between = 1.05 * uplift[worst]
    dossier = tightened("max_uplift_at_support_mm", 0, upper=between)
    dossier.columns[f"uplift_{worst}_m"] = 1.1 * twin.columns[f"uplift_{worst}_m"]
    add("uplift of one support too large", dossier)
    add("assess: uplift of one support too large", dossier, frozenset({"drop", "reexpress"}), grade_assessment(between))
    for owner in (1, 2):
        for quantity, share in (("std_force_N", 0.9), ("std_force_50_N", 0.9), ("max_force_N", 0.95)):
            value = values[owner][quantity]
            assert isinstance(value, float)
            add(f"{quantity} of pantograph {owner} too large", tightened(quantity, owner, upper=share * value))
        value = values[owner]["min_force_N"]
        assert isinstance(value, float)
        bounds = {"lower": value + 5, "upper": value + 50}
        add(f"min_force_N of pantograph {owner} too small", tightened("min_force_N", owner, **bounds))
    for quantity in ("std_force_N", "std_force_50_N"):
        both = [value for owner in (1, 2) if isinstance(value := values[owner][quantity], float)]
        dossier = twin.copy()
        upper = {"quantity": quantity, "upper": sum(both) / 2, "trust": "secondary", "source": "campaign"}
        dossier.case["limit"] = [{**upper, "pantograph": owner} for owner in (1, 2)]
        add(f"{quantity} of the worse pantograph too large, no other limit", dossier)
    for owner, quantities in values.items():
        for quantity in sorted(COMPARED & quantities.keys()):
            value = quantities[quantity]
            if isinstance(value, float) and value:
                name = f"{quantity} of {f'pantograph {owner}' if owner else 'the line'} outside by 0.01 %"
                for bound in ("upper", "lower"):
                    limit = value - OUTSIDE * abs(value) if bound == "upper" else value + OUTSIDE * abs(value)
                    add(f"{name} ({bound})", tightened(quantity, owner, **{bound: limit}), frozenset({"thin"}))
    for stem in ("contact_height", "uplift"):
        dossier = twin.copy()
        dossier.columns = {name: column for name, column in twin.columns.items() if not name.startswith(stem)}
        dossier.case["limit"] = [limit for limit in dossier.case["limit"] if stem not in limit["quantity"]]
        add(f"no {stem}, and no limit for it", dossier)
    dossier = twin.copy()
    dossier.case["spacing_m"] = [60.0]
    add("spacing of the case is another", dossier, record_only - {"positions"})
    dossier = twin.copy()
    dossier.columns |= {name: 0.9 * column for name, column in twin.columns.items() if name.startswith("force")}
    add("force 10 % too small", dossier, record_only - {"scale", "merge"})
    dossier = twin.copy()
    dossier.case["limit"] = []
    add("no limit", dossier)
    spoof = single.copy()
    spoof.case = {**read_toml(SOURCE / "250.toml", "case")}
    spoof.sidecar["case"] = spoof.case["id"]
    add("library case, mean force too large", spoof, every)
    return [("twin", twin), ("weak", weak), ("single", single)], bases


@dataclass(frozen=True)
class Trial:
    """Outcome of one trial."""

    base: str
    kinds: tuple[str, ...]
    verdict: str
    wrong: bool


def grade_trial(base: Base, dossier: Dossier, folder: Path) -> tuple[str, bool]:
    """Verdict of the files of a trial, and whether it is a wrong PASS."""
    try:
        write_dossier(folder, dossier)
    except (TypeError, ValueError):
        return "impossible", False
    try:
        results = base.grade(folder)
    except InputError:
        return "refused", False
    # Page 1 names a changed copy of a library case, and limits that a limits file weakens.
    named = any(case.library == "modified" or case.limit_changes for case in results.cases)
    return results.verdict, EXIT_CODES[results.verdict] == 0 and not named


def run_trial(bases: list[Base], number: int, seed: int, folder: Path) -> Trial:
    """Manipulate a base and grade it; the trial follows from its number and the seed."""
    chance = random.Random(f"{seed}/{number}")
    base = bases[number % len(bases)]
    dossier, kinds = base.dossier.copy(), list[str]()
    usable = [manipulate for group, manipulate in MANIPULATIONS if group in base.groups]
    wanted = chance.choice((1, 1, 1, 2, 3))
    while len(kinds) < wanted:
        if (kind := chance.choice(usable)(dossier, chance)) is not None:
            kinds.append(kind)
    verdict, wrong = grade_trial(base, dossier, folder)
    return Trial(base.name, tuple(kinds), verdict, wrong)


def run_campaign(out: Path, passing: list[tuple[str, Dossier]], bases: list[Base], count: int, seed: int) -> int:
    """Run all trials, print a summary and return the number of wrong verdicts."""
    faults = 0
    for name, dossier in passing:  # otherwise a campaign without a PASS would show nothing
        verdict, _ = grade_trial(Base(name, dossier, frozenset(), grade_run), dossier, out / "sound" / name)
        if verdict != "pass":
            faults += 1
            print(f"run {name}, which should pass: {verdict}")
    for base in bases:
        verdict, wrong = grade_trial(base, base.dossier, out / "sound" / base.name)
        faults += wrong
        print(f"base {base.name}: {verdict}{'  WRONG PASS' if wrong else ''}")
    verdicts, kinds, wrong_kinds = Counter[str](), Counter[str](), Counter[tuple[str, tuple[str, ...]]]()
    for number in range(count):
        with tempfile.TemporaryDirectory() as scratch:
            trial = run_trial(bases, number, seed, Path(scratch))
            verdicts[trial.verdict] += 1
            kinds.update(trial.kinds)
            if trial.wrong:
                wrong_kinds[trial.base, trial.kinds] += 1
                shutil.copytree(scratch, out / "wrong" / str(number), dirs_exist_ok=True)
                print(f"WRONG PASS {number}: {trial.base}; {'; '.join(trial.kinds)}", flush=True)
    wrong = sum(wrong_kinds.values())
    print(f"{count} manipulated subjects, {len(kinds)} distinct kinds: {dict(verdicts.most_common())}")
    print(f"{wrong} wrong PASS, {faults} faults of the bases")
    return wrong + faults


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("out", type=Path)
    parser.add_argument("--count", type=int, default=2500)
    parser.add_argument("--seed", type=int, default=20261121)
    parser.add_argument("--only", type=int)
    parser.add_argument("--group", choices=sorted({group for group, _ in MANIPULATIONS}))
    options = parser.parse_args()
    passing, bases = build_bases(Runs(options.out / "runs"))
    if options.group is not None:
        group = frozenset({options.group})
        bases = [replace(base, groups=group) for base in bases if options.group in base.groups]
    if options.only is None:
        sys.exit(bool(run_campaign(options.out, passing, bases, options.count, options.seed)))
    trial = run_trial(bases, options.only, options.seed, options.out / "trials" / str(options.only))
    print(trial)
    sys.exit(trial.wrong)


if __name__ == "__main__":
    main()
