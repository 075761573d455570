"""Archive of an FMU, which is a stranger's: every entry is checked before anything of it is written."""

import hashlib
import stat
import zipfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path, PurePosixPath

from pantocheck.conformance.core.files import open_file
from pantocheck.conformance.core.input_error import InputError

LARGEST_ARCHIVE, LARGEST_CONTENT = 2**29, 2**30
"""Largest archive, and largest content of all entries [bytes]."""
LARGEST_COUNT = 20_000
LARGEST_EXPANSION = 200
"""Largest content over the size of an archive above `FREE_CONTENT`; compiled code and tables reach 10."""
FREE_CONTENT = 2**24
"""Content that is accepted at any ratio [bytes]."""
DESCRIPTION, LARGEST_DESCRIPTION = "modelDescription.xml", 2**24
"""Required entry, and its largest size [bytes]."""
_CHUNK = 2**20


def unpack_fmu(path: Path, folder: Path, digest: str | None) -> None:
    """Unpack an FMU into an empty folder.

    Args:
        path: Archive.
        folder: Empty folder.
        digest: Expected SHA-256 in hexadecimal; None: any.

    Raises:
        InputError: The archive is damaged, too large, has another digest, or has an entry outside of the folder.
    """
    where = f"FMU '{path.name}'"
    with open_file(path, where, LARGEST_ARCHIVE) as file, _refuse_damage(where):
        if digest not in (None, found := hashlib.file_digest(file, "sha256").hexdigest()):
            raise InputError(where, f"has the SHA-256 {found}", "The file has changed since its digest was stated.")
        size = file.tell()
        file.seek(0)
        with zipfile.ZipFile(file) as archive:
            entries = _check_entries(archive, size, where)
            for entry, name in entries.items():
                _write_entry(archive, entry, folder / name)


@contextmanager
def _refuse_damage(where: str) -> Iterator[None]:
    """Convert errors of a damaged archive into `InputError`."""
    damage = (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, RuntimeError, ValueError, OSError)
    try:
        yield
    except InputError:
        raise
    except (*damage, OverflowError, MemoryError, KeyError) as error:
        text = " ".join(str(error).split())[:200] or type(error).__name__
        raise InputError(where, f"is damaged ({text})", "Export it again, or copy it again.") from None


def _check_entries(archive: zipfile.ZipFile, size: int, where: str) -> dict[zipfile.ZipInfo, PurePosixPath]:
    """Entries that are files, with their places; their stated sizes are checked before any of them is read."""

    def refuse(found: str) -> InputError:
        return InputError(where, found, "Ask its maker for a valid archive.")

    entries = archive.infolist()
    if len(entries) > LARGEST_COUNT:
        raise refuse(f"has {len(entries)} entries, at most {LARGEST_COUNT} are accepted")
    content = sum(entry.file_size for entry in entries)
    if content > min(LARGEST_CONTENT, max(FREE_CONTENT, LARGEST_EXPANSION * size)):
        raise refuse(f"holds {content} bytes in an archive of {size} bytes")
    files: dict[zipfile.ZipInfo, PurePosixPath] = {}
    seen: set[str] = set()
    for entry in entries:
        name = entry.orig_filename
        parts = name.rstrip("/").split("/")
        if any(part in ("", ".", "..") or part.endswith((" ", ".")) for part in parts) or set(name) & set(
            '\\:\0*?"<>|'
        ):
            raise refuse(f"has an entry outside of its folder, or with a forbidden name: {name[:100]!r}")
        mode = stat.S_IFMT(entry.external_attr >> 16)
        if mode not in (0, stat.S_IFREG, stat.S_IFDIR):
            raise refuse(f"has an entry that is a link or a device: {name[:100]!r}")
        if entry.flag_bits & 1:
            raise refuse(f"has an encrypted entry: {name[:100]!r}")
        if entry.is_dir():
            continue
        if name.casefold() in seen:
            raise refuse(f"has two entries of the same name: {name[:100]!r}")
        seen.add(name.casefold())
        files[entry] = PurePosixPath(name)
    description = next((entry for entry, name in files.items() if str(name) == DESCRIPTION), None)
    if description is None:
        raise refuse(f"has no {DESCRIPTION}")
    if description.file_size > LARGEST_DESCRIPTION:
        raise refuse(f"has a {DESCRIPTION} of {description.file_size} bytes")
    return files


def _write_entry(archive: zipfile.ZipFile, entry: zipfile.ZipInfo, path: Path) -> None:
    """Write one entry, exactly as many bytes as it states."""
    path.parent.mkdir(parents=True, exist_ok=True)
    left = entry.file_size
    with archive.open(entry) as source, path.open("xb") as target:
        while chunk := source.read(_CHUNK):
            left -= len(chunk)
            if left < 0:
                raise ValueError(f"the entry {entry.filename[:100]!r} is longer than stated")
            target.write(chunk)
    if left:
        raise ValueError(f"the entry {entry.filename[:100]!r} is shorter than stated")
