"""Mutation sample of the product with the operators of cosmic-ray: share of changed places that related tests detect.

    python -m verification.attacks.mutation OUT [--mutants 60] [--folders conformance/grading ...] [--jobs 2]

OUT is a folder outside the checkout; the same command continues an ended run. Method and settings: docs/mutation.md.
"""

import argparse
import ast
import contextlib
import difflib
import filecmp
import hashlib
import json
import os
import queue
import re
import shutil
import signal
import subprocess
import sys
import threading
import tomllib
from collections.abc import Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from itertools import islice
from pathlib import Path
from typing import Any

from cosmic_ray.ast import ast_nodes, get_ast
from cosmic_ray.mutating import mutate_code
from cosmic_ray.plugins import get_operator
from scipy.stats import binomtest

CHECKOUT = Path(__file__).parents[2]
ROOTS = ("model", "conformance")
TESTED = ("tests/model", "tests/conformance")
COPIED = ("conformance", "model", "pantocheck", "reference_cases", "templates", "tests", "verification", "docs")
COPIED += ("examples", "pyproject.toml", "pytest_pantocheck.py", "README.md", "CHANGELOG.md")
SEED = 20261122
SERVER = Path(__file__).with_name("fork_server.py")
SUFFICIENT = 0.9
"""Share of killed mutants that every folder needs."""
COVERAGE_S = 7200.0
"""Largest processor time of the tests with their coverage [s]."""
SLOWER, EXTRA_S = 3.0, 30.0
"""A mutant whose tests need more than this multiple of their processor time, and this time [s], counts as killed."""
IDLE = 20.0
"""A mutant whose tests take this multiple of their largest processor time waits for ever, and counts as killed."""
NOT_FOR_TESTS, ASSERTION = re.compile(r"\s*@dataclass\(|if TYPE_CHECKING:"), re.compile(r"\bzip\(.*\bstrict=$")
"""Lines for the type checker, which finds assignments to frozen fields; text before an assertion of equal lengths."""
BOUND_TESTS = ("test_bounds_of_keys.py", "test_schemas.py")
"""Tests of the bounds of all keys of files, which name no model."""
OPERATORS = tuple(
    f"core/{name}"
    for name in (
        *(f"ReplaceComparisonOperator_{pair}" for pair in ("Lt_LtE", "LtE_Lt", "Gt_GtE", "GtE_Gt", "Lt_Gt", "Gt_Lt")),
        *(f"ReplaceComparisonOperator_{pair}" for pair in ("Eq_NotEq", "NotEq_Eq", "Is_IsNot", "IsNot_Is")),
        *(f"ReplaceBinaryOperator_{pair}" for pair in ("Add_Sub", "Sub_Add", "Mul_Div", "Div_Mul", "Pow_Mul")),
        *("ReplaceUnaryOperator_Delete_USub", "ReplaceUnaryOperator_Delete_Not", "AddNot", "NumberReplacer"),
        *("ReplaceTrueWithFalse", "ReplaceFalseWithTrue", "ReplaceAndWithOr", "ReplaceOrWithAnd"),
        *("ReplaceBreakWithContinue", "ReplaceContinueWithBreak", "ZeroIterationForLoop"),
    )
)


@dataclass(frozen=True)
class Mutant:
    """One change of one file."""

    file: str
    operator: str
    occurrence: int
    """Number of the place among those of the operator in the file, from 0."""

    @property
    def order(self) -> str:
        """Place in the sample: a digest, so that a change of one file leaves the sample of the others as it is."""
        return hashlib.sha256(f"{SEED} {self.file} {self.operator} {self.occurrence}".encode()).hexdigest()

    def mutate(self, source: str) -> str:
        """Source of the file with the change."""
        changed = mutate_code(source, get_operator(self.operator)(), self.occurrence)
        if changed is None:
            raise ValueError(f"{self.file} has no place {self.occurrence} of {self.operator}")
        return str(changed)


