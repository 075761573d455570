"""Tables of the documentation: run their programs, and write the files of docs/tables that the pages show.

python -m verification.tables                 every table; takes hours
python -m verification.tables NAME ...        the tables of these programs
python -m verification.tables --list          names, files and commands
"""

import argparse
import contextlib
import csv
import io
import os
import re
import runpy
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

DOCS = Path(__file__).parents[2] / "docs"
TABLES = DOCS / "tables"
BLOCK = re.compile(r"^(?:\|.*\|\n)+", re.MULTILINE)


class Program(NamedTuple):
    """Program that prints tables in Markdown."""

    module: str
    """Module below `verification`."""
    files: tuple[str, ...]
    """Names of the files, one for each table in the order of the output; a single name takes the rows of all tables."""
    arguments: str = ""
    """{docs} is the folder of the pages, {drops} that of the records with known modes (DROPS in the environment)."""
    preparation: str = ""
    """Arguments of `pantocheck` for a run before; {folder} is a temporary folder."""


PROGRAMS = {
    "convergence-of-cases": Program("tables.convergence_of_cases", ("convergence-of-cases",)),
    "accuracy-and-cost": Program(
        "speed.accuracy_and_cost", ("accuracy-and-cost",), "--out {docs}/accuracy-and-cost.svg"
    ),
    "run-in": Program("tables.run_in", ("run-in-275", "run-in-320")),
    "force-law": Program("tables.law_balance", ("force-law-level", "force-law-gradient")),
    "overlap": Program(
        "tables.overlap_passages", tuple(f"overlap-{name}" for name in ("forces", "difference", "mesh"))
    ),
    "filter-and-band": Program("tables.filter_and_band", ("filters", "bands")),
    "readings": Program("tables.readings", ("readings-forces", "readings-bands", "readings-editions")),
    "calibration-start": Program("tables.uncertainty_coverage", ("calibration-start",), "start"),
    "calibration-run-in": Program("tables.uncertainty_coverage", ("calibration-run-in",), "run-in"),
    "calibration-section": Program("tables.uncertainty_coverage", ("calibration-section",), "section"),
    "calibration-mesh": Program("tables.uncertainty_coverage", ("calibration-mesh",), "discretisation"),
    "coverage-simulated": Program("tables.coverage_simulated", ("coverage-simulated",)),
    "coverage": Program("tables.coverage", ("coverage", "coverage-worst")),
    "parquet-queries": Program("tables.parquet_queries", ("parquet-queries",)),
    "clock-findings": Program("tables.clock_findings", ("clock-findings",)),
    "copy-thresholds": Program("tables.copy_thresholds", ("copy-thresholds",)),
    "exact-model": Program("formulations.exact_model", ("exact-plane", "exact-stagger", "exact-change")),
    "exact-model-fine": Program("formulations.exact_model", ("exact-fine",), "--element 0.125 --stagger 0"),
    "exact-model-fine-stagger": Program(
        "formulations.exact_model",
        ("exact-fine-stagger",),
        "--element 0.125 --stagger 0.2 --models reference-free exact-free",
    ),
    "messenger-motion": Program(
        "formulations.messenger_motion", ("messenger-tangent", "messenger-passage", "messenger-difference")
    ),
    "modelling-choices": Program("formulations.modelling_choices", ("choices-250", "choices-300", "choices-twin")),
    "spacing-resonance": Program(
        "tables.spacing_resonance",
        ("spacing-resonance",),
        "{folder}/campaign.csv --out {docs}/pantograph-spacing.svg",
        "campaign campaigns/ac-simple-spacing --out {folder}",
    ),
    "study-findings": Program(
        "tables.study_findings",
        ("study-findings",),
        "{folder}/results.json",
        "run vovan2015/* --formats json --out {folder}",
    ),
    "null-model": Program(
        "tables.null_model",
        ("null-model", "null-findings"),
        "{folder}/results.json",
        "run vovan2015/* --formats json --out {folder}",
    ),
    "printed-table": Program("tables.printed_table", ("printed-table",)),
    "self-test": Program("tables.self_test_tables", ("self-test-mutants", "self-test-numerical", "self-test-mild")),
    "forgeries": Program(
        "attacks.forgeries", ("forged-results", "forged-pdf", "forged-html", "forged-consistent"), "--jobs 2"
    ),
    "adversary": Program("attacks.adversary", ("adversary",)),
    "table-sensitivity": Program("tables.table_sensitivity", ("table-sensitivity",)),
    "contact-findings": Program("tables.contact_findings", ("contact-findings",)),
    "constraint-limit": Program("tables.constraint_limit", ("constraint-limit",)),
    "pantograph-fit": Program("tables.pantograph_fit", ("pantograph-fit",)),
    "identification": Program("tables.identification", ("identification-scores",), "{drops} --made-up 6"),
    "disturbances": Program("tables.drop_disturbances", ("disturbances", "disturbances-tensions"), "{drops}"),
    "field-coverage": Program("tables.field_coverage", ("field-coverage", "field-modes"), "{docs}/field-records.csv"),
    "sampled-modes": Program("tables.sampled_modes", ("sampled-modes",), "--draws 84"),
    "line-coverage": Program("tables.line_coverage", ("line-coverage",), "{docs}/line-fits.csv"),
    "line-hold-out": Program("tables.line_hold_out", ("line-hold-out",), "{docs}/line-hold-out.csv"),
    "network-detection": Program(
        "tables.network_detection", ("network-detection", "network-cost"), "--seeds 1 2026 --lines 11"
    ),
    "dropper-limit": Program("tables.dropper_limit", ("dropper-limit",)),
    "fmu-coupling": Program("fmu.coupling_table", ("fmu-coupling",)),
    "fmu-line": Program("fmu.line_coupling", ("fmu-line", "fmu-importers")),
    "rig-accuracy": Program("rig.rig_accuracy", ("rig-accuracy",)),
    "rig-times": Program("rig.rig_hour", ("rig-times",)),
    "speed": Program("speed.speed", ("speed-plane", "speed-length", "speed-refactorised", "speed-engine")),
    "commands": Program("speed.commands", ("speed-commands",)),
    "installation": Program("speed.installation", ("installation",)),
}


