"""Selection of the tests that can notice a mutant, from the traced runs; the order in which to run them."""

import ast
import re
from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cache
from typing import Any

from verification.attacks.mutation_mutants import Mutant
from verification.attacks.mutation_operators import JIT_DECORATORS
from verification.attacks.mutation_project import Sources, imported_names

NEAR = 0.3
"""Weight of the time of a test whose file imports the mutated module: such a test is the likeliest to fail."""
COSTLY_S = 0.5
"""Shared fixtures that take longer keep the tests of a file together."""


@dataclass
class Traces:
    """Traced runs of all test files. Lines are bits of an integer, by file of the project and by context."""

    seconds: dict[str, float] = field(default_factory=dict)
    fixtures: dict[str, list[str]] = field(default_factory=dict)
    fixture_seconds: dict[str, float] = field(default_factory=dict)
    lines: dict[str, dict[str, int]] = field(default_factory=dict)

    def add(self, run: dict[str, Any]) -> None:
        """Add the run of one test file, without the tests that did not pass."""
        users: dict[str, list[str]] = {}
        for test, facts in run["tests"].items():
            if facts["passed"]:
                self.seconds[test] = facts["seconds"]
                self.fixtures[test] = facts["fixtures"]
                for context in (test, *facts["fixtures"]):
                    users.setdefault(context, []).append(test)
        self.fixture_seconds.update(run["fixtures"])
        for file, contexts in run["lines"].items():
            of_file = self.lines.setdefault(file, {})
            for context, numbers in contexts.items():
                mask = _mask(numbers)
                for test in users.get(context, ()):
                    of_file[test] = of_file.get(test, 0) | mask

    def tests(self, file: str, mask: int) -> set[str]:
        """Tests that execute any of the lines of a file."""
        return {test for test, lines in self.lines.get(file, {}).items() if lines & mask}

    def cost(self, test: str) -> float:
        """Time of a test that runs alone [s]."""
        return self.seconds[test] + sum(self.fixture_seconds.get(name, 0.0) for name in self.fixtures[test])


@dataclass(frozen=True)
class Selection:
    """Tests for a mutant within the budget of time, likeliest and fastest first; `found` counts all."""

    tests: list[str]
    found: int
    seconds: float


def select_tests(mutant: Mutant, sources: Sources, traces: Traces, budget: float) -> Selection:
    """Tests that can notice a mutant.

    In Python code these are the tests that execute its statement, or its function if no traced test does so. Compiled
    code and module-level values leave no trace: for these the tests are selected that execute their users, and all
    tests of a file that imports the module.
    """
    near = _test_importers(sources).get(mutant.file, set())
    if mutant.compiled:
        found = _tests_of_module(mutant, sources, traces)
        found |= {test for test in traces.seconds if test.partition("::")[0] in near}
    else:
        found = traces.tests(mutant.file, _mask(range(mutant.first_line, mutant.last_line + 1)))
        if not found:
            found = traces.tests(mutant.file, _mask(_function_around(sources, mutant)))
    rank = {test: traces.cost(test) * (NEAR if test.partition("::")[0] in near else 1.0) for test in found}
    groups: dict[str, str] = {}
    for test in found:
        together = sum(traces.fixture_seconds.get(name, 0.0) for name in traces.fixtures[test]) > COSTLY_S
        groups[test] = test.partition("::")[0] if together else test
    first: dict[str, float] = {}
    for test in found:
        first[groups[test]] = min(rank[test], first.get(groups[test], rank[test]))
    ordered = sorted(found, key=lambda test: (first[groups[test]], groups[test], rank[test], test))
    chosen, total, paid = [], 0.0, set()
    for test in ordered:
        new = [name for name in traces.fixtures[test] if name not in paid]
        total += traces.seconds[test] + sum(traces.fixture_seconds.get(name, 0.0) for name in new)
        if chosen and total > budget:
            break
        chosen.append(test)
        paid.update(new)
    return Selection(chosen, len(found), total)


def _tests_of_module(mutant: Mutant, sources: Sources, traces: Traces) -> set[str]:
    """Tests of the users of a module-level value or of a compiled function."""
    found: set[str] = set()
    if any(has_kernels(sources, file) for file in (mutant.file, *sources.importers.get(mutant.file, ()))):
        users, queue = {mutant.file}, [mutant.file]
        while queue:
            file = queue.pop()
            for importer in sources.importers.get(file, set()) - users:
                users.add(importer)
                if has_kernels(sources, importer):
                    queue.append(importer)
        found = set().union(*(traces.tests(file, _function_lines(sources, file)) for file in users))
    names = _names(sources, mutant)
    if names:
        pattern = re.compile(rf"\b(?:{'|'.join(map(re.escape, names))})\b")
        for file in (mutant.file, *sources.importers.get(mutant.file, ())):
            lines = sources.read(file).decode().splitlines()
            mentions = _mask(number for number, line in enumerate(lines, 1) if pattern.search(line))
            found |= traces.tests(file, mentions & _function_lines(sources, file))
    if mutant.scope or not found:
        found |= traces.tests(mutant.file, _function_lines(sources, mutant.file))
    if not found:
        for file in sources.importers.get(mutant.file, ()):
            found |= traces.tests(file, _function_lines(sources, file))
    return found


def _names(sources: Sources, mutant: Mutant) -> list[str]:
    """Names that the statement of a module-level mutant defines: its targets, or its class."""
    if mutant.scope:
        return [mutant.scope.partition(".")[0]]
    for statement in _parse(sources, mutant.file).body:
        if statement.lineno <= mutant.line <= (statement.end_lineno or 0):
            targets = statement.targets if isinstance(statement, ast.Assign) else [getattr(statement, "target", None)]
            return [node.id for target in targets if target for node in ast.walk(target) if isinstance(node, ast.Name)]
    return []


@cache
def _parse(sources: Sources, file: str) -> ast.Module:
    return ast.parse(sources.read(file))


@cache
def _functions(sources: Sources, file: str) -> list[ast.FunctionDef | ast.AsyncFunctionDef]:
    nodes = ast.walk(_parse(sources, file))
    return [node for node in nodes if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)]


@cache
def _function_lines(sources: Sources, file: str) -> int:
    """Lines of the bodies of all functions."""
    lines: set[int] = set()
    for function in _functions(sources, file):
        lines.update(range(function.body[0].lineno, (function.end_lineno or 0) + 1))
    return _mask(lines)


@cache
def has_kernels(sources: Sources, file: str) -> bool:
    """Whether a file has functions that numba compiles."""
    return any(
        re.search(rf"\b({'|'.join(JIT_DECORATORS)})\b", ast.unparse(decorator))
        for function in _functions(sources, file)
        for decorator in function.decorator_list
    )


def _function_around(sources: Sources, mutant: Mutant) -> range:
    around = [
        function
        for function in _functions(sources, mutant.file)
        if function.lineno <= mutant.line <= (function.end_lineno or 0)
    ]
    if not around:
        return range(0)
    inner = max(around, key=lambda function: function.lineno)
    return range(inner.body[0].lineno, (inner.end_lineno or 0) + 1)


@cache
def _test_importers(sources: Sources) -> dict[str, set[str]]:
    """Test files that import a file of the project, by that file."""
    importers: dict[str, set[str]] = {}
    for test in sources.test_files(["tests"]):
        for name in imported_names(_parse(sources, test)):
            if name in sources.modules:
                importers.setdefault(sources.modules[name], set()).add(test)
    return importers


def _mask(lines: Iterable[int]) -> int:
    mask = 0
    for line in lines:
        mask |= 1 << line
    return mask