@dataclass
class Worker:
    """Private copy of the checkout, importable as the installed packages are."""

    place: Path
    environment: dict[str, str] = field(default_factory=dict)
    server: "subprocess.Popen[str] | None" = None
    """Process that runs the tests (`fork_server.py`), once it is needed."""

    @classmethod
    def create(cls, snapshot: Path, place: Path) -> "Worker":
        """Copy the snapshot, and link its folders below the names of the packages."""
        if not place.exists():
            shutil.copytree(snapshot, place, symlinks=True)
        names = place / ".names"
        names.mkdir(exist_ok=True)
        folders = tomllib.loads((place / "pyproject.toml").read_text("utf-8"))["tool"]["setuptools"]["package-dir"]
        for package, folder in folders.items():
            link = names / package.replace(".", "/")
            link.parent.mkdir(exist_ok=True)
            if "." in package and not link.is_symlink():
                link.symlink_to(place / folder, target_is_directory=True)
        path = os.pathsep.join([str(names), str(place)])
        settings = {"PYTHONPATH": path, "HYPOTHESIS_STORAGE_DIRECTORY": str(place / ".hypothesis")}
        return cls(place, {**os.environ, **settings})

    def run_tests(self, tests: list[str], limit_s: float, record: Path | None = None) -> tuple[int | None, float]:
        """Exit code of pytest, and its processor time [s], which other programs hardly change.

        With a file for the coverage, all tests run; else the run ends with the first failure.

        The code is None if a process needs more time than the limit [s], or if the tests wait for ever.
        """
        if self.server is None or self.server.poll() is not None:
            program = [sys.executable, "-c", SERVER.read_text("utf-8")]
            pipe = subprocess.PIPE
            self.server = subprocess.Popen(
                program, cwd=self.place, env=self.environment, stdin=pipe, stdout=pipe, text=True
            )
        assert self.server.stdin is not None
        assert self.server.stdout is not None
        arguments = ["-x", *tests] if record is None else tests
        request = [arguments, limit_s, None if record is None else str(record)]
        print(json.dumps(request), file=self.server.stdin, flush=True)
        group = int(self.server.stdout.readline())
        clock = threading.Timer(IDLE * limit_s, os.kill, (group, signal.SIGKILL))
        clock.start()
        status, seconds = json.loads(self.server.stdout.readline())
        clock.cancel()
        with contextlib.suppress(ProcessLookupError):
            os.killpg(group, signal.SIGKILL)
        code = os.waitstatus_to_exitcode(status)
        return None if code in {-signal.SIGXCPU, -signal.SIGKILL} else code, seconds

    def close(self) -> None:
        """End the server."""
        if self.server is not None:
            self.server.communicate()

    def write(self, file: str, source: str) -> None:
        """Write a source, and remove its compiled files, which Python compares by the second only."""
        path = self.place / file
        path.write_text(source, "utf-8")
        for compiled in (path.parent / "__pycache__").glob(f"{path.stem}.*"):
            compiled.unlink()


class CoveringTests:
    """Test files that execute each line of the product, from the coverage of one run of all tests."""

    def __init__(self, root: Path, records: Iterable[dict[str, Any]]) -> None:
        self.root = root
        self.lines: dict[str, dict[int, set[str]]] = {}
        self.seconds: dict[str, float] = {}
        for record in records:
            self.seconds |= record["seconds"]
            for file, lines in record["lines"].items():
                known = self.lines.setdefault(file, {})
                for line, tests in lines.items():
                    known.setdefault(int(line), set()).update(tests)

    def select(self, file: str, line: int) -> list[str]:
        """Test files that execute a line: the one of its name, those of the same folder, then the fastest.

        A line that runs at import belongs to every test of its file; those that mention its definition come first. The
        tests of all bounds precede them where the statement has the bounds of a key.
        """
        source = (self.root / file).read_text("utf-8")
        lines, names = self.lines.get(file, {}), name_definitions(source, line)
        statement = list_statement_lines(source, line)
        found = set().union(*(lines.get(number, set()) for number in statement)) or set().union(*lines.values())
        has_bounds = any("Field(" in source.splitlines()[number - 1] for number in statement)
        bounds = {test for test in self.seconds if has_bounds and Path(test).name in BOUND_TESTS}
        mention = re.compile(rf"\b({'|'.join(names)})\b")

        def rank(test: str) -> tuple[bool, bool, bool, bool, float]:
            text, path = (self.root / test).read_text("utf-8"), Path(test)
            near = path.parent == "tests" / Path(file).parent
            is_named = path.name == f"test_{Path(file).name}"
            return test not in bounds, not is_named, not mention.search(text), not near, self.seconds[test]

        return sorted(found | bounds, key=rank)


