"""Formats in which modes are exported for other programs."""

from collections.abc import Callable
from pathlib import Path

from pantocheck.conformance.core.extras import require_package
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.drops.mode_table import write_modes_csv
from pantocheck.conformance.results.identified_modes import Mode

ModeWriter = Callable[[tuple[Mode, ...], Path], None]


def _write_universal_file(modes: tuple[Mode, ...], path: Path) -> None:
    # Imported here: pyuff takes 0.2 s, which an identification without this export does not need.
    from pantocheck.conformance.drops.mode_universal_file import write_modes_uff

    write_modes_uff(modes, path)


MODE_FORMATS: dict[str, ModeWriter] = {
    ".csv": write_modes_csv,
    ".uff": _write_universal_file,
    ".unv": _write_universal_file,
}
"""Writer of modes by the suffix of the file."""


def select_mode_writer(path: Path) -> ModeWriter:
    """Writer of the format that the suffix of a file names.

    Raises:
        InputError: No writer has this suffix, or its package is not installed.
    """
    if (writer := MODE_FORMATS.get(path.suffix.lower())) is None:
        raise InputError(
            str(path), f"format '{path.suffix}' cannot be written", f"Write one of {', '.join(MODE_FORMATS)}."
        )
    if writer is _write_universal_file:
        require_package("pyuff", str(path))
    return writer
