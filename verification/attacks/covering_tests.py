"""Choice of the tests for a mutant: those that execute its line, the nearest first."""

import ast
import re
from collections import defaultdict
from collections.abc import Iterable
from functools import reduce
from operator import or_
from pathlib import Path
from typing import Any

BOUND_TESTS = ("test_bounds_of_keys.py", "test_schemas.py")
"""Tests of the bounds of all keys of files, which name no model."""


class CoveringTests:
    """Tests that execute each line of the product, from the coverage of one run of all tests."""

    def __init__(self, root: Path, records: Iterable[dict[str, Any]]) -> None:
        self.root = root
        self.seconds: dict[str, float] = {}
        """Processor time by the name of the test, with its file [s]."""
        self.file_seconds: defaultdict[str, float] = defaultdict(float)
        self.lines: dict[str, dict[int, int]] = {}
        """Tests by file and line: the number whose bits are the places of the tests in `seconds`."""
        for record in records:
            begin = len(self.seconds)
            self.seconds |= record["seconds"]
            for file, lines in record["lines"].items():
                known = self.lines.setdefault(file, {})
                for line, tests in lines.items():
                    known[int(line)] = known.get(int(line), 0) | int(tests, 16) << begin
        for test, seconds in self.seconds.items():
            self.file_seconds[_name_file(test)] += seconds

    def select(self, file: str, line: int) -> list[str]:
        """Tests that execute a line: those in the file of its name, those of the same folder, then the fastest.

        A line that runs at import belongs to every test of its file, or to those that mention its definition if no test
        executes a line of the file; those that mention it come first. The tests of all bounds precede them where the
        statement has the bounds of a key.
        """
        source = (self.root / file).read_text("utf-8")
        lines, names = self.lines.get(file, {}), name_definitions(source, line)
        statement = list_statement_lines(source, line)
        at_import = runs_at_import(source, line)
        # A test that imports the file first executes these lines, and no other test does.
        bits = reduce(or_, lines.values() if at_import else (lines.get(number, 0) for number in statement), 0)
        found = {test for number, test in enumerate(self.seconds) if bits >> number & 1}
        has_bounds = any("Field(" in source.splitlines()[number - 1] for number in statement)
        bounds = {test for test in self.seconds if has_bounds and Path(_name_file(test)).name in BOUND_TESTS}
        mention = re.compile(rf"\b({'|'.join(names)})\b")
        texts = {name: (self.root / name).read_text("utf-8") for name in self.file_seconds}
        if at_import and not found:  # a file of declarations alone
            found = {test for test in self.seconds if names and mention.search(texts[_name_file(test)])}

        def rank(test: str) -> tuple[bool, bool, bool, bool, float]:
            path = Path(_name_file(test))
            near = path.parent == "tests" / Path(file).parent
            is_named = path.name == f"test_{Path(file).name}"
            mentioned = mention.search(texts[_name_file(test)])
            return test not in bounds, not is_named, not mentioned, not near, self.seconds[test]

        return sorted(found | bounds, key=rank)


def _name_file(test: str) -> str:
    return test.partition("::")[0]


def runs_at_import(source: str, line: int) -> bool:
    """Whether a line is in no body of a function."""
    functions = [node for node in ast.walk(ast.parse(source)) if isinstance(node, ast.FunctionDef)]
    return not any(node.body[0].lineno <= line <= (node.end_lineno or 0) for node in functions)


def list_statement_lines(source: str, line: int) -> range:
    """Lines of the innermost statement at a line; of a compound statement, those before its first inner one."""
    inside = [node for node in ast.walk(ast.parse(source)) if isinstance(node, ast.stmt)]
    inside = [node for node in inside if node.lineno <= line <= (node.end_lineno or 0)]
    if not inside:
        return range(line, line + 1)
    node = max(inside, key=lambda item: item.lineno)
    body = getattr(node, "body", None)
    return range(node.lineno, body[0].lineno if body else (node.end_lineno or line) + 1)


def name_definitions(source: str, line: int) -> list[str]:
    """Name of the public function, class or constant at a line; elsewhere those of all public ones of the file."""
    public = [n for n in ast.parse(source).body if isinstance(n, ast.FunctionDef | ast.ClassDef) and n.name[0] != "_"]
    changed = [node.name for node in public if node.lineno <= line <= (node.end_lineno or 0)]
    constant = re.match(r"[A-Z][A-Z0-9_a-z]+", source.splitlines()[line - 1])
    return changed or ([constant[0]] if constant else []) or [node.name for node in public]
