"""FMUs of the pantographs of the library, beside their pantograph files."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from pantocheck.conformance.cases.case_parts import read_named_pantograph
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.pantograph.pantograph_file import PantographFile
from verification.fmu.fmu_builder import FAULTS, find_missing_tool, write_fmu_pantograph

WriteFmu = Callable[..., PantographFile]


@pytest.fixture
def write_fmu(tmp_path: Path) -> WriteFmu:
    """Function that writes an FMU of a pantograph and its file, and reads them as named by the user.

    Args:
        pantograph: Pantograph file of the library.
        fault: Name of a fault.
        folder: Name of the folder.
        keys: As in `write_fmu_pantograph`.
    """
    if (reason := find_missing_tool()) is not None:
        pytest.skip(reason)

    def write(
        pantograph: str = "en50318-2002/pantograph.toml", fault: str = "none", folder: str = "fmu", **keys: object
    ) -> PantographFile:
        place = tmp_path / folder
        place.mkdir(exist_ok=True)
        parameters = {"fault": float(FAULTS[fault])} | dict(keys.pop("parameters", {}))
        path = write_fmu_pantograph(place, library_folder() / pantograph, parameters=parameters, **keys)
        return read_named_pantograph(path)

    return write


def damage(content: bytes, seed: int) -> bytes:
    """Content with a few bytes changed, a part cut out or repeated, or its end cut off."""
    random = np.random.default_rng(seed)
    data = bytearray(content)
    place = int(random.integers(len(data)))
    match seed % 4:
        case 0:
            for k in random.integers(len(data), size=1 + seed % 7):
                data[k] = int(random.integers(256))
        case 1:
            del data[place : place + int(random.integers(1, 200))]
        case 2:
            data[place:place] = data[place // 2 : place]
        case _:
            del data[place:]
    return bytes(data)
