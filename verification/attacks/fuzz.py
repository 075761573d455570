"""Byte-level fuzz of every reader: damaged files are refused with one message, or read; any other outcome is a failure.

    python -m verification.attacks.fuzz [--rounds 10000 | --seconds 600] [--seed 1] [--only ROUND] [--keep FOLDER]

Each round damages one file of a small corpus (bytes flipped, cut, doubled, swapped for tokens that break parsers),
gives it to its reader under limits of time and memory, and grades what was read. Four things are failures:

* a traceback: any exception other than `InputError`, a memory error included;
* a crash of the process, for example inside a C library;
* a hang: more than `SLOWEST_S` seconds;
* a false pass: a passing verdict that does not follow from its own numbers, or from a file whose digest is wrong.

The failing input is kept, its name printed; the exit code is 1 if there was any. Every round has its own random
numbers, so that `--only` repeats it.
"""

import argparse
import logging
import math
import multiprocessing
import random
import resource
import shutil
import signal
import sys
import tempfile
import time
import traceback
import warnings
from collections import Counter
from multiprocessing.connection import Connection
from pathlib import Path

from pantocheck.conformance.input_files.input_error import InputError
from verification.attacks.fuzz_damage import damage
from verification.attacks.fuzz_files import Target, build_targets
from verification.attacks.fuzz_uses import Falsehood, use_digested

SLOWEST_S = 20
MEMORY_BYTES = 3_000_000_000
"""Address space that a reader may take on top of the sound process."""
BATCH = 200
"""Rounds in one process; a crash ends its batch, and the next process goes on after the round that crashed."""


def run_round(target: Target, folder: Path, chance: random.Random) -> str:
    """Give a damaged file to its reader; the outcome is `read`, `refused` or an exception."""
    content = damage(target.files[target.damaged], chance)
    for name, original in target.files.items():
        (folder / name).write_bytes(content if name == target.damaged else original)
    if target.use is use_digested and content == target.files[target.damaged]:
        return "read"
    try:
        target.use(folder)
    except InputError as error:
        if any(not problem.found or not problem.hint or len(problem.message) > 3000 for problem in error.problems):
            raise Falsehood(f"a message without place, fault or hint: {str(error)[:200]!r}") from None
        return "refused"
    return "read"


class Hang(BaseException):
    """A reader exceeds the time limit."""


def _hang(*_: object) -> None:
    raise Hang(f"more than {SLOWEST_S} s")


def run_batch(targets: list[Target], first: int, seed: int, scratch: Path, kept: Path, answers: Connection) -> None:
    """Run rounds in a process of its own and send (round, outcome or None at its start, message)."""
    signal.signal(signal.SIGALRM, _hang)
    warnings.simplefilter("ignore")  # Libraries warn of every object of a damaged file.
    logging.disable(logging.CRITICAL)
    used = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (used + MEMORY_BYTES, used + MEMORY_BYTES))
    for number in range(first, first + BATCH):
        target = targets[number % len(targets)]
        shutil.rmtree(scratch, ignore_errors=True)
        scratch.mkdir()
        answers.send((number, None, ""))
        signal.alarm(SLOWEST_S)
        try:
            outcome, message = run_round(target, scratch, random.Random(f"{seed}/{number}")), ""
        except (Exception, Hang) as error:
            signal.alarm(0)
            outcome, message = "FAILED", f"{type(error).__name__}: {str(error)[:160]}"
            folder = keep_input(scratch, kept, number)
            (folder / "why.txt").write_text("".join(traceback.format_exception(error)), encoding="utf-8")
        finally:
            signal.alarm(0)
        answers.send((number, outcome, message))


def keep_input(scratch: Path, kept: Path, number: int) -> Path:
    """Copy the input of a round to the folder of failures."""
    folder = kept / f"{number:06d}"
    shutil.copytree(scratch, folder, dirs_exist_ok=True)
    return folder


def run_campaign(rounds: float, seconds: float, seed: int, kept: Path, first: int = 0) -> int:
    """Fuzz all readers in turn until the rounds or the time are over, and return the number of failures."""
    outcomes, fork = Counter[tuple[str, str]](), multiprocessing.get_context("fork")
    with tempfile.TemporaryDirectory() as name:
        targets, scratch = build_targets(Path(name, "sound")), Path(name, "scratch")
        end, number = time.monotonic() + seconds, first
        while number < first + rounds and time.monotonic() < end:
            receiver, sender = fork.Pipe(duplex=False)
            process = fork.Process(target=run_batch, args=(targets, number, seed, scratch, kept, sender))
            process.start()
            sender.close()
            finished = True
            while number < first + rounds and time.monotonic() < end:
                try:
                    number, outcome, message = receiver.recv()
                except EOFError:
                    break
                finished = outcome is not None
                if outcome is not None:
                    outcomes[targets[number % len(targets)].name, outcome] += 1
                    number += 1
                if message:
                    print(f"round {number - 1}, {targets[(number - 1) % len(targets)].name}: {message}", flush=True)
            else:
                process.kill()
                finished = True
            process.join()
            if not finished:
                target = targets[number % len(targets)].name
                outcomes[target, "FAILED"] += 1
                print(f"round {number}, {target}: crash, exit {process.exitcode}", flush=True)
                keep_input(scratch, kept, number)
                number += 1
    for (target, outcome), count in sorted(outcomes.items()):
        print(f"{target:28} {outcome:8} {count:7}")
    failures = sum(count for (_, outcome), count in outcomes.items() if outcome == "FAILED")
    peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024
    print(f"{sum(outcomes.values())} rounds, {failures} failures, peak memory of a process {peak:.0f} MB")
    return failures


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--rounds", type=int, default=math.inf)
    parser.add_argument("--seconds", type=float, default=math.inf)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", type=int, help="repeat one round")
    parser.add_argument("--keep", type=Path, default=Path("fuzz-failures"))
    options = parser.parse_args()
    if options.only is not None:
        sys.exit(bool(run_campaign(1, math.inf, options.seed, options.keep, options.only)))
    rounds = 10_000 if math.isinf(options.rounds) and math.isinf(options.seconds) else options.rounds
    sys.exit(bool(run_campaign(rounds, options.seconds, options.seed, options.keep)))


if __name__ == "__main__":
    main()
