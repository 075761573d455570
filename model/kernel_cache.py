"""Folder of the compiled kernels where neither the installation nor the home of the user can be written."""

import atexit
import os
import shutil
import sys
import tempfile
from collections.abc import Iterator
from contextlib import suppress
from functools import cache
from pathlib import Path

VARIABLE = "NUMBA_CACHE_DIR"


def provide_kernel_cache() -> None:
    """Let numba keep its kernels in a new private folder if it finds no folder of its own; the exit removes it.

    Cached kernels are pickles, so another user must not write them: the folder has a random name and the mode 0700.
    Processes of a pool inherit it. Without a folder, numba refuses to compile.
    """
    if find_kernel_cache() is not None:
        return
    folder = tempfile.mkdtemp(prefix="pantocheck-kernels-")
    atexit.register(_remove, folder, os.getpid())
    os.environ[VARIABLE] = folder
    if "numba" in sys.modules:
        sys.modules["numba"].config.CACHE_DIR = folder
    print(
        "The kernels are compiled for this run only, because neither the installation nor the home folder can be\n"
        f"  written. Set {VARIABLE} to a folder of yours to keep them.",
        file=sys.stderr,
    )


def find_kernel_cache() -> Path | None:
    """Folder in which numba keeps the kernels: that of the user, the installation, or the home; None: none of them."""
    if VARIABLE in os.environ:
        return Path(os.environ[VARIABLE])
    home = Path(os.environ.get("XDG_CACHE_HOME") or Path(os.path.expanduser("~")) / ".cache")
    return next(filter(_is_writable, (Path(__file__).parent / "__pycache__", home)), None)


def has_kept_kernels() -> bool:
    """Whether an earlier run has kept its compiled kernels; each cache has them in folders of their own."""
    return any(_list_kept("recording.*.nbi"))


@cache
def drop_outdated_kernels() -> None:
    """Remove kept kernels that are older than a source: numba compares the file of a kernel, not what it imports."""
    newest = max(path.stat().st_mtime for path in Path(__file__).parent.rglob("*.py"))
    for file in _list_kept("*.nbi"):
        with suppress(OSError):  # another process removes it, or it belongs to another user
            if file.stat().st_mtime < newest:
                file.unlink()


def _list_kept(pattern: str) -> Iterator[Path]:
    """Kept files of the kernels of this installation."""
    folder = find_kernel_cache()
    if folder is None:
        return
    beside = folder.parent if folder.name == "__pycache__" else folder
    for depth in ("*", "*/*"):
        yield from beside.glob(f"{depth}/{pattern}")


def _is_writable(folder: Path) -> bool:
    """Whether a folder, or the nearest existing folder above it, can be written."""
    existing = next(path for path in (folder, *folder.parents) if os.path.exists(path))
    return os.path.isdir(existing) and os.access(existing, os.W_OK | os.X_OK)


def _remove(folder: str, process: int) -> None:
    """Remove the folder at the exit of the process that made it, not of its forks."""
    if os.getpid() == process:
        shutil.rmtree(folder, ignore_errors=True)
