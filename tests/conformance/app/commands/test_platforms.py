"""Windows and macOS, simulated: absent functions, paths, encodings, line ends, and names of files."""

import ast
import io
import os
import re
import runpy
import shlex
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path, PureWindowsPath
from typing import Any

import pytest

from pantocheck.conformance.app.commands.output_settings import REPLACEMENTS, accept_all_characters
from pantocheck.conformance.core import processes
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.table_sidecar import find_table_name_problems
from pantocheck.conformance.core.toml_file import read_toml
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.runs import program

ROOT = Path(__file__).parents[4]
POSIX_ONLY = {
    "signal": "SIGKILL SIGHUP SIGALRM SIGCHLD SIGUSR1 alarm setitimer pthread_sigmask",
    "os": "O_NOFOLLOW O_NONBLOCK O_CLOEXEC WNOHANG killpg getpgid setsid getsid fork getuid geteuid sched_getaffinity "
    "mkfifo uname statvfs chown",
}
"""Names that Windows lacks, by module (documentation of Python: availability)."""

POSIX_MODULES = ("fcntl", "grp", "pwd", "resource", "termios", "pty", "syslog")


def test_process_control_loads_without_the_signals_of_posix(monkeypatch: pytest.MonkeyPatch) -> None:
    """Every command imports this file; with SIGKILL as a default value, none started on Windows."""
    monkeypatch.delattr(signal, "SIGKILL")
    assert runpy.run_path(processes.__file__)["KILL"] == signal.SIGTERM


SCRIPT = f"""
import os, pkgutil, importlib, signal, sys
import filelock, h5py, jinja2, matplotlib.figure, numba, pydantic, pypdf, pytest, pyuff, rich.progress, scipy.signal
import concurrent.futures, http.server, multiprocessing.pool, sqlite3, subprocess, threadpoolctl, typer.testing, typst
import asyncio, socket, ssl, urllib.request, webbrowser, email
for module, names in {POSIX_ONLY!r}.items():
    for name in names.split():
        if hasattr(sys.modules[module], name):
            delattr(sys.modules[module], name)
for name in {POSIX_MODULES!r}:
    sys.modules[name] = None  # an import raises ImportError
import pantocheck.conformance, pantocheck.model
skipped = 0
for package in (pantocheck.model, pantocheck.conformance):
    for module in pkgutil.walk_packages(package.__path__, package.__name__ + "."):
        if module.name == "pantocheck.model.dynamics.time_step":
            continue  # a library in C without Python
        try:
            importlib.import_module(module.name)
        except ImportError as error:
            # an extra that is not installed, or whose own code needs such a module
            assert not str(error.name).startswith("pantocheck"), error
            skipped += 1
assert skipped < 15, skipped
from pantocheck.conformance.app.commands.command_list import app
arguments = ["run", "en50318-2002/250", "--system", "record:en50318-2002/known-passing-code", "--verdicts", "criteria"]
result = typer.testing.CliRunner().invoke(app, [*arguments, "--out", sys.argv[1]])
assert (result.exit_code, "UNCONFIRMED" in result.output) == (1, True), result.output
"""


@pytest.mark.thorough
def test_all_modules_and_a_run_without_the_functions_of_posix(tmp_path: Path) -> None:
    """Also with an encoding at every text file: a default encoding is a warning, and warnings are errors."""
    # Without git on the path, because the standard library itself ends programs with SIGKILL.
    environment = {**os.environ, "PYTHONWARNDEFAULTENCODING": "1", "PATH": str(tmp_path)}
    # Other packages may rely on the default encoding; only warnings of this project count.
    code = f"import warnings; warnings.filterwarnings('error', category=EncodingWarning, module='pantocheck')\n{SCRIPT}"
    command = [sys.executable, "-c", code, str(tmp_path / "report")]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[-3000:]
    for name in ("results.json", "certificate.html", "quantities.csv", "junit.xml", "summary.md"):
        assert b"\r" not in (tmp_path / "report" / name).read_bytes()


@pytest.fixture(scope="module")
def calls() -> list[tuple[Path, ast.Call]]:
    """Calls in the files of the product that open files or start processes."""
    paths = sorted(path for folder in ("conformance", "model") for path in (ROOT / folder).rglob("*.py"))
    texts = {path: path.read_text(encoding="utf-8") for path in paths}
    opening = {path: text for path, text in texts.items() if re.search(r"open\(|_text\(|multiproc|Executor|fork", text)}
    trees = {path: ast.walk(ast.parse(text)) for path, text in opening.items()}
    return [(path, node) for path, nodes in trees.items() for node in nodes if isinstance(node, ast.Call)]


def list_text_calls(calls: list[tuple[Path, ast.Call]]) -> Iterator[tuple[str, str, set[str | None]]]:
    """Calls that open text files: place, name and keywords."""
    for path, node in calls:
        if not isinstance(node.func, ast.Attribute):
            continue  # `read_text` of this project reads UTF-8 always
        name = node.func.attr
        constants = [value.value for value in node.args if isinstance(value, ast.Constant)]
        if name == "open" and "w" in constants:
            name = "write_text"
        if name in ("read_text", "write_text") and (name == "write_text" or not constants):
            yield f"{path.relative_to(ROOT)}:{node.lineno}", name, {keyword.arg for keyword in node.keywords}


def test_text_files_state_their_encoding_and_line_ends(calls: list[tuple[Path, ast.Call]]) -> None:
    """Windows writes other line ends and reads another encoding by default: outputs would differ by system."""
    own = {"read_text": {"encoding"}, "write_text": {"encoding", "newline"}}
    faults = [place for place, name, keywords in list_text_calls(calls) if not own[name] <= keywords]
    assert faults == []


