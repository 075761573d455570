"""Assessment of a collection on a cluster of separate worker processes of Dask."""

import sys

from distributed import LocalCluster

from helpers.command_line import pantocheck


def main(*arguments: str) -> None:
    """Run `runs assess` with the arguments on two workers."""
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        result = pantocheck("runs", "assess", *arguments, "--scheduler", cluster.scheduler_address)
    assert result.exit_code == 1, result.output


if __name__ == "__main__":
    main(*sys.argv[1:])
