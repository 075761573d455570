"""Source of the core in C: its files, its digest and the options of the compiler; also read by the installation."""

import hashlib
from pathlib import Path

SOURCES = tuple(Path(__file__).with_name(name) for name in ("time_step.c", "time_step_vectors.h", "time_step_lanes.h"))
"""Files of the core; the first one is compiled, and includes the others."""
LINE_SOURCES = (Path(__file__).with_name("line_fmu.c"), *SOURCES)
"""Files of a line as FMU; the first one is compiled, and includes the others."""
COMPILER_OPTIONS = ("-std=c11", "-O3", "-fvisibility=hidden", "-Wno-psabi")
"""Options of the compiler. None of them may change a result, as `-ffast-math` would."""


def source_digest() -> str:
    """SHA-256 of the files of the core. A library that states another one is not used."""
    return hashlib.sha256(b"".join(path.read_bytes() for path in SOURCES)).hexdigest()
