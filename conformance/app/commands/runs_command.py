"""`pantocheck runs import` and `runs assess`: collections of measured runs, and their assessment by sections."""

import csv
import shutil
import time
from collections import Counter
from pathlib import Path
from typing import Annotated, get_args

import typer

from pantocheck.conformance.app.commands.command_output import EXIT_CODES, CommandOutput
from pantocheck.conformance.app.commands.console import build_table, escape_text, indent_text, style_verdict
from pantocheck.conformance.app.commands.options import TrustOption, build_options
from pantocheck.conformance.app.commands.progress_display import follow_steps
from pantocheck.conformance.cases.profile_file import load_profile
from pantocheck.conformance.core.files import check_writable, stage_file
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.json_file import write_model
from pantocheck.conformance.network.network_assessment import (
    SCRATCH,
    AssessedTrack,
    AssessmentTask,
    assess_tracks,
    combine_tracks,
)
from pantocheck.conformance.network.run_collection import (
    ImportedFile,
    ImportState,
    import_files,
    list_refused,
    list_runs,
    open_collection,
)
from pantocheck.conformance.network.run_workers import open_workers
from pantocheck.conformance.network.section_grading import NETWORK_QUANTITIES
from pantocheck.conformance.network.track_places import read_places
from pantocheck.conformance.pages.network_page import build_network_page, build_run_page
from pantocheck.conformance.pages.report_writers import write_report
from pantocheck.conformance.results.network_format import GroupKey, SectionPassage

PASSAGE_COLUMNS = ("line", "track", "from_km", "to_km", "name", "run", "date", "direction", "pantograph")
"""First columns of the table of passages."""

MOST_PRINTED = 20
"""Largest number of files or sections that are printed."""


def runs_import_command(
    files: Annotated[list[Path], typer.Argument(metavar="FILE ...", help="Logger files, or their sidecars.")],
    out: Annotated[Path, typer.Option(help="Folder of the collection; new runs are added to it.")],
    sidecar: Annotated[
        Path | None, typer.Option(help="Sidecar of all files that have none of their own beside them.")
    ] = None,
) -> CommandOutput:
    """Add measured runs to a collection.

    A run is stored as Parquet, with its sidecar, checksums and remarks. The same file twice is one run. A file that
    cannot be used is listed with its reason.

    Example: pantocheck runs import night/*.mf4 --sidecar train-7.toml --out runs
    """
    done: list[ImportedFile] = []
    with open_collection(out), follow_steps("import", len(files)) as progress:
        for item in import_files(files, out, sidecar):
            done.append(item)
            progress.finish_task(item.name)
    counts = Counter(item.state for item in done)
    shown = [item for item in done if item.state == "refused" or (item.state == "imported" and item.remarks)]
    lines = [indent_text(f"{item.name}: {remark}", f"{item.state}: ") for item in shown for remark in item.remarks]
    parts = [f"{number} {word}" for state, word in STATE_WORDS.items() if (number := counts[state]) or not done]
    further = [] if len(lines) <= MOST_PRINTED else [escape_text(f"... {len(lines) - MOST_PRINTED} further remarks")]
    data = [{"file": item.name, "state": item.state, "remarks": item.remarks} for item in done]
    return CommandOutput(
        escape_text(", ".join(parts)),
        {"files": data},
        [*lines[:MOST_PRINTED], *further],
        exit_code=2 if counts["refused"] else 0,
    )


STATE_WORDS: dict[ImportState, str] = {"imported": "runs imported", "known": "known already", "refused": "refused"}
"""Words of the outcomes of an import."""


