"""Mutants of the product with the operators of cosmic-ray, and the sample of a folder."""

import ast
import difflib
import hashlib
import re
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

from cosmic_ray.ast import ast_nodes, get_ast
from cosmic_ray.mutating import mutate_code
from cosmic_ray.plugins import get_operator

ROOTS = ("model", "conformance")
SEED = 20261122
NOT_FOR_TESTS, ASSERTION = re.compile(r"\s*@dataclass\(|if TYPE_CHECKING:"), re.compile(r"\bzip\(.*\bstrict=$")
"""Lines for the type checker, which finds assignments to frozen fields; text before an assertion of equal lengths."""
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


def _list_imports(path: Path) -> Iterator[str]:
    """Names of imported modules anywhere in a file."""
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            yield node.module


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
    """First mutants of a folder in the order of their digests, but those listed as equivalent and those no Python."""

    def counts(mutant: Mutant) -> bool:
        try:
            ast.parse(mutant.mutate((root / mutant.file).read_text("utf-8")))
        except SyntaxError:  # such as `not` before an assignment expression
            return False
        listed = [[f"-{item['line']}", f"+{item['mutant']}"] for item in known if item["file"] == mutant.file]
        changes = list_changes(root, mutant)[1:] if listed else []
        return [line[0] + line[1:].strip() for line in changes] not in listed

    mutants = sorted((m for file in files for m in list_mutants(root, file)), key=lambda mutant: mutant.order)
    return list(islice(filter(counts, mutants), size))


def list_changes(root: Path, mutant: Mutant) -> list[str]:
    """Number of the changed line, the line, and the changed one."""
    source = (root / mutant.file).read_text("utf-8")
    changed = mutant.mutate(source)
    lines = difflib.unified_diff(source.splitlines(), changed.splitlines(), "", "", "", "", 0, "")
    return [line for line in lines if not line.startswith(("---", "+++"))]
