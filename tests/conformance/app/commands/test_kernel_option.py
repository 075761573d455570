"""Option `--kernel`: the record of the reference kernel, and a refused name."""

from pathlib import Path

import numpy as np
import pytest

from helpers.command_line import pantocheck
from pantocheck.conformance.records.record_reading import read_record

CHANGES = (
    "discretisation.element_m=2", "discretisation.time_step_s=0.004", "speed_km_h=251.3", "evaluated_spans=[3, 4]"
)  # fmt: skip
"""A coarse mesh, an early section, and a speed at which no head is at a station, where rounding chooses an element."""


def test_reference_kernel_gives_the_record_of_the_fast_one(tmp_path: Path) -> None:
    """Forces within 1e-6 N, a hundred times the difference that sweeps leave on a spring contact; not bit by bit."""
    forces, changes = [], [word for change in CHANGES for word in ("--set", change)]
    for options in ((), ("--kernel", "reference")):
        out = tmp_path / f"{len(options)}.csv"
        result = pantocheck("simulate", "en50318-2002/250", *changes, "--out", out, *options, PANTOCHECK_CORE="")
        assert result.exit_code == 0, result.output
        forces.append(read_record(out)[0].force)
    assert 0 < np.abs(forces[1] - forces[0]).max() < 1e-6


@pytest.mark.parametrize("command", [("run", "en50318-2002/250"), ("simulate", "en50318-2002/250", "--out", "a.csv")])
def test_unknown_kernel_is_refused(command: tuple[str, ...]) -> None:
    result = pantocheck(*command, "--kernel", "fortran")
    assert result.exit_code == 2
    assert "there is no kernel 'fortran'" in result.output
    assert "c, numba, reference" in result.output
