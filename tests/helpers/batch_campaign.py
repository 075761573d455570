"""Cheap campaign in jobs of Slurm, whose command `sbatch` the test provides."""

import sys
from pathlib import Path

from helpers.cheap_campaign import compute_slowly, speed_design
from pantocheck.conformance.campaigns.campaign_driver import drive_campaign
from pantocheck.conformance.campaigns.campaign_file import Execution
from pantocheck.conformance.campaigns.campaign_store import open_store
from pantocheck.conformance.campaigns.campaign_table import write_campaign_table
from pantocheck.conformance.campaigns.run_executors import choose_executor

OPTIONS = {"walltime": "00:05:00", "memory": "1GB", "interface": "lo", "death_timeout": "20"}


def main(folder: Path, runs: int) -> None:
    """Run the campaign in two jobs."""
    execution = Execution(cluster="slurm", workers=2, cluster_options={**OPTIONS, "local_directory": str(folder)})
    with choose_executor(execution) as executor, open_store(folder, {"runs": runs}) as store:
        drive_campaign(speed_design(runs), compute_slowly, store, executor, execution, lambda _: None)
        write_campaign_table(store, folder / "campaign.csv")


if __name__ == "__main__":
    main(Path(sys.argv[1]), int(sys.argv[2]))
