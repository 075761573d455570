"""Conditions of the values of the library cases: their changes by inputs that are not traced or left open.

python -m verification.tables.input_conditions [CASE ...] [--out reference_cases/conditions]

The uplift force of a case with a mean force is tuned anew for every change.
"""

import argparse
import datetime
import json
from collections.abc import Iterator, Sequence
from pathlib import Path

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.input_studies import ValueChange, ValueCondition
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.core.files import write_atomically
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.trust import StudiedPart
from pantocheck.conformance.records.record_signals import evaluate_record
from pantocheck.model.description.failures import SimulationError
from verification.formulations.library_passages import OTHER_PASSAGES
from verification.speed.passage_lines import QUANTITIES
from verification.tables.contact_findings import find_changes
from verification.tables.input_variations import (
    NotApplicable,
    list_changes,
    load_varied,
    read_variations,
    simulate_varied,
    vary_choice,
)
from verification.tables.resolving_power import CASES

OUT = Path("reference_cases/conditions")
COMMAND = "python -m verification.tables.input_conditions"
Values = dict[tuple[int, str], float]
"""Values by pantograph, 0 for the line, and quantity."""


def measure(case: Case, treatment: str | None = None) -> Values:
    """Quantities of the passage of a case, and the findings of its study."""
    record = simulate_varied(case, treatment).record
    found = evaluate_record(record, case.file.filter, case.line.geometry.supports).values
    values = {
        (owner, name): float(found[owner][name]) for owner in found for name in QUANTITIES if name in found[owner]
    }
    changes = find_changes(case, treatment) if case.dampings else {}
    return values | {(owner, name): float(value) for owner, row in changes.items() for name, value in row.items()}


def measure_conditions(case: Case) -> Iterator[ValueCondition]:
    """Effects of all tabled errors and choices on a case, those that it does not support included."""
    own = measure(case)
    for item in read_variations().input:
        for error in item.conditions:
            name = f"{item.name} {error:+g} {item.unit}"
            try:
                varied = load_varied(case, list_changes(case, item, error))
            except (NotApplicable, InputError) as problem:
                yield ValueCondition(name=name, group=item.group, not_applicable=" ".join(str(problem).split()))
                continue
            yield compare(name, item.group, own, measure(varied))
    for choice in read_variations().choice:
        try:
            changed = measure(vary_choice(case, choice), choice.treatment)
            yield compare(choice.name, choice.group, own, changed)
        except (NotApplicable, SimulationError) as problem:
            reason = " ".join(str(problem).split())
            yield ValueCondition(name=choice.name, group=choice.group, not_applicable=reason)


def compare(name: str, group: StudiedPart, own: Values, changed: Values) -> ValueCondition:
    """Change of every value relative to that with the inputs of the case."""
    changes = {key: round(100 * (changed[key] - value) / abs(value), 2) for key, value in own.items()}
    rows = (ValueChange(quantity=name, pantograph=owner, change_pct=pct) for (owner, name), pct in changes.items())
    return ValueCondition(name=name, group=group, change=tuple(rows))


def write_file(case: Case, conditions: Sequence[ValueCondition]) -> str:
    """Content of the file of a case."""
    lines = [
        f"# Written by {COMMAND}; do not edit.",
        'schema = "pantocheck.conditions/1"',
        f'case = "{case.id}"',
        f'case_digest = "{case.digest}"',
        f"date = {datetime.datetime.now(tz=datetime.UTC).date()}",
        f'command = "{COMMAND} {case.id}"',
    ]
    for condition in conditions:
        lines += ["", "[[condition]]", f"name = {json.dumps(condition.name)}", f'group = "{condition.group}"']
        if condition.not_applicable is not None:
            lines.append(f"not_applicable = {json.dumps(condition.not_applicable)}")
        else:
            rows = (row.model_dump().items() for row in condition.change)
            tables = (", ".join(f"{key} = {json.dumps(value)}" for key, value in row) for row in rows)
            lines += ["change = [", *(f"  {{ {table} }}," for table in tables), "]"]
    return "\n".join(lines) + "\n"


def main() -> None:
    """Compute and store."""
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("cases", nargs="*", default=(*CASES, *OTHER_PASSAGES), metavar="CASE")
    options.add_argument("--out", type=Path, default=OUT, help="folder to write to")
    chosen = options.parse_args()
    known = {case.id: case for case in select_cases(chosen.cases)}
    for name in chosen.cases:
        conditions = []
        for condition in measure_conditions(known[name]):
            print(name, condition, flush=True)
            conditions.append(condition)
        path = chosen.out / f"{name}.toml"
        path.parent.mkdir(parents=True, exist_ok=True)
        write_atomically(path, write_file(known[name], conditions).encode())


if __name__ == "__main__":
    main()
