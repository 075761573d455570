"""Mutation operators: single changes of a source file, located by the syntax tree and made in the text.

Every change keeps the number of lines, so that line numbers of the mutant and of the original agree. Docstrings, texts,
type annotations, decorators, `__all__`, arguments of exceptions and of messages are never changed.
"""

import ast
import re
from dataclasses import dataclass

BOUNDARY = {ast.Lt: "<=", ast.LtE: "<", ast.Gt: ">=", ast.GtE: ">"}
NEGATION = {
    ast.Lt: ">=", ast.LtE: ">", ast.Gt: "<=", ast.GtE: "<", ast.Eq: "!=", ast.NotEq: "==",
    ast.Is: "is not", ast.IsNot: "is", ast.In: "not in", ast.NotIn: "in",
}  # fmt: skip
ARITHMETIC = {
    ast.Add: "-", ast.Sub: "+", ast.Mult: "/", ast.Div: "*", ast.FloorDiv: "*", ast.Mod: "*", ast.Pow: "*",
    ast.BitAnd: "|", ast.BitOr: "&",
}  # fmt: skip
TOKENS = {
    ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">=", ast.Eq: "==", ast.NotEq: "!=", ast.Is: "is",
    ast.IsNot: r"is\s+not", ast.In: "in", ast.NotIn: r"not\s+in", ast.Add: r"\+", ast.Sub: "-", ast.Mult: r"\*",
    ast.Div: "/", ast.FloorDiv: "//", ast.Mod: "%", ast.Pow: r"\*\*", ast.BitAnd: "&", ast.BitOr: r"\|",
}  # fmt: skip
OPPOSITES = (
    ("min", "max"), ("any", "all"), ("minimum", "maximum"), ("argmin", "argmax"), ("nanmin", "nanmax"),
    ("floor", "ceil"), ("sin", "cos"), ("first", "last"),
)  # fmt: skip
OPPOSITE = {**dict(OPPOSITES), **{b: a for a, b in OPPOSITES}}
ABSOLUTE = {"abs", "fabs", "absolute"}
MESSAGES = {"print", "warn", "debug", "info", "warning", "error", "exception", "log", "echo", "deprecated"}
"""Calls whose arguments are texts for a reader; the call itself may be dropped unless it only logs or prints."""
JIT_DECORATORS = {"njit", "jit", "vectorize", "guvectorize"}


@dataclass(frozen=True)
class Edit:
    """Replacement of the bytes [start, end[ of a file."""

    start: int
    end: int
    text: str


@dataclass(frozen=True)
class Change:
    """A change of the text with its place; fields as in `Mutant`."""

    line: int
    first_line: int
    last_line: int
    scope: str
    operator: str
    text: str
    compiled: bool
    edits: tuple[Edit, ...]


def normalise(line: str) -> str:
    """A source line with single spaces, as it stands in the list of equivalent mutants."""
    return " ".join(line.split())


