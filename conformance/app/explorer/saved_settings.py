"""Settings of the explorer as input files: a case with its line and pantographs, or a campaign. Nothing is replaced."""

import re
import shutil
import tempfile
from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w

from pantocheck.conformance.app.explorer.case_sliders import find_slider, set_slider
from pantocheck.conformance.app.explorer.explored_case import ExploredCase
from pantocheck.conformance.app.notebook.opened_case import build_case
from pantocheck.conformance.campaigns.campaign_file import CampaignFile
from pantocheck.conformance.campaigns.campaign_preparation import prepare_campaign
from pantocheck.conformance.cases.case import Case, drop_keys
from pantocheck.conformance.cases.input_changes import InputChange, build_change
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.sourced_table import PROVENANCE, InputTable
from pantocheck.conformance.core.toml_file import validate_model

SAVED_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_-]{0,59}")

MOST_VARIED_VALUES = 1000
"""Largest number of values of a saved campaign."""

LEFT_OUT = {
    *("id", "title", "line", "damping", "pantograph", "edition", "superseded_by", "on_request", "requires", "study"),
    *("mass_drop", "reading"),
}
"""Keys of a case that a changed copy does not keep; its damping is a part of its line then."""


def save_case(explored: ExploredCase, values: Mapping[str, float], folder: Path, name: str) -> Path:
    """Write the files of a case at a setting into a new folder.

    The origin of its numbers is not carried over. The limits of a library case hold for its own inputs alone.

    Args:
        explored: Case of the page.
        values: Setting of the sliders.
        folder: Folder for saved settings.
        name: Name of the new folder in it, and of the case.

    Returns:
        Case file.

    Raises:
        InputError: The name is wrong or exists, a value is refused, or an FMU moves a pantograph.
    """
    place = _choose_place(folder, name)
    case, changes = explored.change(values)
    if case.fmus:
        raise InputError(f"case '{case.id}'", "has a pantograph that an FMU moves", "Copy its files and edit the copy.")
    keys = _dump(case.file, LEFT_OUT if case.origin is not None else LEFT_OUT | {"limit"})
    keys |= {"id": f"own/{name}", "title": _describe(explored.case, changes)}
    keys["pantograph"] = [_dump(use, ("model",)) for use in case.file.pantograph]
    temporary = Path(tempfile.mkdtemp(prefix=".", dir=_create(folder)))
    try:
        build_case(temporary, _dump(case.line), [*map(_dump, case.pantographs)], **keys)
        temporary.chmod(0o755)
        temporary.rename(place)
    finally:
        shutil.rmtree(temporary, ignore_errors=True)
    return place / "case.toml"


def save_campaign(
    explored: ExploredCase,
    values: Mapping[str, float],
    folder: Path,
    name: str,
    varied: tuple[str, Sequence[float]],
) -> Path:
    """Write a campaign that varies one slider at a setting of the others.

    Args:
        explored: Case of the page.
        values: Setting of the sliders.
        folder: Folder for saved settings.
        name: Name of the file in it, without `.toml`.
        varied: Id of the varied slider, and its first value, last value and number of values.

    Returns:
        Campaign file.

    Raises:
        InputError: The name is wrong or exists, or a value is refused.
    """
    place = _choose_place(folder, f"{name}.toml", name)
    slider, (start, stop, count) = find_slider(explored.sliders, varied[0]), varied[1]
    if not 2 <= count <= MOST_VARIED_VALUES:
        raise InputError("number of values", f"found {count:g}", f"Give 2 to {MOST_VARIED_VALUES} values.")
    for end in (start, stop):
        set_slider(slider, end)
    space = np.geomspace if slider.is_logarithmic else np.linspace
    series = [float(f"{value:.9g}") for value in space(start, stop, int(count))]
    columns = {
        key: [base * value if slider.is_factor else value for value in series] for key, base in slider.keys.items()
    }
    _, changes = explored.change({key: value for key, value in values.items() if key != slider.id})
    replaced = [*changes, *(build_change(key, column[0]) for key, column in columns.items())]
    standing = explored.list_standing(replaced)
    content = {
        "title": f"{_describe(explored.case, changes)}, {slider.label} varied"[:200],
        **explored.source,
        "set": [*standing, *(f"{change.key}={change.value!r}" for change in changes)],
        "vary": [{"columns": columns}],
    }
    file = validate_model(content, CampaignFile, f"campaign '{place.name}'")
    prepare_campaign(file, _create(folder))
    with place.open("x", encoding="utf-8", newline="\n") as target:
        target.write(tomli_w.dumps(content))
    return place


def _choose_place(folder: Path, name: str, stem: str | None = None) -> Path:
    """Place of a new file or folder."""
    if not SAVED_NAME.fullmatch(name if stem is None else stem):
        hint = "Write at most 60 letters, digits, hyphens and underscores, the first one a letter or digit."
        raise InputError(f"name {name[:80]!r}", "cannot be used", hint)
    if (place := folder / name).exists() or place.is_symlink():
        raise InputError(f"'{place}'", "exists already", "Choose another name: nothing is replaced.")
    return place


def _create(folder: Path) -> Path:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"'{folder}'", f"cannot be created ({error.strerror})", "Name another --out.") from None
    return folder


def _dump(table: InputTable, left_out: Collection[str] = ()) -> dict[str, Any]:
    """Keys of a table as in its file, without some of them, and at all levels without the origin of the numbers."""
    kept = drop_keys(table.model_dump(mode="json", exclude_none=True, exclude={*left_out}, by_alias=True), PROVENANCE)
    return dict(kept) if isinstance(kept, dict) else {}


def _describe(case: Case, changes: Sequence[InputChange]) -> str:
    """Title of a saved setting."""
    texts = [f"{change.key} = {change.value:.6g}" for change in changes if isinstance(change.value, float)]
    return f"{case.file.title}, explored{': ' if texts else ''}{', '.join(texts)}"[:200]