def test_names_in_the_repository_are_valid_everywhere() -> None:
    if shutil.which("git") is None or not (ROOT / ".git").exists():
        pytest.skip("the files are not in a repository of git")
    listed = subprocess.run(["git", "-C", str(ROOT), "ls-files", "-z"], capture_output=True, check=True).stdout
    names = listed.decode().rstrip("\0").split("\0")
    assert len({name.casefold() for name in names}) == len(names)  # Windows and macOS fold cases
    for name in names:
        path = PureWindowsPath(name)
        assert not path.is_reserved(), name
        assert not set(name) & set('<>:"|?*\\'), name
        assert not any(part.endswith((".", " ")) for part in path.parts), name
        assert len(name) <= 150, name  # of 260 characters, some belong to the folder of the user


def test_checkout_has_the_same_bytes_and_valid_names_on_every_system() -> None:
    """The digest of the suite is that of its files; Windows would check out other line ends."""
    assert "* text=auto eol=lf" in (ROOT / ".gitattributes").read_text(encoding="utf-8").splitlines()
    assert not [path for path in library_folder().rglob("*.toml") if b"\r" in path.read_bytes()]


@pytest.mark.parametrize("encoding", ["ascii", "cp1252", "cp850"])
def test_terminal_without_a_character_shows_a_replacement(encoding: str, monkeypatch: pytest.MonkeyPatch) -> None:
    output = io.TextIOWrapper(io.BytesIO(), encoding=encoding, newline="")
    monkeypatch.setattr(sys, "stdout", output)
    monkeypatch.setattr(sys, "stderr", output)
    accept_all_characters()
    print("≤ 5 − 鉄 50\u2009Hz\N{NO-BREAK SPACE}Ω" + "".join(REPLACEMENTS), end="")
    output.flush()
    shown = output.buffer.getvalue().decode(encoding)  # type: ignore[attr-defined]
    assert shown.replace("\N{NO-BREAK SPACE}", " ").startswith("<= 5 - ? 50 Hz ")
    assert "->" in shown


def test_command_prints_texts_of_files_to_a_western_terminal(tmp_path: Path) -> None:
    path = tmp_path / "鉄道.toml"
    path.write_text('title = "Königsberg ≤ 鉄道"\nfoo = "\u2264"\n', encoding="utf-8", newline="\n")
    environment = {**os.environ, "PYTHONIOENCODING": "cp1252"}
    arguments = [sys.executable, "-m", "pantocheck", "check", str(path), "--kind", "line"]
    done = subprocess.run(arguments, env=environment, capture_output=True, encoding="cp1252", check=False)
    assert done.returncode == 2
    assert "'??.toml'" in done.stderr
    assert "internal error" not in done.stderr
    assert "Traceback" not in done.stderr


def test_command_with_windows_paths_is_split_at_blanks_only(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(program, "ESCAPE", "")
    monkeypatch.setattr(shutil, "which", lambda name: name)
    monkeypatch.setattr(os.path, "abspath", lambda name: name)
    text = r'simulator.exe C:\work\adapter.py "D:\my files\line.toml" --drive E:\ --flag'
    parts = ("simulator.exe", r"C:\work\adapter.py", r"D:\my files\line.toml", "--drive", "E:\\", "--flag")
    assert program.split_arguments(text, tmp_path) == parts
    # A plan joins the arguments again, with quotes.
    assert program.split_arguments(shlex.join(parts), tmp_path) == parts


def test_program_is_ended_with_its_children_by_taskkill(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    class Windows:
        """Functions of the system, under the name of Windows."""

        name = "nt"

        def __getattr__(self, name: str) -> Any:
            return getattr(os, name)

    commands: list[list[str]] = []
    monkeypatch.setattr(program, "os", Windows())
    monkeypatch.setattr(program.subprocess, "run", lambda command, **_: commands.append(command))
    with program.Program([sys.executable, "-c", "import time; time.sleep(60)"], tmp_path) as running:
        number = running._process.pid
    assert commands == [["taskkill", "/T", "/F", "/PID", str(number)]]
    assert running._process.returncode is not None


def test_table_of_a_record_is_no_path_on_any_system() -> None:
    for name in ("C:table.csv", "d:x", "a\\b.csv", "../t.csv", "\\\\host\\share\\t.csv"):
        assert [*find_table_name_problems(name)], name
    assert [*find_table_name_problems("run 12:30.csv")] == []


def test_backslashes_in_texts_are_explained(tmp_path: Path) -> None:
    path = tmp_path / "plan.toml"
    path.write_text('system = "record:C:\\work\\run"\n', encoding="utf-8", newline="\n")
    with pytest.raises(InputError, match="forward slashes, or in single quotes"):
        read_toml(path, "plan")


def test_worker_processes_start_as_on_windows(calls: list[tuple[Path, ast.Call]]) -> None:
    """Without a stated method, Linux would fork and the other systems would spawn: two behaviours for one command."""
    methods = []
    for path, node in calls:
        text = ast.unparse(node.func)
        assert text not in ("multiprocessing.Process", "multiprocessing.Pool", "os.fork"), path
        if text == "multiprocessing.get_context":
            methods += [ast.literal_eval(argument) for argument in node.args] or [None]
        if text == "ProcessPoolExecutor":
            assert "get_context" in ast.unparse(node), path
    assert set(methods) == {"spawn"}
