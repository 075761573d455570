"""Mutation run: share of single changes of the code that the tests detect. docs/mutation.md explains the method.

    python -m verification.attacks.mutation OUT [--mutants 600] [--areas verdict,kernels] [--jobs 2] [--seconds 7200]
    python -m verification.attacks.mutation OUT --list survived     list the mutants with an outcome
    python -m verification.attacks.mutation OUT --mutant ID         one mutant, with the report of its failing test

OUT is a folder outside the checkout. It holds the snapshot of the sources that is mutated, the traced runs, and
`results.json`. A run that was ended continues where it stopped. Exit code 1 if less than 90 % of the mutants of an area
are killed.
"""

import argparse
import difflib
import resource
import shutil
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from json import loads
from pathlib import Path
from typing import Any

from verification.attacks.mutation_mutants import Mutant
from verification.attacks.mutation_processes import Run, lock, preload, run_jobs, run_tests, write_json
from verification.attacks.mutation_project import Settings, Sources, copy_checkout, copy_tree, link_packages, packages
from verification.attacks.mutation_selection import Selection, Traces, has_kernels, select_tests
from verification.attacks.mutation_tracing import trace_tests

LEAST_KILLED = 0.9
COMPILE_S = 180.0
"""Time allowed for the compilation of kernels, on top of the start and of three times the tests."""
SURVIVED = ("survived", "untested")
"""Outcomes of a mutant that no test detects; no test executes the code of an untested mutant."""
UNRELIABLE_TESTS = 5
"""Largest number of tests that fail with and without a mutant; the mutant is left out if there are more."""


def main() -> int:
    """Run, continue or list a mutation run."""
    arguments = _parse_arguments()
    out, root = arguments.out.resolve(), arguments.root.resolve()
    if out.is_relative_to(root):
        sys.exit(f"{out}: lies inside the checkout {root}; give a folder outside it")
    out.mkdir(parents=True, exist_ok=True)
    results_file = out / "results.json"
    if arguments.list:
        return _list(loads(results_file.read_text(encoding="utf-8")), arguments.list)
    _ = lock(out)
    snapshot = out / "snapshot"
    if not snapshot.exists():
        shutil.rmtree(out / "unfinished", ignore_errors=True)
        copy_checkout(root, out / "unfinished")
        (out / "unfinished").rename(snapshot)
        link_packages(snapshot)
    settings = Settings.read(arguments.settings)
    if arguments.seed is not None:
        settings = replace(settings, seed=arguments.seed)
    sources = Sources(snapshot, settings)
    preload(["coverage", *settings.preload])
    patterns = [pattern for area in settings.areas.values() for pattern in area["files"]]
    if unmatched := [pattern for pattern in patterns if not sources.files([pattern])]:
        sys.exit(f"{arguments.settings.name}: no file matches {', '.join(unmatched)}")
    areas = arguments.areas.split(",") if arguments.areas else list(settings.areas)
    traces = _trace(sources, arguments, out)
    results = (
        loads(results_file.read_text(encoding="utf-8"))
        if results_file.exists()
        else {"seed": settings.seed, "mutants": {}, "reliable": []}
    )
    sample = _sample(sources, areas, arguments)
    jobs = partial(_jobs, sample, sources, traces, results, arguments)
    known = {mutant.id: (area, mutant) for area, mutant in sample}
    for identity, answer in run_jobs(jobs(), out, 1 if arguments.mutant else arguments.jobs):
        area, mutant = known[identity]
        results["reliable"] = sorted({*results["reliable"], *answer.pop("reliable")})
        results["mutants"][identity] = {"area": area, **_facts(mutant), **answer}
        write_json(results_file, results)
        print(f"{identity} {answer['outcome']:9} {answer['seconds']:6.1f} s  {_describe(mutant)}", flush=True)
        if arguments.mutant:
            print(_difference(mutant, sources), (out / "slot-0" / "log").read_text(encoding="utf-8"), sep="\n")
    for area, mutant in sample:
        if (reason := settings.equivalence(mutant)) is not None:
            entry = {"area": area, **_facts(mutant), "outcome": "equivalent", "reason": reason, "seconds": 0.0}
            results["mutants"][mutant.id] = entry
    write_json(results_file, results)
    return _summarise(results, {mutant.id: area for area, mutant in sample})


