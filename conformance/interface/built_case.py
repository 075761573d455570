"""Cases built in Python: their files are written, so that every command can use them, too."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import tomli_w

from pantocheck.conformance.input_files.atomic_writing import write_atomically
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.interface.opened_case import OpenedCase, open_case

Part = str | Path | Mapping[str, Any]
"""Line or pantograph: path of a file, name in the library, or its keys with their values."""


def build_case(folder: str | Path, line: Part, pantographs: Sequence[Part], **keys: Any) -> OpenedCase:
    """Write the files of a case into a folder, and open the case.

    Args:
        folder: Folder of the files `case.toml` and, for parts that are given by their keys, `line.toml`,
            `pantograph-1.toml`, and so on. Files of an earlier call are replaced.
        line: Path of a line file, its name in the library, or the keys of a line file.
        pantographs: Pantographs in running order, given as the line is.
        **keys: Further keys of the case file, for example `speed_km_h=250` and `evaluated_spans=[5, 6]`. Default `id`:
            `own/` and the name of the folder; default `title`: the id. `uplift_force_N` is the lift force of every
            pantograph.

    Raises:
        InputError: A file cannot be written, or the case, the line or a pantograph is invalid.
    """
    place = Path(folder)
    name = keys.get("id", f"own/{place.resolve().name}")
    uses = [{"model": _place(part, place / f"pantograph-{i}.toml")} for i, part in enumerate(pantographs, 1)]
    if "uplift_force_N" in keys:
        uses = [use | {"uplift_force_N": keys["uplift_force_N"]} for use in uses]
    stated = {key: value for key, value in keys.items() if key != "uplift_force_N"}
    case = {"id": name, "title": name, "line": _place(line, place / "line.toml"), **stated, "pantograph": uses}
    _write(place / "case.toml", case)
    return open_case(place / "case.toml")


def _place(part: Part, path: Path) -> str:
    """Name of a part for the case file; a part that is given by its keys is written."""
    if isinstance(part, Mapping):
        _write(path, part)
        return path.name
    return str(Path(part).resolve()) if Path(part).is_file() else str(part)


def _write(path: Path, content: Mapping[str, Any]) -> None:
    try:
        text = tomli_w.dumps(dict(content))
    except (TypeError, ValueError) as error:
        raise InputError(f"file '{path.name}'", str(error), "Give text, numbers, lists and dictionaries.") from None
    path.parent.mkdir(parents=True, exist_ok=True)
    write_atomically(path, text.encode())
