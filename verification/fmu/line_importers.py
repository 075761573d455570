"""Exported lines in another importer than FMPy: Ecos, a co-simulation engine in C++ (extra `peers`).

`python -m verification.fmu.line_importers [CASE ...]`: each line, in FMI 3.0 and 2.0, replays the heights of the heads
of the built-in passage, and its forces are compared with those of the passage.
"""

import ctypes
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.runs.line_fmu import FmiVersion, build_line_fmu
from pantocheck.conformance.runs.reference_simulator import UnrefinedSimulator
from verification.fmu.line_coupling import select_moving


def load_ecos() -> Any:
    """Package of Ecos; its library needs that of the package tbb, which lies outside of the paths of the loader.

    Raises:
        ImportError: A package is not installed.
        OSError: A library cannot be loaded.
    """
    for library in sorted(Path(sys.prefix, "lib").glob("libtbb.so.*"))[:1]:
        ctypes.CDLL(str(library), ctypes.RTLD_GLOBAL)
    import ecospy

    return ecospy


def replay_in_ecos(archive: Path, heights: RealArray, time_step: float) -> RealArray:
    """Contact forces of an exported line under given heights of the heads, (P, T) [N]."""
    ecos = load_ecos()
    numbers, rows = range(1, len(heights) + 1), []
    with ecos.EcosSimulationStructure() as structure:
        structure.add_model("line", str(archive))
        with ecos.EcosSimulation(structure=structure, step_size=time_step) as simulation:
            simulation.init()
            for height in heights.T:
                for n, value in zip(numbers, height.tolist(), strict=True):
                    simulation.set_real(f"line::head_height_{n}", value)
                simulation.step()
                rows.append([simulation.get_real(f"line::contact_force_{n}") for n in numbers])
            simulation.terminate()
    return np.array(rows).T


def main() -> None:
    """Print the table."""
    print("| case | FMI | largest difference of a force | standard deviation |\n| --- | --- | --- | --- |")
    versions: tuple[FmiVersion, ...] = ("3.0", "2.0")
    for case in select_moving(sys.argv[1:]):
        record = UnrefinedSimulator().run(case).record
        for fmi in versions:
            with tempfile.TemporaryDirectory() as folder:
                archive = Path(folder) / "line.fmu"
                archive.write_bytes(build_line_fmu(case, fmi, "height"))
                found = replay_in_ecos(archive, record.contact_height, case.file.discretisation.time_step_s)
            spread = np.abs(found.std(axis=1) / record.force.std(axis=1) - 1).max()
            largest = np.abs(found - record.force).max()
            print(f"| {case.id} | {fmi} | {largest:.1e} N | {100 * spread:.1e} % |", flush=True)


if __name__ == "__main__":
    main()
