"""Comparison of two folders of artefacts: every difference with its file, its place, and both values."""

import json
from collections import Counter
from collections.abc import Iterator
from difflib import SequenceMatcher
from pathlib import Path

from verification.frozen.commands import COMMANDS
from verification.frozen.contents import read_contents
from verification.frozen.placeholders import NOT_COMPARED, replace

ABSENT = "(absent)"
LONGEST = 160
"""Characters of a value that are printed."""

CONTEXT = 6
"""Words before a difference that are printed with it."""

ITEMS = {"text": "words", "page": "words", "figure": "elements of figures", "line": "lines"}
"""Items of a sequence by the kind of the part."""

Difference = tuple[str, str, str]
"""Place in the file, old and new value."""


def compare(old: Path, new: Path, selected: list[str]) -> bool:
    """Compare the artefacts of two states and print every difference.

    Args:
        old: Folder that `write` has filled with the earlier state.
        new: Folder of the later state.
        selected: Names of the commands; all if empty.

    Returns:
        True if nothing differs.
    """
    counts, total = Counter[str](), 0
    for name in selected or COMMANDS:
        codes = [str(_read_outcomes(folder).get(name, {}).get("exit_code", ABSENT)) for folder in (old, new)]
        if codes[0] != codes[1] or codes[0] == ABSENT:  # a command that neither state has run is not an agreement
            total += _print_differences(name, [("exit code", codes[0], codes[1])])
        old_files, new_files = (_list_files(folder, name) for folder in (old, new))
        for file in sorted(old_files | new_files):
            total += _print_differences(file, list(_compare_files(file, old_files, new_files, counts)))
        counts["commands"] += 1
    print("compared: " + ", ".join(f"{count} {what}" for what, count in sorted(counts.items())))
    print(f"{total} differences")
    return total == 0


def _read_outcomes(folder: Path) -> dict[str, dict[str, object]]:
    outcomes: dict[str, dict[str, object]] = json.loads((folder / "commands.json").read_text())
    return outcomes


def _list_files(folder: Path, name: str) -> dict[str, Path]:
    """Compared files of a command by their path below the folder of artefacts."""
    files = {path.relative_to(folder).as_posix(): path for path in (folder / name).rglob("*") if path.is_file()}
    return {file: path for file, path in files.items() if not NOT_COMPARED.fullmatch(file)}


def _compare_files(
    file: str, old_files: dict[str, Path], new_files: dict[str, Path], counts: Counter[str]
) -> Iterator[Difference]:
    old, new = old_files.get(file), new_files.get(file)
    if old is None or new is None:
        yield "file", *(ABSENT if path is None else "present" for path in (old, new))
        return
    counts[f"files {new.suffix}"] += 1
    if old.read_bytes() == new.read_bytes():
        counts["files with the same bytes"] += 1
    old_parts, new_parts = (read_contents(path, replace) for path in (old, new))
    for part in old_parts | new_parts:
        old_part, new_part = old_parts.get(part), new_parts.get(part)
        if old_part is None or new_part is None:
            yield part, *(ABSENT if content is None else "present" for content in (old_part, new_part))
        elif isinstance(old_part, dict) and isinstance(new_part, dict):
            yield from _compare_values(file, old_part, new_part, counts)
        else:
            kind = part.split(" ")[0]
            if kind in ("page", "figure"):
                counts[f"{kind}s"] += 1
            counts[ITEMS[kind]] += len(new_part)
            yield from _compare_sequences(part, list(old_part), list(new_part))


def _compare_values(file: str, old: dict[str, str], new: dict[str, str], counts: Counter[str]) -> Iterator[Difference]:
    for place in old | new:
        if NOT_COMPARED.fullmatch(file + place):
            counts["values left out"] += 1
            continue
        counts["values"] += 1
        if old.get(place) != new.get(place):
            yield place, old.get(place, ABSENT), new.get(place, ABSENT)


def _compare_sequences(part: str, old: list[str], new: list[str]) -> Iterator[Difference]:
    if old == new:
        return
    for operation, i, i_end, j, j_end in SequenceMatcher(None, old, new, autojunk=False).get_opcodes():
        if operation != "equal":
            before = " ".join(new[max(j - CONTEXT, 0) : j])[-LONGEST // 2 :]
            yield f"{part}, item {j + 1}, after '{before}'", " ".join(old[i:i_end]), " ".join(new[j:j_end])


def _print_differences(file: str, differences: list[Difference]) -> int:
    for place, old, new in differences:
        print(f"{file}: {place}\n  old: {_shorten(old)}\n  new: {_shorten(new)}")
    return len(differences)


def _shorten(text: str) -> str:
    return text if len(text) <= LONGEST else f"{text[: LONGEST - 20]} ... ({len(text)} characters)"