def read_tables(text: str) -> list[list[list[str]]]:
    """Tables of a text in Markdown: rows of cells, the heading first."""
    blocks = [block.group().splitlines() for block in BLOCK.finditer(text)]
    rows = [[[cell.strip() for cell in line.strip("|").split("|")] for line in block] for block in blocks]
    return [[table[0], *table[2:]] for table in rows]


def write_tables(text: str, files: Sequence[str], folder: Path) -> None:
    """Write the tables of an output.

    Args:
        text: Output of a program.
        files: Names of the files without ending.
        folder: Folder of the files.

    Raises:
        ValueError: The output has another number of tables.
    """
    tables = read_tables(text)
    if len(files) == 1 and tables:
        tables = [[tables[0][0], *(row for table in tables for row in table[1:])]]
    if len(tables) != len(files):
        raise ValueError(f"{len(tables)} tables in place of {len(files)}: {', '.join(files)}")
    for name, rows in zip(files, tables, strict=True):
        with (folder / f"{name}.csv").open("w", encoding="utf-8", newline="") as file:
            csv.writer(file, lineterminator="\n").writerows(rows)


class Copy(io.StringIO):
    """Text of an output, which is printed, too."""

    def write(self, text: str) -> int:
        """Keep and print a text."""
        sys.__stdout__.write(text)  # type: ignore[union-attr]
        return super().write(text)


def run_program(program: Program) -> None:
    """Run a program with its preparation, and write its tables."""
    with tempfile.TemporaryDirectory() as folder:
        places = {"folder": folder, "docs": str(DOCS), "drops": os.environ.get("DROPS", "")}
        if program.preparation:
            arguments = program.preparation.format(**places).split()
            subprocess.run([sys.executable, "-m", "pantocheck", *arguments], check=False)
        sys.argv = [program.module, *program.arguments.format(**places).split()]
        with contextlib.redirect_stdout(Copy()) as output, contextlib.suppress(SystemExit):
            runpy.run_module(f"verification.{program.module}", run_name="__main__")
    write_tables(output.getvalue(), program.files, TABLES)


def main() -> None:
    """List or run the programs."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"default: all of {', '.join(PROGRAMS)}")
    parser.add_argument("--list", action="store_true")
    options = parser.parse_args()
    for name in options.names or PROGRAMS:
        if options.list:
            print(f"{name}: {', '.join(PROGRAMS[name].files)}; {PROGRAMS[name].module} {PROGRAMS[name].arguments}")
        else:
            run_program(PROGRAMS[name])


if __name__ == "__main__":
    main()