def list_statement_lines(source: str, line: int) -> range:
    """Lines of the innermost statement at a line; of a compound statement, those before its first inner one."""
    inside = [node for node in ast.walk(ast.parse(source)) if isinstance(node, ast.stmt)]
    inside = [node for node in inside if node.lineno <= line <= (node.end_lineno or 0)]
    if not inside:
        return range(line, line + 1)
    node = max(inside, key=lambda item: item.lineno)
    body = getattr(node, "body", None)
    return range(node.lineno, body[0].lineno if body else (node.end_lineno or line) + 1)


def _list_imports(path: Path) -> Iterator[str]:
    """Names of imported modules anywhere in a file."""
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            yield node.module


def name_definitions(source: str, line: int) -> list[str]:
    """Name of the public function, class or constant at a line; elsewhere those of all public ones of the file."""
    public = [n for n in ast.parse(source).body if isinstance(n, ast.FunctionDef | ast.ClassDef) and n.name[0] != "_"]
    changed = [node.name for node in public if node.lineno <= line <= (node.end_lineno or 0)]
    constant = re.match(r"[A-Z][A-Z0-9_a-z]+", source.splitlines()[line - 1])
    return changed or ([constant[0]] if constant else []) or [node.name for node in public]


def list_folders(root: Path) -> dict[str, list[str]]:
    """Files with code of every folder below `model` and `conformance`, subfolders included; no use of numba."""
    folders: dict[str, list[str]] = {}
    for top in ROOTS:
        for path in sorted((root / top).rglob("*.py")):
            parts = path.relative_to(root).parts
            imports = set(_list_imports(path))
            if "numba" not in imports and "llvmlite" not in imports:
                folders.setdefault("/".join(parts[:2]) if len(parts) > 2 else top, []).append("/".join(parts))
    return folders


def list_mutants(root: Path, file: str) -> Iterator[Mutant]:
    """All mutants of a file but those of kernels; annotations hold none of these operators but numbers of a literal."""
    source = (root / file).read_text("utf-8")
    lines, nodes = source.splitlines(), list(ast_nodes(get_ast(source)))
    functions = [node for node in ast.parse(source).body if isinstance(node, ast.FunctionDef)]
    kernels = [n for n in functions if any(ast.unparse(d).endswith("kernel") for d in n.decorator_list)]
    compiled = {line for node in kernels for line in range(node.lineno, (node.end_lineno or 0) + 1)}
    for name in OPERATORS:
        operator = get_operator(name)()
        places = [begin for node in nodes for begin, _ in operator.mutation_positions(node)]
        for occurrence, (line, column) in enumerate(places):
            text = lines[line - 1]
            if line not in compiled and not NOT_FOR_TESTS.match(text) and not ASSERTION.search(text[:column]):
                yield Mutant(file, name, occurrence)


