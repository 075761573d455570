"""Campaigns from Python: the same as `pantocheck campaign`, in a script or a notebook."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pantocheck.conformance.campaigns.campaign_driver import CampaignProgress, drive_campaign
from pantocheck.conformance.campaigns.campaign_file import CampaignFile
from pantocheck.conformance.campaigns.campaign_preparation import (
    PreparedCampaign,
    find_campaign_file,
    prepare_campaign,
    read_campaign,
)
from pantocheck.conformance.campaigns.campaign_store import open_store
from pantocheck.conformance.campaigns.campaign_table import collect_columns, write_campaign_table
from pantocheck.conformance.campaigns.executor_choice import choose_executor
from pantocheck.conformance.input_files.toml_file import validate_model
from pantocheck.conformance.interface.column_table import tabulate_columns


def run_campaign(campaign: str | Path | Mapping[str, Any], out: str | Path) -> Any:
    """Run or resume a campaign.

    A script that is run by name needs `if __name__ == "__main__":` around the call, because the workers import it.

    Parameters
    ----------
    campaign : str, Path or mapping
        Campaign file, name of a campaign of the library, or content of a campaign file.
    out : str or Path
        Folder of the runs and of `campaign.csv`.

    Returns
    -------
    pandas.DataFrame or dict
        One row per finished run with the columns of `campaign.csv`: a table of pandas if it is installed, otherwise
        arrays by the names of the columns. Missing numbers are NaN.

    Raises
    ------
    InputError
        The campaign is wrong, or the folder cannot be used.
    """
    prepared, folder = _prepare(campaign), Path(out)
    execution = prepared.file.execution
    with open_store(folder, prepared.identity) as store:
        with choose_executor(execution) as executor:
            drive_campaign(prepared.design, prepared.execute, store, executor, execution, _ignore)
        write_campaign_table(store, folder / "campaign.csv")
        columns = collect_columns(store)
    return tabulate_columns(columns)


def _prepare(campaign: str | Path | Mapping[str, Any]) -> PreparedCampaign:
    if isinstance(campaign, Mapping):
        return prepare_campaign(validate_model(dict(campaign), CampaignFile, "campaign"), Path())
    return read_campaign(find_campaign_file(str(campaign)) or Path(campaign))


def _ignore(progress: CampaignProgress) -> None:
    """Leave the progress unseen."""