class ChangeCollector(ast.NodeVisitor):
    """Collects the changes of a module."""

    def __init__(self, content: bytes) -> None:
        self.content = content
        self.starts = [0]
        for line in content.splitlines(keepends=True):
            self.starts.append(self.starts[-1] + len(line))
        self.changes: list[Change] = []
        self.functions: list[ast.FunctionDef | ast.AsyncFunctionDef] = []
        self.scopes: list[str] = []
        self.statement: ast.stmt | None = None

    # Positions and texts

    def _span(self, node: ast.AST) -> tuple[int, int]:
        start = self.starts[node.lineno - 1] + node.col_offset  # type: ignore[attr-defined]
        return start, self.starts[node.end_lineno - 1] + node.end_col_offset  # type: ignore[attr-defined]

    def _text(self, node: ast.AST) -> str:
        start, end = self._span(node)
        return self.content[start:end].decode()

    def _add(self, node: ast.AST, operator: str, text: str, *edits: Edit) -> None:
        statement = self.statement or node
        body = getattr(statement, "body", None)
        last = body[0].lineno - 1 if isinstance(body, list) and body else statement.end_lineno  # type: ignore[attr-defined]
        first = statement.lineno  # type: ignore[attr-defined]
        jitted = any(_is_jitted(function) for function in self.functions)
        self.changes.append(
            Change(
                node.lineno,  # type: ignore[attr-defined]
                first,
                max(last, first),
                ".".join(self.scopes),
                operator,
                text,
                jitted or not self.functions,
                edits,
            )
        )

    def _replace(self, node: ast.AST, operator: str, text: str) -> None:
        start, end = self._span(node)
        lines = self.content[start:end].count(b"\n")
        old = normalise(self._text(node))
        self._add(node, operator, f"{old} -> {text or 'nothing'}", Edit(start, end, text + "\n" * lines))

    def _replace_between(self, parts: tuple[ast.AST, ast.AST, ast.AST], operator: str, token: str, new: str) -> None:
        """Replace a token between two neighbours of a node; parts are the node and its neighbours."""
        node, left, right = parts
        start, end = self._span(left)[1], self._span(right)[0]
        gap = self.content[start:end].decode()
        match = None if "#" in gap else re.search(token, gap)
        if match:
            old = normalise(match[0])
            begin = start + len(gap[: match.start()].encode())
            self._add(node, operator, f"{old} -> {new}", Edit(begin, begin + len(match[0].encode()), new))

    def _wrap(self, node: ast.AST, operator: str, before: str, after: str) -> None:
        start, end = self._span(node)
        text = normalise(self._text(node))
        self._add(node, operator, f"{text} -> {before}{text}{after}", Edit(start, start, before), Edit(end, end, after))

    # Statements

    def visit(self, node: ast.AST) -> None:
        """Visit a node; a statement becomes the place of the changes inside it."""
        if isinstance(node, ast.stmt):
            before, self.statement = self.statement, node
            super().visit(node)
            self.statement = before
        else:
            super().visit(node)

    def visit_FunctionDef(self, node: ast.FunctionDef) -> None:
        """Change the defaults and the body, in the scope of the function; decorators and annotations stay."""
        for default in (*node.args.defaults, *node.args.kw_defaults):
            if default is not None:
                self.visit(default)
        self.functions.append(node)
        self.scopes.append(node.name)
        for child in node.body:
            self.visit(child)
        self.functions.pop()
        self.scopes.pop()

    visit_AsyncFunctionDef = visit_FunctionDef  # type: ignore[assignment]

    def visit_ClassDef(self, node: ast.ClassDef) -> None:
        """Change the body, in the scope of the class."""
        self.scopes.append(node.name)
        for child in node.body:
            self.visit(child)
        self.scopes.pop()

    def visit_If(self, node: ast.If) -> None:
        """Negate the condition; a block for type checkers alone stays."""
        if isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING":
            return
        self._negate(node.test)
        self.generic_visit(node)

    def visit_While(self, node: ast.While) -> None:
        """Negate the condition."""
        self._negate(node.test)
        self.generic_visit(node)

    def visit_IfExp(self, node: ast.IfExp) -> None:
        """Negate the condition."""
        self._negate(node.test)
        self.generic_visit(node)

    def visit_comprehension(self, node: ast.comprehension) -> None:
        """Keep the first element alone; negate each condition."""
        self._take_first(node.iter)
        for test in node.ifs:
            self._negate(test)
        self.generic_visit(node)

    def visit_For(self, node: ast.For) -> None:
        """Keep the first element alone."""
        self._take_first(node.iter)
        self.generic_visit(node)

    def visit_AnnAssign(self, node: ast.AnnAssign) -> None:
        """Drop the assignment of an attribute; change the value, not the type."""
        if node.value is not None:
            if isinstance(node.target, ast.Attribute):
                self._replace(node, "drop statement", "pass")
            self.visit(node.value)

    def visit_Assign(self, node: ast.Assign) -> None:
        """Drop the assignment of an attribute or element inside a function; `__all__` stays."""
        if any(isinstance(target, ast.Name) and target.id == "__all__" for target in node.targets):
            return
        if self.functions and any(isinstance(target, ast.Attribute | ast.Subscript) for target in node.targets):
            self._replace(node, "drop statement", "pass")
        self.generic_visit(node)

    def visit_AugAssign(self, node: ast.AugAssign) -> None:
        """Drop the statement; replace its operator."""
        self._replace(node, "drop statement", "pass")
        new = ARITHMETIC.get(type(node.op))
        if new and not _is_text(node.value):
            token = TOKENS[type(node.op)]
            self._replace_between((node, node.target, node.value), "arithmetic", token + "=", new + "=")
        self.generic_visit(node)

    def visit_Raise(self, node: ast.Raise) -> None:
        """Drop the statement; its arguments are a message."""
        self._replace(node, "drop raise", "pass")

    def visit_Assert(self, node: ast.Assert) -> None:
        """Change the condition; the message stays."""
        self.visit(node.test)

    def visit_Expr(self, node: ast.Expr) -> None:
        """Drop a call that does more than print a message; docstrings stay."""
        if isinstance(node.value, ast.Constant):
            return
        if isinstance(node.value, ast.Call) and _name(node.value.func) not in MESSAGES:
            self._replace(node, "drop statement", "pass")
        self.generic_visit(node)

    def visit_Continue(self, node: ast.Continue) -> None:
        """Drop the statement."""
        self._replace(node, "drop statement", "pass")

    def visit_Break(self, node: ast.Break) -> None:
        """Drop the statement."""
        self._replace(node, "drop statement", "pass")

    def visit_Return(self, node: ast.Return) -> None:
        """Drop a return without value; return None where the type of the function allows it."""
        if node.value is None:
            self._replace(node, "drop statement", "pass")
            return
        annotation = self.functions[-1].returns
        optional = annotation is not None and "None" in self._text(annotation)
        if optional and not (isinstance(node.value, ast.Constant) and node.value.value is None):
            self._replace(node.value, "return none", "None")
        self.generic_visit(node)

    # Expressions

    def visit_Compare(self, node: ast.Compare) -> None:
        """Move the boundary of a comparison; negate it."""
        operands = [node.left, *node.comparators]
        for left, operator, right in zip(operands, node.ops, operands[1:], strict=False):
            token = TOKENS[type(operator)]
            if type(operator) in BOUNDARY:
                self._replace_between((node, left, right), "boundary", token, BOUNDARY[type(operator)])
            self._replace_between((node, left, right), "comparison", token, NEGATION[type(operator)])
        self.generic_visit(node)

    def visit_BoolOp(self, node: ast.BoolOp) -> None:
        """Replace `and` by `or` and the reverse."""
        token, new = (r"\band\b", "or") if isinstance(node.op, ast.And) else (r"\bor\b", "and")
        for left, right in zip(node.values, node.values[1:], strict=False):
            self._replace_between((node, left, right), "connective", token, new)
        self.generic_visit(node)

    def visit_BinOp(self, node: ast.BinOp) -> None:
        """Replace an arithmetic operator; texts, lists and unions of types stay."""
        new = ARITHMETIC.get(type(node.op))
        masks = isinstance(node.op, ast.BitAnd | ast.BitOr)
        if new and not _is_text(node) and not (masks and (not self.functions or _is_union(node))):
            self._replace_between((node, node.left, node.right), "arithmetic", TOKENS[type(node.op)], new)
        self.generic_visit(node)

    def visit_UnaryOp(self, node: ast.UnaryOp) -> None:
        """Drop `not`, a minus sign or `~`."""
        names = {ast.Not: "drop not", ast.USub: "drop sign", ast.Invert: "drop not"}
        if type(node.op) in names:
            self._replace_token(node, names[type(node.op)])
        self.generic_visit(node)

    def _replace_token(self, node: ast.UnaryOp, operator: str) -> None:
        start, end = self._span(node)[0], self._span(node.operand)[0]
        text = normalise(self._text(node))
        gap = self.content[start:end].decode()
        kept = re.sub(r"^(not\b|-|~)\s*", "", gap)
        self._add(node, operator, f"{text} -> {normalise(self._text(node.operand))}", Edit(start, end, kept))

    def visit_Call(self, node: ast.Call) -> None:
        """Drop `abs`, call the opposite function, change the arguments; the call of a message stays."""
        name = _name(node.func)
        if name in MESSAGES:
            return
        if name in ABSOLUTE and len(node.args) == 1:
            start, end = self._span(node.func)
            self._add(node, "drop abs", f"{self._text(node.func)} -> nothing", Edit(start, end, ""))
        if name in OPPOSITE:
            end = self._span(node.func)[1]
            self._add(node, "opposite", f"{name} -> {OPPOSITE[name]}", Edit(end - len(name), end, OPPOSITE[name]))
        self.visit(node.func)
        for argument in node.args:
            self.visit(argument)
        for keyword in node.keywords:
            if not (name == "zip" and keyword.arg == "strict"):
                self.visit(keyword.value)

    def visit_Subscript(self, node: ast.Subscript) -> None:
        """Drop the bounds of a slice; replace index 0 by 1, 1 by 0 and a negative index by 0."""
        for part in node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]:
            if isinstance(part, ast.Slice):
                for bound in (part.lower, part.upper):
                    if bound is not None:
                        self._replace(bound, "slice", "")
            elif isinstance(part, ast.Constant) and part.value in (0, 1) and not isinstance(part.value, bool):
                self._replace(part, "index", str(1 - part.value))
                continue
            elif isinstance(part, ast.UnaryOp) and isinstance(part.operand, ast.Constant):
                self._replace(part, "index", "0")
                continue
            self.visit(part)
        self.visit(node.value)

    def visit_Constant(self, node: ast.Constant) -> None:
        """Replace a number: an integer by its neighbours, a real number by its double and its half."""
        value = node.value
        if isinstance(value, bool):
            self._replace(node, "constant", str(not value))
        elif isinstance(value, int):
            self._replace(node, "constant", str(value + 1))
            if value > 1:
                self._replace(node, "constant", str(value - 1))
        elif isinstance(value, float):
            self._replace(node, "constant", repr(2 * value) if value else "1.0")
            if value:
                self._replace(node, "constant", repr(value / 2))

    def visit_JoinedStr(self, node: ast.JoinedStr) -> None:
        """Keep a text with values: it is a message."""

    def _negate(self, test: ast.expr) -> None:
        # A comparison has its own negation, `not x` loses its `not`.
        if not isinstance(test, ast.Compare) and not (isinstance(test, ast.UnaryOp) and isinstance(test.op, ast.Not)):
            self._wrap(test, "negate condition", "not (", ")")

    def _take_first(self, values: ast.expr) -> None:
        if any(_is_jitted(function) for function in self.functions):
            return
        self._wrap(values, "first only", "[*", "][:1]")


