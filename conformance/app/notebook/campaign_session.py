"""Campaigns from Python: the same as `pantocheck campaign`, in a script or a notebook."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pantocheck.conformance.app.notebook.display import build_column, tabulate_columns
from pantocheck.conformance.campaigns.campaign_file import CampaignFile
from pantocheck.conformance.campaigns.campaign_preparation import find_campaign_file, prepare_campaign, read_campaign
from pantocheck.conformance.campaigns.campaign_store import open_store, read_store
from pantocheck.conformance.campaigns.campaign_table import collect_columns, write_campaign_table
from pantocheck.conformance.campaigns.run_executors import choose_executor
from pantocheck.conformance.campaigns.run_traces import RunTraces, unpack_traces
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.toml_file import validate_model


def run_campaign(campaign: str | Path | Mapping[str, Any], out: str | Path) -> Any:
    """Run or resume a campaign.

    A script that is run by name needs `if __name__ == "__main__":` around the call, because the workers import it.

    Args:
        campaign: Campaign file, name of a campaign of the library, or content of a campaign file.
        out: Folder of the runs and of `campaign.csv`.

    Returns:
        One row per finished run with the columns of `campaign.csv`: a table of pandas if it is installed, otherwise
        arrays by the names of the columns. Missing numbers are NaN.

    Raises:
        InputError: The campaign is wrong, or the folder cannot be used.
    """
    if isinstance(campaign, Mapping):
        prepared = prepare_campaign(validate_model(dict(campaign), CampaignFile, "campaign"), Path())
    else:
        prepared = read_campaign(find_campaign_file(str(campaign)) or Path(campaign))
    folder = Path(out)
    with open_store(folder, prepared.identity) as store:
        with choose_executor(prepared.file.execution) as executor:
            prepared.drive(store, executor)
        write_campaign_table(store, folder / "campaign.csv")
        columns = collect_columns(store)
    return tabulate_columns({name: build_column(values) for name, values in columns.items()})


def read_traces(folder: str | Path, run: int) -> RunTraces:
    """Read the traces of a run of a campaign.

    Args:
        folder: Folder of the campaign.
        run: Number of the run, as in campaign.csv.

    Returns:
        Force of every pantograph over the analysis section, and uplift at its supports.

    Raises:
        InputError: The folder holds no campaign, or no traces of this run.
    """
    with read_store(Path(folder)) as store:
        content = store.find_traces(run)
    if content is None:
        hint = 'Run a campaign with traces = "all" in [execution] in a new folder; finished runs are not repeated.'
        raise InputError(f"folder '{folder}'", f"has no traces of run {run}", hint)
    return unpack_traces(content)
