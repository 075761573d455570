"""The page on thresholds: every value is that of the code, and no threshold of the verdict is missing."""

import ast
import re
from pathlib import Path
from types import ModuleType

import pytest

from pantocheck.conformance.authenticity import (
    authenticity_check,
    certificate_reading,
    pdf_comparison,
    pdf_structure,
    record_check,
    reported_numbers,
    rerun_check,
    text_differences,
    trace_check,
)  # fmt: skip
from pantocheck.conformance.authenticity.signatures import (
    certificates,
    cms_signing,
    detached_file,
    key_files,
    timestamp_client,
)
from pantocheck.conformance.cases import start_and_section
from pantocheck.conformance.comparison import (
    comparison_limits,
    drop_comparison,
    drop_motion,
    drop_statistics,
    force_difference,
    motion_bands,
    paired_forces,
    response_comparison,
    response_deviation,
    response_record,
    static_comparison,
    static_differences,
    static_record,
)
from pantocheck.conformance.consistency import (
    force_content,
    force_copy,
    force_dynamics,
    implied_force,
    mean_force,
    roll_off,
    rounding,
    support_coincidence,
    support_passing,
)
from pantocheck.conformance.grading import (
    assessed_record,
    baseline,
    discretisation,
    extended_band,
    procedure_verdict,
    record_mismatch,
    record_uncertainty,
    start_agreement,
    validity_warnings,
    verification_limits,
)
from pantocheck.conformance.identification import overlapping_bands
from pantocheck.conformance.identification.damping import damping_results
from pantocheck.conformance.procedure import compared_sides
from pantocheck.conformance.quantities import (
    bands,
    filters,
    force_signals,
    limit_text,
    line_signals,
    pantograph_signals,
    plug_in_quantity,
)
from pantocheck.conformance.records import events, record
from pantocheck.conformance.records.logger import arc_tables, track_position
from pantocheck.conformance.records.measured import (
    block_bootstrap,
    force_checks,
    record_preparation,
    usable_sections,
)
from pantocheck.conformance.results import contact_loss_list, input_values, results_part, results_reading, traces

ROOT = Path(__file__).parents[2]
ROWS = re.findall(
    r"^\| `(\w+)` \| ([^|]+) \| ([^|]+) \| ([^|]+) \| `([\w/]+\.py)` \|$",
    (ROOT / "docs" / "thresholds.md").read_text(encoding="utf-8"),
    re.MULTILINE,
)
MODULES: list[ModuleType] = [
    input_values, track_position, record_preparation, events, arc_tables, contact_loss_list,
    certificate_reading, authenticity_check, pdf_comparison, pdf_structure, record_check, reported_numbers, rerun_check,
    text_differences, trace_check,
    force_content, force_copy, force_dynamics, implied_force, mean_force, roll_off,
    rounding, support_coincidence, support_passing, assessed_record, baseline, discretisation,
    extended_band, record_mismatch, record_uncertainty, start_agreement, start_and_section, validity_warnings,
    verification_limits, bands, filters, force_signals, limit_text, line_signals, pantograph_signals, plug_in_quantity,
    record, block_bootstrap, force_checks, usable_sections,
    results_part, results_reading, traces, static_comparison, comparison_limits, static_differences, static_record,
    drop_comparison, drop_motion, drop_statistics, force_difference, paired_forces, motion_bands,
    response_comparison, response_deviation, response_record, procedure_verdict, compared_sides,
    certificates, cms_signing, detached_file, key_files, timestamp_client, damping_results, overlapping_bands,
]  # fmt: skip
BY_FILE = {"/".join(module.__name__.split(".")[2:]) + ".py": module for module in MODULES}
FOLDERS = ("quantities", "consistency", "grading", "records", "results", "authenticity", "comparison", "procedure")


def defined_numbers() -> set[tuple[str, str]]:
    """Names and files of the module-level numbers, and tuples of numbers, of the folders of the verdict."""
    numbers = set()
    for path in (path for folder in FOLDERS for path in (ROOT / "conformance" / folder).rglob("*.py")):
        for statement in ast.parse(path.read_text(encoding="utf-8")).body:
            if isinstance(statement, ast.Assign) and is_numeric(statement.value):
                names = [node.id for node in ast.walk(statement.targets[0]) if isinstance(node, ast.Name)]
                numbers |= {(name, str(path.relative_to(ROOT / "conformance"))) for name in names}
    return numbers


def is_numeric(value: ast.expr) -> bool:
    """Whether an expression consists of numbers alone."""
    leaves = [node for node in ast.walk(value) if isinstance(node, ast.Name | ast.Constant)]
    return bool(leaves) and all(
        isinstance(leaf, ast.Constant) and isinstance(leaf.value, int | float) for leaf in leaves
    )


@pytest.mark.parametrize(("name", "value", "file"), [(name, value, file) for name, value, _, _, file in ROWS])
def test_documented_value_is_that_of_the_code(name: str, value: str, file: str) -> None:
    """A digit group has no space after its comma, the numbers of a tuple have one."""
    numbers = tuple(float(number.replace(",", "")) for number in value.split(", "))
    code = getattr(BY_FILE[file], name)
    assert (code if isinstance(code, tuple) else (code,)) == numbers


def test_every_threshold_is_documented() -> None:
    documented = {(name, file) for name, _, _, _, file in ROWS}
    assert len(documented) == len(ROWS)
    key_of_the_line = ("LINE", "quantities/evaluation.py")
    assert defined_numbers() - {key_of_the_line} <= documented
