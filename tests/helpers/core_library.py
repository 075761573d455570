"""Library of the core in C, compiled for the tests from the sources of the checkout."""

import shutil
import subprocess
from pathlib import Path

from pantocheck.model.dynamics.core_source import COMPILER_OPTIONS, SOURCES, source_digest

COMPILER = shutil.which("cc")


def compile_core(folder: Path, *options: str, digest: str = source_digest()) -> Path:
    """Compile the core without a warning into a folder, with further options."""
    path = folder / "time_step.so"
    stated = f'-DSOURCE_DIGEST="{digest}"'
    warnings = ("-Wall", "-Wextra", "-Werror")
    command = [
        str(COMPILER),
        *COMPILER_OPTIONS,
        *warnings,
        *options,
        stated,
        "-fPIC",
        "-shared",
        "-o",
        path,
        SOURCES[0],
        "-lm",
    ]
    subprocess.run(command, check=True)
    return path
