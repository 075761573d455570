"""Docstrings of the product: Google style, with the arguments of the signature, and fields described below them."""

import ast
import inspect
import re
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path

import pantocheck.conformance
import pantocheck.model

FOLDERS = [Path(module.__file__).parent for module in (pantocheck.conformance, pantocheck.model)]


@cache
def list_nodes() -> list[tuple[str, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef]]:
    """Place and syntax tree of every function and class."""
    return [
        (f"{path.parent.name}/{path.name}:{node.lineno} {node.name}", node)
        for folder in FOLDERS
        for path in sorted(folder.rglob("*.py"))
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef)
    ]


ENTRY = re.compile(r"^ {4}(\*{0,2}\w+(?:, \w+)*)(.*)$", re.MULTILINE)
EXCEPTION = re.compile(r"[\w.]+(?:, [\w.]+)*: \S")


def read_section(docstring: str, title: str) -> str:
    """Indented text below the title of a section; empty without the section."""
    found = re.search(rf"^{title}:\n((?:(?: {{4}}.*)?(?:\n|\Z))+)", docstring, re.MULTILINE)
    return found[1] if found else ""


def list_arguments(docstring: str) -> list[str]:
    """Names in the section `Args`."""
    heads = [match[1] for match in ENTRY.finditer(read_section(docstring, "Args"))]
    return [name.lstrip("*") for head in heads for name in head.split(", ")]


def list_signature(function: ast.FunctionDef | ast.AsyncFunctionDef) -> list[str]:
    """Names of the arguments of a function."""
    given = function.args
    named = [*given.posonlyargs, *given.args, given.vararg, *given.kwonlyargs, given.kwarg]
    return [argument.arg for argument in named if argument and argument.arg not in ("self", "cls")]


def list_fields(definition: ast.ClassDef) -> list[ast.AnnAssign]:
    """Annotated fields of a class."""
    return [part for part in definition.body if isinstance(part, ast.AnnAssign)]


def find_init(node: ast.AST) -> ast.FunctionDef | None:
    """Method `__init__` of a class."""
    found = (part for part in getattr(node, "body", ()) if getattr(part, "name", "") == "__init__")
    return next((part for part in found if isinstance(part, ast.FunctionDef)), None)


def public_functions() -> Iterator[tuple[str, Callable[..., object]]]:
    """Public functions, and public methods of the public classes."""
    for module in (pantocheck.conformance, pantocheck.model):
        for item in (getattr(module, name) for name in module.__all__):
            methods = vars(item).items() if inspect.isclass(item) else [(getattr(item, "__name__", ""), item)]
            for name, method in methods:
                function = method.__func__ if isinstance(method, classmethod | staticmethod) else method
                if inspect.isfunction(function) and not name.startswith("_"):
                    yield f"{function.__module__}.{function.__qualname__}", function


def test_sections_are_those_of_google_style_without_types() -> None:
    wrong = [
        place for place, node in list_nodes() if re.search(r"^-{3,}$", ast.get_docstring(node) or "", re.MULTILINE)
    ]
    assert wrong == []
    wrong = [
        f"{place}: {match[0].strip()}"
        for place, node in list_nodes()
        for match in ENTRY.finditer(read_section(ast.get_docstring(node) or "", "Args"))
        if not re.match(r": \S", match[2])
    ]
    assert wrong == []
    wrong = [
        f"{place}: {line.strip()}"
        for place, node in list_nodes()
        for line in read_section(ast.get_docstring(node) or "", "Raises").splitlines()
        if re.match(r" {4}\S", line) and not EXCEPTION.match(line.strip())
    ]
    assert wrong == []


def test_documented_arguments_are_those_of_the_signature() -> None:
    wrong = []
    for place, node in list_nodes():
        documented = list_arguments(ast.get_docstring(node) or "")
        function = find_init(node) if isinstance(node, ast.ClassDef) else node
        if documented and (function is None or sorted(documented) != sorted(list_signature(function))):
            wrong.append(f"{place}: documents {documented}")
    assert wrong == []


def test_public_functions_document_their_arguments() -> None:
    wrong = [
        name
        for name, function in public_functions()
        if set(inspect.signature(function).parameters) - {"self", "cls"}
        and not list_arguments(inspect.getdoc(function) or "")
    ]
    assert wrong == []


def test_fields_are_described_below_them() -> None:
    """One text for a field: neither a section of the class nor a description in `Field`."""
    wrong = []
    for place, node in list_nodes():
        if isinstance(node, ast.ClassDef) and list_fields(node) and find_init(node) is None:
            docstring = ast.get_docstring(node) or ""
            sections = [title for title in ("Args", "Attributes") if read_section(docstring, title)]
            wrong += [f"{place}: {title}" for title in sections]
            wrong += [
                f"{place}: description of {ast.unparse(field.target)}"
                for field in list_fields(node)
                for call in ast.walk(field)
                if isinstance(call, ast.Call) and any(keyword.arg == "description" for keyword in call.keywords)
            ]
    assert wrong == []
