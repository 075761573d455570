"""Graded results in Python: verdict, criteria, and the files of a report."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pantocheck.conformance.app.notebook.display import describe_in_one_line, tabulate_rows, warn_missing_formats
from pantocheck.conformance.cases.profile_file import load_profile
from pantocheck.conformance.comparison.profile_grading import assess_record
from pantocheck.conformance.core.files import check_writable
from pantocheck.conformance.core.texts import count_noun
from pantocheck.conformance.core.trust import Trust
from pantocheck.conformance.core.verdicts import Verdict
from pantocheck.conformance.execution.plan import Plan, prepare_plan
from pantocheck.conformance.execution.runner import run_cases
from pantocheck.conformance.grading.assessed_record import load_assessed_record
from pantocheck.conformance.pages.report_writers import write_all
from pantocheck.conformance.records.sidecar_tables import LineTable
from pantocheck.conformance.results.report_files import Language, check_formats
from pantocheck.conformance.results.results_format import Results
from pantocheck.conformance.results.results_reading import read_results
from pantocheck.conformance.runs.system_choice import choose_system


@dataclass(frozen=True)
class GradedResults:
    """Results of a run of the suite."""

    results: Results
    """Content of results.json."""

    def __repr__(self) -> str:
        """Verdict, cases and system in one line."""
        cases = count_noun(len(self.results.cases), "case")
        return describe_in_one_line(self, self.verdict, cases, f"system: {self.results.system.name}")

    @property
    def verdict(self) -> Verdict:
        """Overall verdict: `pass`, `unconfirmed`, `info`, `skip`, `fail` or `error`."""
        return self.results.verdict

    def to_dataframe(self) -> Any:
        """Criteria, one per row: a table of pandas, or columns of numpy."""
        names = ("quantity", "pantograph", "value", "lower", "upper", "margin", "verdict", "trust")
        rows = [
            {"case": case.id, **{name: getattr(criterion, name) for name in names}}
            for case in self.results.cases
            for criterion in case.criteria
        ]
        return tabulate_rows(rows, ("case", *names))

    def steps(self) -> Any:
        """Steps of the EN 50318 procedure, one per row: a table of pandas, or columns of numpy.

        Only results of `validate_dossier` have steps.
        """
        procedure = self.results.procedure
        rows = [step.model_dump(mode="json") for step in procedure.steps] if procedure is not None else []
        return tabulate_rows(rows, ("step", "required", "state", "verdict", "margin", "uncertainty", "reason"))

    def write(self, folder: str | Path, formats: Sequence[str] | None = None, language: Language = "en") -> list[Path]:
        """Write the report; returns the paths of its files.

        Args:
            folder: Folder of the files.
            formats: Formats: html, pdf, json, csv, junit, md, badge. None: all but badge; a warning tells if no PDF can
                be written.
            language: Language of certificate and summary: en, de, fr, it or es.

        Raises:
            InputError: A format does not exist or needs an extra that is not installed, or a file cannot be written.
        """
        warn_missing_formats(formats)
        return write_all(self.results, Path(folder), check_formats(formats), language=language)


def open_results(path: str | Path) -> GradedResults:
    """Read a results.json.

    Args:
        path: Path of the file, or of its folder.

    Raises:
        InputError: It cannot be read, or is not in the format of the suite.
    """
    return GradedResults(read_results(Path(path)))


def grade_cases(
    *cases: str | Path,
    system: str = "builtin",
    trust: Trust = "secondary",
    changes: Sequence[str] = (),
    limits: str | Path | None = None,
    case_folders: Sequence[str | Path] = (),
) -> GradedResults:
    """Run cases on a system and grade them, as `pantocheck run` does.

    Args:
        *cases: Ids, globs or paths of cases.
        system: `builtin`, `record:DIR` or `command:PROGRAM ARGUMENTS`.
        trust: Lowest trust of the limits that count.
        changes: Changes of the inputs, `KEY=VALUE` as with `--set`.
        limits: File of own limits.
        case_folders: Folders with further cases, whose ids begin with `own/`.

    Raises:
        InputError: A case, change, limit or system is wrong.
    """
    options: dict[str, Any] = {"cases": tuple(map(str, cases)), "system": system, "trust": trust}
    if changes:
        options["set"] = tuple(changes)
    if case_folders:
        options["case_folders"] = tuple(map(str, case_folders))
    if limits is not None:
        options["limits"] = str(limits)
    prepared = prepare_plan(Plan.model_validate(options))
    return GradedResults(run_cases(prepared.cases, prepared.start_system(), trust, 1, None, prepared.participation))


def assess_run(record: str | Path, profile: str, measured: str | Path | None = None) -> GradedResults:
    """Grade a record by the rules of a profile, as `pantocheck assess` does.

    Args:
        record: Record to grade.
        profile: Name of a profile of the library, or path of a profile file.
        measured: Measured record, for a profile that compares.

    Raises:
        InputError: A record or the profile is wrong.
    """
    rules = load_profile(profile)
    subject = load_assessed_record(Path(record), rules, LineTable())
    reference = None if measured is None else load_assessed_record(Path(measured), rules, LineTable())
    return GradedResults(assess_record(subject, rules, "secondary", reference))


def validate_dossier(dossier: str | Path, folder: str | Path, jobs: int = 1) -> GradedResults:
    """Validate a simulator for a line by a dossier, as `pantocheck validate` does.

    Args:
        dossier: Dossier file.
        folder: Folder of the records of the runs.
        jobs: Number of reference models that run in parallel.

    Returns:
        Results with the steps of the procedure.

    Raises:
        InputError: The dossier or a file that it names is wrong.
    """
    from pantocheck.conformance.dossier.dossier_reading import read_dossier
    from pantocheck.conformance.dossier.validation import Validation

    content = read_dossier(Path(dossier))
    system = choose_system(content.system, content.file.timeout_s)
    check_writable(Path(folder))
    return GradedResults(Validation(content, system, Path(folder), jobs).run())
