"""Public interface of the simulator: types without kernels, functions on first use."""

import subprocess
import sys

import pytest

import pantocheck.model
from pantocheck.model.description import failures


def imported_by(statement: str) -> set[str]:
    """Top-level packages that a fresh interpreter holds after a statement."""
    code = f"{statement}\nimport sys; print(*{{name.partition('.')[0] for name in sys.modules}})"
    output = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True, timeout=120)
    return set(output.stdout.split())


@pytest.mark.parametrize(
    "statement",
    [
        "from pantocheck.model import Catenary, ModalBand, Pantograph, Passage, Wire, build_chain",
        "from pantocheck.model.description.failures import SimulationError",
        "from pantocheck.model.fem.beam import wave_speed",
    ],
)
def test_import_of_values_does_not_import_numba(statement: str) -> None:
    """A command that only reads a case must not pay for the compiler."""
    assert "numba" not in imported_by(statement)


def test_function_of_public_interface_is_loaded_on_first_use() -> None:
    """Every public name resolves, the lazy ones included; an unknown name is an ordinary AttributeError."""
    for name in pantocheck.model.__all__:
        assert getattr(pantocheck.model, name).__name__ == name
    with pytest.raises(AttributeError, match="no attribute 'simulate'"):
        pantocheck.model.simulate  # noqa: B018


def test_failures_share_one_base_class() -> None:
    """A caller that catches SimulationError catches every failure of the simulator."""
    kinds = [kind for kind in vars(failures).values() if isinstance(kind, type)]
    assert len(kinds) >= 5
    assert all(issubclass(kind, failures.SimulationError) for kind in kinds)