def _parse_arguments() -> argparse.Namespace:
    here = Path(__file__).resolve().parent
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=Path)
    parser.add_argument("--root", type=Path, default=here.parent, help="checkout to mutate")
    parser.add_argument("--settings", type=Path, default=here / "mutation.toml")
    parser.add_argument("--areas", help="areas, separated by commas; default all")
    parser.add_argument("--mutants", type=int, help="size of the sample, shared out like that of the settings")
    parser.add_argument("--seed", type=int)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--seconds", type=float, default=float("inf"), help="start no mutant after this time")
    parser.add_argument("--budget", type=float, default=60.0, help="processor time of the tests of a mutant [s]")
    parser.add_argument("--start", type=float, default=30.0, help="processor time allowed for the start of a run [s]")
    parser.add_argument("--tests", default="tests", help="test files and folders, separated by commas")
    parser.add_argument("--again", help="repeat mutants with this outcome, for example survived")
    parser.add_argument("--only", type=Path, help="results.json whose survivors are the sample")
    parser.add_argument("--mutant", help="id of a single mutant")
    parser.add_argument("--list", metavar="OUTCOME", help="list the mutants with this outcome and end")
    return parser.parse_args()


def _sample(sources: Sources, areas: list[str], arguments: argparse.Namespace) -> list[tuple[str, Mutant]]:
    """Sample of all areas in the order of the run: every area advances at the same pace."""
    if arguments.mutant or arguments.only:
        if arguments.only:
            entries = loads(arguments.only.read_text(encoding="utf-8"))["mutants"]
            wanted = {identity for identity, entry in entries.items() if entry["outcome"] in SURVIVED}
        else:
            wanted = {arguments.mutant}
        found = [(area, mutant) for area in areas for mutant in sources.mutants(area) if mutant.id in wanted]
        if missing := wanted - {mutant.id for _, mutant in found}:
            print(f"no such mutant: {', '.join(sorted(missing))}")
        return found
    sizes = {area: sources.settings.areas[area]["mutants"] for area in areas}
    if arguments.mutants is not None:
        total = sum(sizes.values())
        sizes = {area: max(1, round(size * arguments.mutants / total)) for area, size in sizes.items()}
    ranked = [
        (number / size, area, mutant)
        for area, size in sizes.items()
        for number, mutant in enumerate(sources.sample(area, size))
    ]
    return [(area, mutant) for _, area, mutant in sorted(ranked, key=lambda entry: entry[:2])]


def _trace(sources: Sources, arguments: argparse.Namespace, out: Path) -> Traces:
    """Traced runs of the test files, those of an earlier call from the folder of results."""
    folder = out / "traces"
    folder.mkdir(exist_ok=True)
    files = sources.test_files(arguments.tests.split(","))
    stored = {file: folder / (file.replace("/", "--") + ".json") for file in files}
    folders = list(packages(sources.tree).values())
    jobs = ((f, partial(trace_tests, sources.tree, f, folders)) for f in files if not stored[f].exists())
    for file, run in run_jobs(jobs, out, arguments.jobs):
        if "problem" in run:
            sys.exit(f"{file}: no traced run\n{run['problem']}")
        write_json(stored[file], run)
        failed = [test for test, facts in run["tests"].items() if not facts["passed"]]
        print(f"traced {file}: {len(run['tests'])} tests, {len(failed)} not passed and left out", flush=True)
        if failed:
            print("", *failed, sep="\n  ", flush=True)
    traces = Traces()
    for path in stored.values():
        traces.add(loads(path.read_text(encoding="utf-8")))
    if not traces.lines:
        sys.exit("the tests execute no line of the snapshot; do they import the project from another place?")
    return traces


def _jobs(
    sample: list[tuple[str, Mutant]], sources: Sources, traces: Traces, results: dict[str, Any], arguments: Any
) -> Iterator[tuple[str, Callable[[Path], dict[str, Any]]]]:
    end = time.monotonic() + arguments.seconds
    for _, mutant in sample:
        known = results["mutants"].get(mutant.id)
        repeated = bool(arguments.mutant) or (known is not None and known["outcome"] == arguments.again)
        if (known is None or repeated) and sources.settings.equivalence(mutant) is None:
            if time.monotonic() > end:
                print("time limit: call again to continue")
                return
            selection = select_tests(mutant, sources, traces, arguments.budget)
            limit = 3 * selection.seconds + arguments.start + (COMPILE_S if _is_kernel(mutant, sources) else 0.0)
            yield mutant.id, partial(try_mutant, mutant, sources, selection, limit, frozenset(results["reliable"]))