def runs_assess_command(
    folder: Annotated[Path, typer.Argument(metavar="RUNS", help="Folder of a collection.")],
    profile: Annotated[str, typer.Option(help="Name of a profile, or the path of your own .toml file.")],
    out: Annotated[Path, typer.Option(help="Folder for index.html, network.json, passages.csv and a page per run.")],
    by: Annotated[
        str, typer.Option(help="Properties of the passages that are graded together.")
    ] = "section,speed,direction,pantograph",
    section_km: Annotated[
        float, typer.Option(help="Length of a section where no tension sections are given.", min=0.1, max=100.0)
    ] = 1.0,
    assets: Annotated[
        list[Path] | None,
        typer.Option(help="Table of supports, tension sections and other places; may repeat."),
    ] = None,
    trust: TrustOption = None,
    jobs: Annotated[int, typer.Option(help="Number of processes on this machine.", min=1, max=256)] = 1,
    scheduler: Annotated[
        str | None,
        typer.Option(
            metavar="ADDRESS", help="Scheduler of Dask, such as tcp://host:8786; its workers share the folders."
        ),
    ] = None,
) -> CommandOutput:
    """Assess every section of the lines of a collection.

    A section passes if all passages over the whole of it pass. A section that no run measured as a whole is skipped.

    Example: pantocheck runs assess runs --profile acceptance-ac --section-km 2 --out net
    """
    keys = tuple(part.strip() for part in by.split(","))
    if unknown := [key for key in keys if key not in get_args(GroupKey)]:
        known = ", ".join(get_args(GroupKey))
        raise InputError("option --by", f"found {unknown[0][:40]!r}", f"Give a list of {known}, without blanks.")
    rules = load_profile(profile)
    if rules.compares:
        raise InputError("option --profile", f"{profile} compares with a measured record", "Choose another profile.")
    runs = list(list_runs(folder))
    names = {(run.facts.line, run.facts.track) for run in runs}
    single = next(iter(names)) if len(names) == 1 else (None, None)
    task = AssessmentTask(
        profile=rules,
        trust=build_options(trust=trust).trust,
        by=tuple(key for key in get_args(GroupKey) if key in keys),
        length_km=section_km,
        known_places=tuple(place for path in assets or () for place in read_places(path, *single)),
        scratch=out,
    )
    check_writable(out)
    out.mkdir(parents=True, exist_ok=True)
    for rest in out.glob(f"{SCRATCH}*"):  # of an assessment that was killed
        shutil.rmtree(rest, ignore_errors=True)
    begin = time.monotonic()

    tracks: list[AssessedTrack] = []
    passages = out / "passages.csv"
    with (
        stage_file(passages) as temporary,
        temporary.open("w", newline="", encoding="utf-8") as file,
        follow_steps("runs", len(runs)) as progress,
        open_workers(jobs, scheduler) as map_runs,
    ):
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow([*PASSAGE_COLUMNS, "speed_km_h", "whole", "verdict", "reason", "clocks", *NETWORK_QUANTITIES])
        for track, graded in assess_tracks(runs, task, map_runs):
            tracks.append(track)
            for run, items in graded:
                writer.writerows(map(_list_cells, items))
                write_report(build_run_page(run.facts.run, items), out / "runs" / f"{run.facts.run}.html")
                progress.finish_task(run.facts.run)
    results = combine_tracks(tracks, list_refused(folder), task)
    files = [out / "index.html", out / "network.json", passages]
    write_model(files[1], results)
    write_report(build_network_page(results), files[0])
    minutes = (time.monotonic() - begin) / 60
    columns = ("from km", "to km", "passages")
    table = build_table("line", "track", *columns, "verdict", title="Sections that do not pass", right=columns)
    failed = [group for group in results.groups if group.verdict != "pass"]
    for group in failed[:MOST_PRINTED]:
        section = group.section
        cells = (section.line, section.track, f"{section.from_km:.3f}", f"{section.to_km:.3f}", str(group.passages))
        table.add_row(*map(escape_text, cells), style_verdict(group.verdict))
    speed = f"{results.measured_km:.1f} of {results.total_km:.1f} km measured; {results.passages} passages of sections"
    return CommandOutput(
        style_verdict(results.verdict) + escape_text(f" {results.reason}"),
        results,
        [escape_text(speed), *([table] if failed else [])],
        [escape_text(f"{sum(run.facts.length_km for run in runs) / max(minutes, 1e-6):.3g} km of runs per minute")],
        files=files,
        exit_code=EXIT_CODES[results.verdict],
    )


def _list_cells(passage: SectionPassage) -> list[object]:
    section = passage.section
    ends = (section.from_km, section.to_km, section.name)
    values = [passage.values.get(name, "") for name in NETWORK_QUANTITIES]
    speed = "" if passage.speed_km_h is None else passage.speed_km_h
    run = (passage.run, passage.date, passage.direction, passage.pantograph)
    verdict = (passage.whole, passage.verdict, passage.reason, passage.clocks)
    return [section.line, section.track, *ends, *run, speed, *verdict, *values]
