"""Cheap campaign on a cluster of separate worker processes of Dask: one worker is killed, and one is added."""

import os
import signal
import sys
from pathlib import Path

from distributed import Client, LocalCluster

from helpers.cheap_campaign import compute_slowly, speed_design
from pantocheck.conformance.campaigns.campaign_driver import CampaignProgress, drive_campaign
from pantocheck.conformance.campaigns.campaign_file import Execution
from pantocheck.conformance.campaigns.campaign_store import open_store
from pantocheck.conformance.campaigns.campaign_table import write_campaign_table
from pantocheck.conformance.campaigns.run_executors import connect_scheduler


def main(folder: Path, runs: int) -> None:
    """Run the campaign; after 20 runs a worker is killed, after 40 runs one is added."""
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        with Client(cluster) as client:
            processes = list(client.run(os.getpid).values())

        def disturb(progress: CampaignProgress) -> None:
            if progress.finished == 20:
                os.kill(processes[0], signal.SIGKILL)
            if progress.finished == 40:
                cluster.scale(3)

        with connect_scheduler(cluster.scheduler_address) as executor, open_store(folder, {"runs": runs}) as store:
            drive_campaign(speed_design(runs), compute_slowly, store, executor, Execution(), disturb)
            write_campaign_table(store, folder / "campaign.csv")


if __name__ == "__main__":
    main(Path(sys.argv[1]), int(sys.argv[2]))
