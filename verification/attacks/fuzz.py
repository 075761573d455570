"""Fuzz of every reader: damaged files are refused with one message, or read; any other outcome is a failure.

    python -m verification.attacks.fuzz [--rounds 10000] [--seed 1] [--keep FOLDER] [--targets NAME ...]

Hypothesis damages one file of a small corpus at one to four places. The file goes to its reader under limits of time
and memory, and what was read is graded. Four things are failures:

* a traceback: any exception other than `InputError`, a memory error included;
* a crash of the process, for example inside a C library;
* a hang: more than `SLOWEST_S` seconds;
* a false pass: a passing verdict that does not follow from its own numbers, or from a file whose digest is wrong.

The first failure of a reader is made small and kept with its reason. The exit code is 1 if there was any.
"""

import argparse
import logging
import multiprocessing
import re
import resource
import shutil
import signal
import sys
import tempfile
import traceback
import warnings
from collections import Counter
from multiprocessing.connection import Connection
from pathlib import Path

from hypothesis import HealthCheck, Phase, given, seed, settings
from hypothesis import strategies as st

from pantocheck.conformance.core.input_error import InputError
from verification.attacks.fuzz_files import Target, build_targets
from verification.attacks.fuzz_uses import Falsehood, use_digested

SLOWEST_S = 20
MEMORY_BYTES = 3_000_000_000
"""Address space that a reader may take on top of the sound process."""
LONGEST_MESSAGE = 3000

NUMBER = re.compile(rb"-?\d+(\.\d+)?([eE][-+]?\d+)?")
NUMBERS = ("0", "-1", "1e9", "1e300", "9" * 20, "0.5", "-0.0", "2", "nan", "inf", "-inf", "1e999", "-1e308", "1e-320")
TEXTS = (
    "9" * 400, "true", "null", '""', "[]", "{}", "[[", "'''", '"""', "\\u0000", "\x00", "\ufeff", "\u202e", "é", "\r",
    "\n\n", "=", ",", ",,", ";", "#", "0x1p9", "../../etc/passwd", "C:\\x", "1_000", "1.5.2", "2026-11-20", "." * 50,
    "1979-05-27T07:32:00Z", "a" * 5000, "pantograph = 99", "\n[line]\n", "\n[[limit]]\n", "speed_km_h = 0.0\n",
    "speed_km_h = 1e300\n",
)  # fmt: skip
"""Texts that break parsers."""


def damage(content: bytes) -> st.SearchStrategy[bytes]:
    """Contents of a file in which one to four stretches are replaced, removed or doubled."""
    lengths = st.sampled_from((0, 1, 4, 30, 1000, len(content)))
    stretches = st.builds(lambda begin, length: (begin, begin + length), st.integers(0, len(content)), lengths)
    texts = st.sampled_from([text.encode() for text in (*NUMBERS, *TEXTS)])
    news = (
        texts
        | st.binary(max_size=50)
        | st.builds(lambda part, n: content[slice(*part)] * n, stretches, st.integers(0, 3))
    )
    changes = st.tuples(stretches, news)
    if numbers := [match.span() for match in NUMBER.finditer(content)]:
        changes |= st.tuples(st.sampled_from(numbers), st.sampled_from([text.encode() for text in NUMBERS]))
    return st.lists(changes, min_size=1, max_size=4).map(lambda chosen: _replace(content, chosen))


def _replace(content: bytes, changes: list[tuple[tuple[int, int], bytes]]) -> bytes:
    for (begin, end), new in sorted(changes, reverse=True):
        content = content[:begin] + new + content[end:]
    return content


def use_damaged(target: Target, content: bytes, folder: Path) -> str:
    """Give a damaged file to its reader; the outcome is `read` or `refused`, and anything else an exception."""
    for name, original in target.files.items():
        (folder / name).write_bytes(content if name == target.damaged else original)
    if target.use is use_digested and content == target.files[target.damaged]:
        return "read"
    try:
        target.use(folder)
    except InputError as error:
        if any(not fault.found or not fault.hint or len(fault.message) > LONGEST_MESSAGE for fault in error.problems):
            raise Falsehood(f"a message without place, fault or hint: {str(error)[:200]!r}") from None
        return "refused"
    return "read"


class Hang(BaseException):
    """A reader exceeds the time limit; Hypothesis ends at once and makes no smaller input."""


def _hang(*_: object) -> None:
    raise Hang(f"more than {SLOWEST_S} s")


def fuzz_target(target: Target, rounds: int, first_seed: int, folder: Path) -> Counter[str]:
    """Number of outcomes of a reader; the folder holds the last input, which is the smallest one of a failure."""
    outcomes = Counter[str]()

    @seed(first_seed)
    @settings(
        max_examples=rounds,
        deadline=None,
        database=None,
        phases=(Phase.generate, Phase.shrink),
        report_multiple_bugs=False,
        suppress_health_check=list(HealthCheck),
    )
    @given(damage(target.files[target.damaged]))
    def run_round(content: bytes) -> None:
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir()
        signal.alarm(SLOWEST_S)
        try:
            outcomes[use_damaged(target, content, folder)] += 1
        finally:
            signal.alarm(0)

    run_round()
    return outcomes


def _run_process(target: Target, rounds: int, first_seed: int, folder: Path, answers: Connection) -> None:
    signal.signal(signal.SIGALRM, _hang)
    warnings.simplefilter("ignore")  # Libraries warn of every object of a damaged file.
    logging.disable(logging.CRITICAL)
    used = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (used + MEMORY_BYTES, used + MEMORY_BYTES))
    try:
        answers.send((fuzz_target(target, rounds, first_seed, folder), ""))
    except (Exception, Hang) as error:
        answers.send((Counter(), "".join(traceback.format_exception(error))))


def run_campaign(targets: list[Target], rounds: int, first_seed: int, kept: Path) -> int:
    """Fuzz every reader in a process of its own, print the outcomes, and return the number of readers that failed."""
    fork, failures, total = multiprocessing.get_context("fork"), 0, 0
    for target in targets:
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name, "input")
            receiver, sender = fork.Pipe(duplex=False)
            process = fork.Process(target=_run_process, args=(target, rounds, first_seed, folder, sender))
            process.start()
            sender.close()
            try:
                outcomes, failure = receiver.recv()
            except EOFError:
                outcomes, failure = Counter(), "crash of the process"
            process.join()
            if failure:
                failures += 1
                place = kept / re.sub(r"\W+", "-", target.name)
                shutil.copytree(folder, place, dirs_exist_ok=True)
                (place / "why.txt").write_text(failure, encoding="utf-8")
                print(f"{target.name}: FAILED, input kept in {place}: {failure.strip().splitlines()[-1]}", flush=True)
            else:
                total += outcomes.total()
                print(f"{target.name:28} {outcomes['read']:7} read {outcomes['refused']:7} refused", flush=True)
    print(f"{total} rounds without a failure, {failures} of {len(targets)} readers failed")
    return failures


def main() -> int:
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=10_000, help="rounds of all readers together")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--keep", type=Path, default=Path(tempfile.gettempdir(), "pantocheck-fuzz"))
    parser.add_argument("--targets", nargs="*", help="names of readers; default: all")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        targets = build_targets(Path(name, "sound"))
        chosen = [target for target in targets if not options.targets or target.name in options.targets]
        return min(1, run_campaign(chosen, -(-options.rounds // len(targets)), options.seed, options.keep))


if __name__ == "__main__":
    sys.exit(main())