def draw_sample(root: Path, files: list[str], size: int, known: list[dict[str, str]]) -> list[Mutant]:
    """First mutants of a folder in the order of their digests, without those that are listed as equivalent."""

    def is_equivalent(mutant: Mutant) -> bool:
        listed = [[f"-{item['line']}", f"+{item['mutant']}"] for item in known if item["file"] == mutant.file]
        changes = list_changes(root, mutant)[1:] if listed else []
        return [line[0] + line[1:].strip() for line in changes] in listed

    mutants = sorted((m for file in files for m in list_mutants(root, file)), key=lambda mutant: mutant.order)
    return list(islice((mutant for mutant in mutants if not is_equivalent(mutant)), size))


def list_changes(root: Path, mutant: Mutant) -> list[str]:
    """Number of the changed line, the line, and the changed one."""
    source = (root / mutant.file).read_text("utf-8")
    changed = mutant.mutate(source)
    lines = difflib.unified_diff(source.splitlines(), changed.splitlines(), "", "", "", "", 0, "")
    return [line for line in lines if not line.startswith(("---", "+++"))]


@dataclass
class Run:
    """Mutation run: snapshot, coverage of the test files, and outcomes, all stored in OUT."""

    out: Path
    tests: int
    budget_s: float
    renewed: bool = False
    """Whether the checkout is copied anew; only mutants that were killed in files that are as before are kept."""

    def __post_init__(self) -> None:
        self.snapshot = self.out / "snapshot"
        if self.renewed:
            self._forget()
        if not self.snapshot.exists():
            partial = self.out / "snapshot.partial"
            shutil.rmtree(partial, ignore_errors=True)
            partial.mkdir(parents=True)
            skipped = shutil.ignore_patterns("__pycache__", ".*", "generated", "gallery")
            for name in COPIED:
                if (CHECKOUT / name).is_dir():
                    shutil.copytree(CHECKOUT / name, partial / name, ignore=skipped)
                else:
                    shutil.copyfile(CHECKOUT / name, partial / name)
            partial.rename(self.snapshot)
        self.lock = threading.Lock()
        self.outcomes = {row["order"]: row for row in _read_rows(self.out / "outcomes.jsonl")}

    def _forget(self) -> None:
        """Remove the copies of the checkout and the outcomes that new sources or tests may change."""
        rows = _read_rows(self.out / "outcomes.jsonl")
        same = filecmp.cmpfiles(self.snapshot, CHECKOUT, {row["file"] for row in rows}, shallow=False)[0]
        rows = [row for row in rows if row["outcome"] == "killed" and row["file"] in same]
        (self.out / "outcomes.jsonl").write_text("".join(f"{json.dumps(row)}\n" for row in rows), "utf-8")
        for record in self.out.glob("coverage-*.json"):
            record.unlink()
        for folder in (self.snapshot, *self.out.glob("worker-*")):
            shutil.rmtree(folder, ignore_errors=True)

    def measure_coverage(self, workers: list[Worker]) -> None:
        """Run all tests once, shared between the workers; files that were measured before stay."""
        paths = [path for name in TESTED for path in sorted((self.snapshot / name).rglob("test_*.py"))]
        tests = [path.relative_to(self.snapshot).as_posix() for path in paths]
        records = [self.out / f"coverage-{number}.json" for number in range(len(workers))]

        def measure(number: int) -> None:
            if not records[number].exists():
                workers[number].run_tests(tests[number :: len(workers)], COVERAGE_S, records[number])

        with ThreadPoolExecutor(len(workers)) as pool:
            list(pool.map(measure, range(len(workers))))
        self.covering = CoveringTests(self.snapshot, [json.loads(record.read_text("utf-8")) for record in records])

    def judge(self, mutant: Mutant, worker: Worker) -> None:
        """Run the tests that execute the line of a mutant, and store its outcome."""
        source = (self.snapshot / mutant.file).read_text("utf-8")
        diff = list_changes(self.snapshot, mutant)
        tests: dict[str, float] = {}
        for file in self.covering.select(mutant.file, int(re.findall(r"\d+", diff[0])[0])):
            seconds = self.covering.seconds[file]
            if sum(tests.values()) + seconds <= self.budget_s and len(tests) < self.tests:
                tests[file] = seconds
        worker.write(mutant.file, mutant.mutate(source))
        try:
            code, _ = worker.run_tests([*tests], SLOWER * sum(tests.values()) + EXTRA_S) if tests else (0, 0.0)
        finally:
            worker.write(mutant.file, source)
        outcome = "untested" if not tests else "timeout" if code is None else "survived" if code == 0 else "killed"
        row = {"order": mutant.order, **vars(mutant), "outcome": outcome, "diff": diff, "tests": list(tests)}
        with self.lock:
            self.outcomes[mutant.order] = row
            _append_row(self.out / "outcomes.jsonl", row)


