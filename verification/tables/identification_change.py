"""Change of the identification of records in calm air against an earlier version of the program.

python -m verification.tables.identification_change FOLDER --before PYTHON

PYTHON is an interpreter in which the earlier version is installed. Each version identifies T1.h5, T2.csv and T3.uff of
FOLDER once to load everything, then again for the modes and the processor time. Ratios of the standard deviations are
over the modes that both versions report within their deviations; those of frequency and damping ratio are taken
together.
"""

import argparse
import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np

from verification.tables.interval_share import print_table

RECORDS = ("T1.h5", "T2.csv", "T3.uff")
SAME_HZ = 1e-4
"""Largest distance of a mode of both versions; modes of one group are 20 mHz apart [Hz]."""
IDENTIFY = """
import json, sys, time
from pathlib import Path
try:
    from pantocheck.conformance.drops.drop_reading import read_drop_records
    from pantocheck.conformance.drops.identify import identify_modes
except ImportError:
    from pantocheck.conformance.identification.identify import identify_modes
    from pantocheck.conformance.mass_drops.drop_reading import read_drop_records
records = read_drop_records(Path(sys.argv[1]))
for _ in range(2):
    begin = time.process_time()
    lines = identify_modes(records)
    seconds = time.process_time() - begin
modes = [mode for line in lines for mode in line.modes]
keys = ("frequency_Hz", "frequency_std_Hz", "damping_ratio", "damping_ratio_std", "certain")
print(json.dumps({"seconds": seconds, "modes": [[getattr(mode, key) for key in keys] for mode in modes]}))
"""
"""Program that an earlier version runs, too: its modules had other names."""


def identify(python: str, path: Path) -> dict[str, Any]:
    """Processor time [s] and modes of a record, by the version of an interpreter."""
    command = [python, "-c", IDENTIFY, str(path.resolve())]
    found = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    return json.loads(found.splitlines()[-1])  # type: ignore[no-any-return]


def compare(name: str, before: dict[str, Any], after: dict[str, Any]) -> list[str]:
    """Table row of a record."""
    old, new = (np.array(each["modes"], dtype=float) for each in (before, after))
    nearest = np.abs(old[:, None, 0] - new[None, :, 0]).argmin(axis=1)
    paired = np.abs(old[:, 0] - new[nearest, 0]) < np.maximum(SAME_HZ, old[:, 1])
    ratio = new[nearest][paired][:, [1, 3]] / old[paired][:, [1, 3]]
    certain = (old[:, 4] == 1) & paired & (new[nearest, 4] == 1)
    return [
        name,
        f"{len(old)} / {len(new)}",
        f"{int(old[:, 4].sum())} / {int(new[:, 4].sum())}",
        f"{int(certain.sum())}",
        f"{np.median(ratio):.3f}",
        f"{ratio.max():.3f}",
        f"{after['seconds'] / before['seconds']:.2f}",
    ]


def main() -> None:
    """Identify by both versions, and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--before", required=True, help="interpreter with the earlier version")
    options = parser.parse_args()
    heads = ["record", "modes before / now", "certain before / now", "certain in both", "median ratio of widths"]
    heads += ["largest ratio of widths", "ratio of processor times"]
    rows = (
        compare(name, *(identify(python, options.folder / name) for python in (options.before, sys.executable)))
        for name in RECORDS
    )
    print_table(heads, rows)


if __name__ == "__main__":
    main()
