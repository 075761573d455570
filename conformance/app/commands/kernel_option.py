"""Option `--kernel` of the commands that simulate."""

import os
from typing import Annotated

import typer

from pantocheck.conformance.core.input_error import InputError
from pantocheck.model.dynamics.core_choice import CORE_VARIABLE, KERNELS

KernelOption = Annotated[
    str | None,
    typer.Option(
        help="Kernel of the time steps: c, numba, or reference (full matrices, slow: it settles a doubt).",
        show_default="c, else numba",
    ),
]


def demand_kernel(kernel: str | None) -> None:
    """Demand a kernel from this process and those that it starts; None: the fastest that can run.

    Raises:
        InputError: There is no such kernel.
    """
    if kernel is None:
        return
    if kernel not in KERNELS:
        raise InputError("option --kernel", f"there is no kernel '{kernel}'", f"Choose {', '.join(KERNELS)}.")
    os.environ[CORE_VARIABLE] = kernel