def try_mutant(
    mutant: Mutant, sources: Sources, selection: Selection, limit: float, reliable: frozenset[str], slot: Path
) -> dict[str, Any]:
    """Run the tests of a mutant in a private copy of the snapshot.

    A failing test counts if it passes in the same run without the mutant. Otherwise the mutant is repeated without it.
    """
    begin = time.monotonic()
    tests, unreliable = list(selection.tests), []
    newly_reliable: list[str] = []
    while tests and len(unreliable) <= UNRELIABLE_TESTS:
        copy_tree(sources.tree, slot / "tree")
        _mutate(mutant, sources, slot / "tree")
        run = run_tests(slot / "tree", tests, limit)
        if run.outcome not in ("failed", "timeout") or run.test in reliable:
            break
        if _passes_without(run, tests, sources, slot, limit):
            newly_reliable.append(str(run.test))
            break
        unreliable.append(str(run.test))
        tests = [test for test in tests if test != run.test and test.partition("::")[0] != run.test]
    else:
        run = Run("no tests", None, 0, 0.0)
    outcome = {"failed": "killed", "passed": "survived", "no tests": "untested"}.get(run.outcome, run.outcome)
    return {
        "outcome": outcome,
        "test": run.test,
        "tests_run": run.tests_run,
        "tests_selected": len(selection.tests),
        "tests_found": selection.found,
        "unreliable": unreliable,
        "seconds": round(time.monotonic() - begin, 2),
        "cpu_seconds": round(sum(resource.getrusage(resource.RUSAGE_CHILDREN)[:2]), 2),
        "reliable": newly_reliable,
    }


def _mutate(mutant: Mutant, sources: Sources, tree: Path) -> None:
    """Write the mutated file, and remove the compiled kernels of this file and of its users."""
    path = tree / mutant.file
    path.write_bytes(mutant.apply(path.read_bytes()))
    for cached in (path.parent / "__pycache__").glob(f"{path.stem}.*.pyc"):
        cached.unlink()
    if mutant.compiled:
        for file in sources.dependents(mutant.file):
            for cached in (tree / file).parent.glob(f"__pycache__/{Path(file).stem}.*.nb[ic]"):
                cached.unlink()


def _passes_without(run: Run, tests: list[str], sources: Sources, slot: Path, limit: float) -> bool:
    """Whether the failing test passes, after the same tests, without the mutant."""
    copy_tree(sources.tree, slot / "tree")
    before = tests[: tests.index(run.test) + 1] if run.test in tests else tests[: max(1, run.tests_run)]
    log = (slot / "log").read_bytes()
    repeated = run_tests(slot / "tree", before, limit)
    (slot / "log").write_bytes(log)
    return repeated.outcome == "passed"


def _is_kernel(mutant: Mutant, sources: Sources) -> bool:
    """Whether numba compiles files that use the mutated code."""
    return mutant.compiled and any(has_kernels(sources, file) for file in sources.dependents(mutant.file))


def _facts(mutant: Mutant) -> dict[str, Any]:
    names = ("file", "line", "scope", "operator", "change", "source")
    return {name: getattr(mutant, name) for name in names}


def _describe(mutant: Mutant) -> str:
    return f"{mutant.file}:{mutant.line} {mutant.operator}: {mutant.change}"


def _difference(mutant: Mutant, sources: Sources) -> str:
    before = sources.read(mutant.file)
    lines = (text.decode().splitlines() for text in (before, mutant.apply(before)))
    return "\n".join(difflib.unified_diff(*lines, mutant.file, mutant.id, n=2, lineterm=""))


def _list(results: dict[str, Any], outcome: str) -> int:
    entries = [(name, entry) for name, entry in results["mutants"].items() if entry["outcome"] == outcome]
    for name, entry in sorted(entries, key=lambda item: (item[1]["area"], item[1]["file"], item[1]["line"])):
        tests = f"{entry.get('tests_run', 0)} of {entry.get('tests_found', 0)} tests"
        print(f"{name} {entry['area']:14} {entry['file']}:{entry['line']} {entry['operator']}: {entry['change']}")
        print(f"{'':10} {entry['source']}   [{entry['test'] or tests}]")
    return 0


def _summarise(results: dict[str, Any], sample: dict[str, str]) -> int:
    """Print the score of each area; exit code 1 if one is below the limit or incomplete."""
    poor = False
    outcomes = ("killed", "timeout", *SURVIVED, "equivalent", "not run")
    print(f"{'area':15}", *(f"{outcome:>10}" for outcome in outcomes), f"{'score':>7} {'CPU s':>7}")
    for area in dict.fromkeys(sample.values()):
        names = [name for name, of_area in sample.items() if of_area == area]
        entries = [results["mutants"].get(name, {"outcome": "not run"}) for name in names]
        count = Counter(entry["outcome"] for entry in entries)
        killed = count["killed"] + count["timeout"]
        tried = killed + sum(count[outcome] for outcome in SURVIVED)
        score = killed / max(1, tried)
        poor |= score < LEAST_KILLED or count["not run"] > 0
        seconds = sum(entry.get("cpu_seconds", 0.0) for entry in entries) / max(1, tried)
        print(f"{area:15}", *(f"{count[outcome]:10}" for outcome in outcomes), f"{score:7.1%} {seconds:7.1f}")
    return int(poor)


if __name__ == "__main__":
    sys.exit(main())
