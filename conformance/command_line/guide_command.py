"""`pantocheck guide`: verification and validation guide from results of this version."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer
from rich.text import Text

from pantocheck.conformance.command_line.command_output import CommandOutput
from pantocheck.conformance.command_line.console import indent_text
from pantocheck.conformance.command_line.progress_display import follow_steps
from pantocheck.conformance.guide.guide_building import build_guide, guide_identity, list_deviations
from pantocheck.conformance.guide.guide_driver import compute_parts
from pantocheck.conformance.guide.guide_store import GuideStore
from pantocheck.conformance.guide.guide_tasks import list_tasks, list_timings
from pantocheck.conformance.guide.guide_values import list_guide_values
from pantocheck.conformance.guide.part_durations import sum_durations
from pantocheck.conformance.identification.rounded_model import write_model
from pantocheck.conformance.input_files.atomic_writing import check_writable, write_atomically
from pantocheck.conformance.reports.formats.report_writers import remark_missing_formats, write_document
from pantocheck.conformance.reports.guide.guide_page import build_guide_page
from pantocheck.conformance.results.guide_format import Guide

VALUES_FILE = "guide-values.json"
"""Numbers of the guide by name, which the documentation prints."""


def guide_command(
    out: Annotated[Path, typer.Option(help="Folder for guide.html, guide.pdf and guide.json.")],
    jobs: Annotated[int, typer.Option(min=1, max=256, help="Number of parallel processes.")] = 1,
) -> CommandOutput:
    """Write the verification and validation guide: every number is computed now, by this version.

    Closed forms, second formulations, peers, published cases, uncertainty, self-test and computing times. Packages of
    peers are compared where they are installed. Finished parts are stored: after an interruption the same command
    continues, and another version computes all parts again.

    Example: pantocheck guide --out guide --jobs 2
    """
    check_writable(out)
    store = GuideStore(out, guide_identity())
    tasks, timings = list_tasks(), list_timings()
    with follow_steps("guide", len(tasks) + len(timings)) as progress:
        names = [task.name for task in tasks]
        total = sum_durations([*names, *(task.name for task in timings)])

        def report(part: str, finished: Sequence[str]) -> None:
            progress.reach(part, len(finished), sum_durations(finished) / total)

        parts = compute_parts(tasks, store, jobs, report)
        timed = compute_parts(timings, store, 1, lambda part, finished: report(part, [*names, *finished]))
    guide = build_guide(parts.join(timed))
    write_model(out / "guide.json", guide)
    write_atomically(out / VALUES_FILE, _encode_values(guide))
    page = build_guide_page(guide.model_dump(mode="json", by_alias=True))
    deviations = list_deviations(guide)
    text = f"{len(deviations)} results outside their tolerance, or not computed" if deviations else "All parts hold."
    return CommandOutput(
        Text(text),
        guide,
        [indent_text(name) for name in deviations],
        files=[*write_document(page, out / "guide"), out / "guide.json", out / VALUES_FILE],
        exit_code=1 if deviations else 0,
        remarks=remark_missing_formats(),
    )


def _encode_values(guide: Guide) -> bytes:
    """Numbers of the guide for the documentation, with the stamps of suite and date."""
    stamps = {"suite": guide.suite.model_dump(mode="json"), "created": guide.created}
    content = {**stamps, "values": list_guide_values(guide)}
    return (json.dumps(content, indent=1, allow_nan=False) + "\n").encode("ascii")
