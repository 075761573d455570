"""Writing reports: a document in the format of its file name, and the results of a run in several formats.

Functions import the writers that they need, because matplotlib, Typst and the template engine are slow to load.
"""

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

from pantocheck.conformance.core.extras import install_line, is_installed
from pantocheck.conformance.core.files import write_atomically
from pantocheck.conformance.core.reproducibility import read_source_date
from pantocheck.conformance.pages.document import Document, strip_times
from pantocheck.conformance.results.file_places import ReportPlaces
from pantocheck.conformance.results.report_files import FILES, Language
from pantocheck.conformance.results.results_format import Results

NO_PLACES = ReportPlaces()
"""Places of a report whose input files are not known."""


NO_PDF = f"no PDF is written, because the package typst is not installed. Install it: {install_line('typst')}"
"""Remark on a report without the extra `pdf`."""


def write_report(document: Document, path: Path) -> None:
    """Write a document as HTML, PDF or Markdown, by the suffix of the file name.

    Raises:
        InputError: The file cannot be written, or `SOURCE_DATE_EPOCH` is not a number of seconds.
    """
    match path.suffix:
        case ".html":
            from pantocheck.conformance.pages.html import render_html

            content = render_html(document).encode("utf-8")
        case ".pdf":
            from pantocheck.conformance.pages.pdf import render_pdf

            content = render_pdf(document)
        case _:
            from pantocheck.conformance.pages.markdown import render_markdown

            content = render_markdown(document).encode("utf-8")
    write_atomically(path, content)


def remark_missing_formats(stated: Sequence[str] | None = None) -> tuple[str, ...]:
    """Remarks on default formats that are not written; none if the user states the formats."""
    return () if stated is not None or is_installed("typst") else (NO_PDF,)


def write_document(document: Document, stem: Path) -> list[Path]:
    """Write a document as HTML and PDF; without the extra `pdf` as HTML alone (`remark_missing_formats` says so).

    Raises:
        InputError: A file cannot be written.
    """
    suffixes = (".html", ".pdf") if is_installed("typst") else (".html",)
    files = [stem.with_name(f"{stem.name}{suffix}") for suffix in suffixes]
    for path in files:
        write_report(document, path)
    return files


def write_all(
    results: "Results",
    folder: Path,
    formats: Sequence[str],
    places: ReportPlaces = NO_PLACES,
    language: Language = "en",
) -> list[Path]:
    """Write results in several formats.

    Args:
        results: Results of a run.
        folder: Folder of the files.
        formats: Names of formats, keys of `FILES`.
        places: Places of cases and limits in the files of the user, for annotations.
        language: Language of certificate and summary; the formats for programs are English.

    Raises:
        InputError: A file cannot be written.
    """
    if "json" in formats:
        write_atomically(folder / FILES["json"], results.to_json())
    write_pages(results, folder, formats, places, language)
    return [folder / FILES[name] for name in formats]


def write_pages(
    results: Results,
    folder: Path,
    formats: Sequence[str],
    places: ReportPlaces = NO_PLACES,
    language: Language = "en",
) -> None:
    """Write every format but results.json; the certificate is composed once for all its formats.

    A second thread typesets the PDF: Typst lets other threads run.

    If the environment sets `SOURCE_DATE_EPOCH`, the times of the run are left out, so that a second run of the same
    input gives the same bytes.
    """
    if read_source_date() is not None:
        results = strip_times(results)
    if not {"html", "pdf", "figures"} & set(formats):
        _write_others(results, folder, formats, places, language)
        return
    from pantocheck.conformance.pages.certificate_page import build_certificate

    certificate = replace(build_certificate(results), language=language)
    with ThreadPoolExecutor(1) as pool:
        typeset = [pool.submit(write_report, certificate, folder / FILES["pdf"])] if "pdf" in formats else []
        if "html" in formats:
            write_report(certificate, folder / FILES["html"])
        if "figures" in formats:
            from pantocheck.conformance.pages.figure_files import write_figures

            write_figures(certificate, folder / FILES["figures"])
        _write_others(results, folder, formats, places, language)
    for report in typeset:
        report.result()


def _write_others(
    results: Results, folder: Path, formats: Sequence[str], places: ReportPlaces, language: Language
) -> None:
    """Write every format but results.json and the certificate."""
    certificates = [FILES[name] for name in formats if name in ("html", "pdf")]
    if "md" in formats:
        from pantocheck.conformance.pages.certificate_page import build_summary

        write_report(replace(build_summary(results, certificates), language=language), folder / FILES["md"])
    if "junit" in formats:
        from pantocheck.conformance.pages.ci_reports import render_junit

        write_atomically(folder / FILES["junit"], render_junit(results, certificates))
    if "csv" in formats:
        from pantocheck.conformance.pages.quantity_tables import render_quantity_list

        write_atomically(folder / FILES["csv"], render_quantity_list(results).encode("utf-8"))
    if "xlsx" in formats:
        from pantocheck.conformance.pages.results_workbook import render_workbook

        write_atomically(folder / FILES["xlsx"], render_workbook(results))
    if "badge" in formats:
        from pantocheck.conformance.pages.two_verdicts import render_badge

        write_atomically(folder / FILES["badge"], render_badge(results).encode("utf-8"))
    if "annotations" in formats or "codequality" in formats:
        _write_annotations(results, folder, formats, places)


def _write_annotations(results: Results, folder: Path, formats: Sequence[str], places: ReportPlaces) -> None:
    from pantocheck.conformance.pages.ci_reports import list_annotations, render_code_quality, render_workflow_commands

    found = list_annotations(results, places)
    if "annotations" in formats:
        write_atomically(folder / FILES["annotations"], render_workflow_commands(found))
    if "codequality" in formats:
        write_atomically(folder / FILES["codequality"], render_code_quality(found, folder / FILES["json"]))
