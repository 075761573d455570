"""`pantocheck campaign`: many runs with varied inputs, which can be interrupted and resumed."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from datetime import timedelta
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import RenderableType
from rich.text import Text

from pantocheck.conformance.app.commands.cases_option import CasesOption, complete_case
from pantocheck.conformance.app.commands.command_output import CommandOutput
from pantocheck.conformance.app.commands.console import indent_text
from pantocheck.conformance.app.commands.options import PantographOption, SetOption, TrustOption
from pantocheck.conformance.app.commands.progress_display import FIRST_SHARE, show_line
from pantocheck.conformance.campaigns.campaign_columns import choose_values
from pantocheck.conformance.campaigns.campaign_driver import CampaignProgress
from pantocheck.conformance.campaigns.campaign_evaluation import RunPair, evaluate_campaign, pair_runs
from pantocheck.conformance.campaigns.campaign_file import CampaignFile, Execution, check_variation, parse_variation
from pantocheck.conformance.campaigns.campaign_preparation import PreparedCampaign, find_campaign_file, prepare_campaign
from pantocheck.conformance.campaigns.campaign_store import CampaignStore, open_store, read_store
from pantocheck.conformance.campaigns.campaign_table import write_campaign_table, write_parquet
from pantocheck.conformance.campaigns.run_executors import choose_executor
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.json_file import write_model
from pantocheck.conformance.core.processes import interruption_exit_code
from pantocheck.conformance.core.texts import count_noun
from pantocheck.conformance.core.toml_file import read_toml, validate_model
from pantocheck.conformance.pages.campaign_page import build_campaign_report
from pantocheck.conformance.pages.report_writers import remark_missing_formats, write_document
from pantocheck.conformance.results.campaign_format import CampaignEnding, CampaignResults
from pantocheck.conformance.runs.core_requirement import COMPILATION, needs_compilation

STOPPED: dict[CampaignEnding, str] = {
    "complete": "",
    "failure share": "Stopped: too many runs failed. ",
    "time budget": "Stopped: the time budget is used up. ",
    "interrupted": "Interrupted: the same command resumes the campaign. ",
}

REASONS_SHOWN = 3
"""Number of reasons of failed runs below the conclusion."""


def campaign_command(
    campaign: Annotated[
        str,
        typer.Argument(
            help="Campaign (TOML file or name), or id, glob or path of base cases.", autocompletion=complete_case
        ),
    ],
    out: Annotated[Path, typer.Option(help="Folder of the runs and tables; the same command resumes the campaign.")],
    vary: Annotated[
        list[str] | None,
        typer.Option(metavar="KEY=VALUES", help="Vary an input: START:STOP:STEP or VALUE,VALUE; repeat for a grid."),
    ] = None,
    changed: SetOption = None,
    pantograph: PantographOption = None,
    folders: CasesOption = None,
    system: Annotated[
        list[str] | None,
        typer.Option(help="System: builtin, record:DIR or command:PROGRAM; repeat to compare.", show_default="builtin"),
    ] = None,
    limits: Annotated[Path | None, typer.Option(help="TOML file of your limits.")] = None,
    profile: Annotated[
        str | None, typer.Option(help="Profile whose rules are limits at the speed of each run, e.g. acceptance-ac.")
    ] = None,
    trust: TrustOption = None,
    workers: Annotated[
        int | None, typer.Option(help="Number of processes, or of jobs.", show_default="number of processors")
    ] = None,
    scheduler: Annotated[
        str | None, typer.Option(help="Running scheduler of Dask, e.g. tcp://host:8786, in place of processes.")
    ] = None,
    cluster: Annotated[
        str | None, typer.Option(help="Submit workers to a batch system: slurm, pbs, sge, lsf, htcondor, oar, moab.")
    ] = None,
    max_failed: Annotated[
        float | None, typer.Option(metavar="SHARE", help="Stop if a larger share of the runs fails.")
    ] = None,
    time_budget: Annotated[
        float | None, typer.Option(metavar="SECONDS", help="Start no further run after this time.")
    ] = None,
    compare: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="Compare with the runs of another campaign that have equal inputs."),
    ] = None,
    traces: Annotated[
        str | None,
        typer.Option(
            metavar="RUNS", help="Store the curves of force and uplift: none, failing or all.", show_default="none"
        ),
    ] = None,
    retry_failed: Annotated[bool, typer.Option("--retry-failed", help="Repeat the failed runs.")] = False,
) -> CommandOutput:
    """Run cases with varied inputs; write a table.

    Every finished run is stored at once. After an interruption, the same command goes on with the open runs.

    Examples:

    pantocheck campaign tolerances.toml --out tolerances

    pantocheck campaign campaigns/ac-simple-speed --out speeds

    pantocheck campaign en50318-2018/ac-simple/320-twin --vary speed_km_h=200:350:10 --out map
    """
    design: dict[str, object] = {
        "vary": _parse_variations(vary or ()) or None,
        "set": changed,
        "pantograph": [str(Path(name).resolve()) for name in pantograph or ()] or None,
        "systems": system,
        "limits": None if limits is None else str(limits.resolve()),
        "profile": profile,
        "trust": trust,
    }
    execution = {
        "workers": workers,
        "scheduler": scheduler,
        "cluster": cluster,
        "max_failed_share": max_failed,
        "time_budget_s": time_budget,
        "traces": traces,
    }
    places = tuple(str(folder.resolve()) for folder in folders or ())
    prepared = _prepare(campaign, design, {key: value for key, value in execution.items() if value is not None}, places)
    if compare is not None:
        with read_store(compare):
            pass  # a wrong folder is refused before the first run
    with open_store(out, prepared.identity) as store:
        if retry_failed:
            store.forget_failed()
        return _run_open(prepared, store, out, compare)


def _parse_variations(texts: Sequence[str]) -> list[dict[str, Any]]:
    """Variations of the command line."""
    variations = [parse_variation(text) for text in texts]
    for variation in variations:
        check_variation(variation)
    return variations


def _list_reasons(results: CampaignResults) -> list[RenderableType]:
    """Most frequent reasons of runs without a result."""
    reasons = list(results.reasons.items())
    lines: list[RenderableType] = [
        indent_text(f"{count_noun(runs, 'run')}: {reason}") for reason, runs in reasons[:REASONS_SHOWN]
    ]
    more = len(reasons) - REASONS_SHOWN
    return [*lines, *([indent_text(f"{count_noun(more, 'further reason')}: see the table")] if more > 0 else [])]


def _prepare(
    source: str, design: dict[str, object], execution: dict[str, object], folders: tuple[str, ...]
) -> PreparedCampaign:
    """Prepare a campaign file, or the cases and variations of the command line; `folders` have further cases."""
    given = {key: value for key, value in design.items() if value is not None}
    path = find_campaign_file(source) or Path(source)
    tree = read_toml(path, "campaign") if path.suffix == ".toml" else {"id": source}
    if "id" in tree:  # only a case has an id
        content = {"title": source, "cases": [source], "case_folders": folders, **given, "execution": execution}
        return prepare_campaign(validate_model(content, CampaignFile, "command line"), Path())
    if given:
        raise InputError(
            f"option {'--' + min(given).removesuffix('s')}", "is given together with a campaign file", "Edit this file."
        )
    file = validate_model(tree, CampaignFile, f"campaign '{path.name}'")
    stated = file.execution.model_dump(exclude_unset=True)
    changed = validate_model({**stated, **execution}, Execution, "command line")
    return prepare_campaign(
        file.model_copy(update={"execution": changed, "case_folders": (*file.case_folders, *folders)}), path.parent
    )


def _run_open(prepared: PreparedCampaign, store: CampaignStore, out: Path, compared: Path | None) -> CommandOutput:
    """Run the open runs of a campaign, evaluate all, also beside those of another folder, and write the tables."""
    ending, interrupted = _drive(prepared, store)
    results = evaluate_campaign(prepared, store, ending, _pair_with(compared, prepared, store))
    counts = f"{results.finished} of {results.total} runs finished, {results.failed} failed"
    return CommandOutput(
        Text(STOPPED[ending] + counts),
        results,
        _list_reasons(results),
        files=_write_results(results, store, out),
        exit_code=interrupted or int(results.finished < results.total or results.failed > 0),
        remarks=remark_missing_formats(),
    )


def _drive(prepared: PreparedCampaign, store: CampaignStore) -> tuple[CampaignEnding, int]:
    """Run the open runs of a campaign; how it ended, and the exit code of an interruption, else 0."""
    try:
        with choose_executor(prepared.file.execution) as executor:
            typer.echo(f"Runs in {executor.description}.", err=True)
            if "builtin" in prepared.file.systems and needs_compilation():
                typer.echo(COMPILATION, err=True)
            with report_campaign() as report:
                return prepared.drive(store, executor, report), 0
    except KeyboardInterrupt as interruption:
        return "interrupted", interruption_exit_code(interruption)


def _pair_with(folder: Path | None, prepared: PreparedCampaign, store: CampaignStore) -> list[RunPair]:
    """Runs of a campaign and of that in another folder with equal inputs; none without a folder."""
    if folder is None:
        return []
    with read_store(folder) as other:
        return pair_runs(store, other, choose_values(store, prepared.limits))


def _write_results(results: CampaignResults, store: CampaignStore, folder: Path) -> list[Path]:
    """Write the table, the evaluation and the report of a campaign; return their paths."""
    files = [folder / name for name in ("campaign.csv", "campaign.json")]
    write_campaign_table(store, files[0])
    if (parquet := write_parquet(files[0])) is not None:
        files.append(parquet)
    write_model(files[1], results)
    report = build_campaign_report(results)
    return [*files, *write_document(report, folder / "campaign")]


# Progress of a campaign: finished and failed runs, rate and remaining time.
@contextmanager
def report_campaign() -> Iterator[Callable[[CampaignProgress], None]]:
    """Show the progress of a campaign on standard error; yields the callback of the driver."""
    latest: list[CampaignProgress] = []

    def keep(progress: CampaignProgress) -> None:
        latest[:] = [progress]

    with show_line(lambda: describe_progress(latest[0]) if latest else ""):
        yield keep


def describe_progress(progress: CampaignProgress) -> str:
    """Progress in one line: finished and failed runs, rate and remaining time."""
    counts = f"{progress.finished} of {progress.total} runs finished, {progress.failed} failed"
    if progress.rate is None or progress.remaining_s is None:
        return counts
    rate = f"{progress.rate:.1f} per second" if progress.rate >= 1 else f"{60 * progress.rate:.1f} per minute"
    if progress.finished < FIRST_SHARE * progress.total:
        return f"{counts}, {rate}"
    return f"{counts}, {rate}, {timedelta(seconds=round(progress.remaining_s))} remaining"
