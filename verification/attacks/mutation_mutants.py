"""Mutants of a source file: their identity and their text."""

import ast
import hashlib
import warnings
from collections import Counter
from dataclasses import dataclass

from verification.attacks.mutation_operators import ChangeCollector, Edit, normalise


@dataclass(frozen=True)
class Mutant:
    """One change of one file.

    `id` is made of the file, the source line without its white space, the operator and the change, so that it survives
    line shifts. `first_line` and `last_line` enclose the statement, without the body of a compound statement.
    `compiled` is true for code that numba may compile and for values of modules and classes.
    """

    id: str
    file: str
    line: int
    first_line: int
    last_line: int
    scope: str
    operator: str
    change: str
    source: str
    compiled: bool
    edits: tuple[Edit, ...]

    def apply(self, content: bytes) -> bytes:
        """Content of the mutated file."""
        for edit in sorted(self.edits, key=lambda edit: -edit.start):
            content = content[: edit.start] + edit.text.encode() + content[edit.end :]
        return content


def find_mutants(file: str, content: bytes) -> list[Mutant]:
    """Every mutant of a source file, in the order of the text; of equal mutants the first. Some may not compile."""
    visitor = ChangeCollector(content)
    visitor.visit(ast.parse(content))
    lines = content.decode().splitlines()
    occurrences: Counter[tuple[str, str, str]] = Counter()
    texts = {content}
    mutants = []
    for change in sorted(visitor.changes, key=lambda change: (change.edits[0].start, change.operator, change.text)):
        source = normalise(lines[change.line - 1])
        occurrences[source, change.operator, change.text] += 1
        key = (file, source, change.operator, change.text, str(occurrences[source, change.operator, change.text]))
        mutant = Mutant(
            hashlib.sha256("\0".join(key).encode()).hexdigest()[:10],
            file,
            change.line,
            change.first_line,
            change.last_line,
            change.scope,
            change.operator,
            change.text,
            source,
            change.compiled,
            change.edits,
        )
        text = mutant.apply(content)
        if text not in texts:
            texts.add(text)
            mutants.append(mutant)
    return mutants


def compiles(mutant: Mutant, content: bytes) -> bool:
    """Whether the mutated file is valid Python."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            compile(mutant.apply(content), mutant.file, "exec", dont_inherit=True)
        except (SyntaxError, ValueError):
            return False
    return True