def _is_jitted(function: ast.FunctionDef | ast.AsyncFunctionDef) -> bool:
    return any(
        _name(decorator.func if isinstance(decorator, ast.Call) else decorator) in JIT_DECORATORS
        for decorator in function.decorator_list
    )


def _name(node: ast.expr) -> str:
    if isinstance(node, ast.Attribute):
        return node.attr
    return node.id if isinstance(node, ast.Name) else ""


def _is_text(node: ast.AST) -> bool:
    """Whether an operand is a text or a list, for which arithmetic has another meaning."""
    if isinstance(node, ast.BinOp):
        return _is_text(node.left) or _is_text(node.right)
    if isinstance(node, ast.Constant):
        return isinstance(node.value, str | bytes)
    return isinstance(node, ast.JoinedStr | ast.List | ast.Tuple | ast.Dict)


def _is_union(node: ast.BinOp) -> bool:
    """Whether `a | b` is a union of types, as in isinstance(x, int | str)."""
    sides = (node.left, node.right)
    return any(
        (isinstance(side, ast.Constant) and side.value is None)
        or (isinstance(side, ast.BinOp) and _is_union(side))
        or _name(side) in {"str", "int", "float", "bool", "bytes", "list", "dict", "tuple"}
        or (_name(side)[:1].isupper() and not _name(side).isupper())
        for side in sides
    )