def _read_rows(path: Path) -> list[dict[str, Any]]:
    """Whole lines of a file; a last line that an interruption cut is removed."""
    text = path.read_text("utf-8") if path.exists() else ""
    whole = text[: text.rfind("\n") + 1]
    path.write_text(whole, "utf-8")
    return [json.loads(line) for line in whole.splitlines()]


def _append_row(path: Path, row: dict[str, Any]) -> None:
    with path.open("a", encoding="utf-8") as file:
        file.write(f"{json.dumps(row)}\n")


def report(folder: str, rows: list[dict[str, Any]]) -> bool:
    """Print the share of a folder and its survivors; whether enough mutants are killed."""
    killed = sum(row["outcome"] in {"killed", "timeout"} for row in rows)
    low, high = binomtest(killed, len(rows)).proportion_ci(method="wilson")
    share = killed / len(rows)
    print(f"{folder}: {killed} of {len(rows)} killed, {share:.0%} (95 % interval {low:.0%} to {high:.0%})", flush=True)
    for row in rows:
        if row["outcome"] in {"survived", "untested"}:
            print(f"  {row['outcome']} {row['file']} {row['operator']} {row['occurrence']}")
            print("\n".join(f"    {line}" for line in row["diff"]), flush=True)
    return share >= SUFFICIENT


def main() -> int:
    """Run the open mutants of all folders; exit code 1 if a folder has too few killed ones."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=Path)
    parser.add_argument("--mutants", type=int, default=60, help="size of the sample of each folder")
    parser.add_argument("--folders", nargs="*", help="default: all")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--tests", type=int, default=8, help="largest number of test files of a mutant")
    parser.add_argument("--budget", type=float, default=30.0, help="largest processor time of these [s]")
    parser.add_argument("--renew", action="store_true", help="copy the checkout anew, and judge what it may change")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    run = Run(options.out.resolve(), options.tests, options.budget, options.renew)
    known = tomllib.loads(Path(__file__).with_name("equivalent_mutants.toml").read_text("utf-8"))["equivalent"]
    all_workers = [Worker.create(run.snapshot, run.out / f"worker-{number}") for number in range(options.jobs)]
    run.measure_coverage(all_workers)
    workers: queue.SimpleQueue[Worker] = queue.SimpleQueue()
    for worker in all_workers:
        workers.put(worker)

    def judge(mutant: Mutant) -> None:
        if mutant.order not in run.outcomes:
            worker = workers.get()
            try:
                run.judge(mutant, worker)
            finally:
                workers.put(worker)

    sufficient = True
    for folder, files in list_folders(run.snapshot).items():
        if options.folders and folder not in options.folders:
            continue
        sample = draw_sample(run.snapshot, files, options.mutants, known)
        with ThreadPoolExecutor(options.jobs) as pool:
            list(pool.map(judge, sample))
        rows = [run.outcomes[mutant.order] for mutant in sample if mutant.order in run.outcomes]
        sufficient = (not rows or report(folder, rows)) and sufficient
    for worker in all_workers:
        worker.close()
    return 0 if sufficient else 1


if __name__ == "__main__":
    sys.exit(main())
