"""List of the fixed numbers on which verdicts, checks and refusals depend, from the code."""

import ast
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from site_pages.markdown_table import build_markdown_table, escape_text

CONFORMANCE = Path(__file__).parents[2] / "conformance"
LEFT_OUT = {"app", "campaigns", "figure_style.py", "pages", "studies"}
"""Folders and files whose numbers decide on no verdict: layout of pages, progress, processes."""

Expression = ast.Constant | ast.UnaryOp | ast.BinOp | ast.Tuple


class Threshold(NamedTuple):
    """Fixed number, or tuple of numbers, of a module."""

    name: str
    value: object
    reason: str


def build_threshold_page() -> str:
    """Page with a table for every file that has thresholds."""
    parts = [
        "# Thresholds",
        "All fixed numbers on which verdicts, checks and refusals depend, with their reasons. Limits of quantities "
        "are in the case and profile files.",
    ]
    for path in sorted(CONFORMANCE.rglob("*.py")):
        place = path.relative_to(CONFORMANCE)
        found = [] if LEFT_OUT.intersection(place.parts) else list_thresholds(path)
        if rows := [_describe(threshold) for threshold in found]:
            parts += [f"## `{place.as_posix()}`", build_markdown_table(("name", "value", "meaning and reason"), rows)]
    return "\n\n".join(parts) + "\n"


def list_thresholds(path: Path) -> Iterator[Threshold]:
    """Numbers that a module defines; the text below one, or below a group of them, is its reason."""
    statements = ast.parse(path.read_text("utf-8")).body
    for place, statement in enumerate(statements):
        if isinstance(statement, ast.Assign) and (found := _evaluate(statement.value)) is not None:
            names = [node.id for node in ast.walk(statement.targets[0]) if isinstance(node, ast.Name)]
            for name, value in zip(names, found if len(names) > 1 else [found], strict=True):
                if not name.startswith("_"):
                    yield Threshold(name, value, _find_reason(statements[place + 1 :]))


def _evaluate(value: ast.expr) -> object:
    """Value of an expression of numbers alone; None for any other one."""
    nodes = [node for node in ast.walk(value) if isinstance(node, ast.expr)]
    numbers = [node.value for node in nodes if isinstance(node, ast.Constant)]
    plain = all(isinstance(node, Expression) for node in nodes)
    if not plain or not numbers or not all(type(number) in {int, float} for number in numbers):
        return None
    return eval(compile(ast.Expression(value), "", "eval"))


def _find_reason(following: list[ast.stmt]) -> str:
    for statement in following:
        if isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Constant):
            return " ".join(str(statement.value.value).split())
        if not isinstance(statement, ast.Assign) or _evaluate(statement.value) is None:
            break
    return ""


def _describe(threshold: Threshold) -> tuple[str, str, str]:
    values = threshold.value if isinstance(threshold.value, tuple) else (threshold.value,)
    return f"`{threshold.name}`", ", ".join(_format_value(value) for value in values), escape_text(threshold.reason)


def _format_value(value: float | tuple[float, ...]) -> str:
    """Number of a threshold, or several that belong together in brackets."""
    if isinstance(value, tuple):
        return f"({', '.join(_format_value(part) for part in value)})"
    return f"{value:,.10g}"
