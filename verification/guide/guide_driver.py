"""Known limitations of the suite, from the Markdown file that is their only home."""

import multiprocessing
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from dataclasses import dataclass, field
from pathlib import Path

from pantocheck.conformance.core.processes import end_workers, handle_worker_signals, limit_threads
from pantocheck.conformance.core.results_part import ResultsPart
from verification.guide.guide_format import FailedPart, Limitation
from verification.guide.guide_tasks import GuideStore, GuideTask

DOCS = Path(__file__).parents[2] / "docs"
LIMITATIONS_FILE = "known-limitations.md"
"""Page of the documentation: a heading of second level per limitation, and list items below it."""


def read_limitations() -> list[Limitation]:
    """Known limitations, in the order of their file."""
    text = (DOCS / LIMITATIONS_FILE).read_text("utf-8")
    return [_read_limitation(part) for part in text.split("\n## ")[1:]]


def _read_limitation(part: str) -> Limitation:
    title, _, body = part.partition("\n")
    items = [" ".join(item.split()) for item in f"\n{body}".split("\n* ")[1:]]
    return Limitation(title=title.strip(), sentences=items)


# Driver of the guide: computes its open parts on several processes, and stores each as soon as it is finished.
Report = Callable[[str, Sequence[str]], None]
"""Callback with the name of the part that is finished now (empty: none), and the names of all finished parts."""


@dataclass(frozen=True)
class GuideParts:
    """Contents of the parts by name, and the parts that failed."""

    contents: dict[str, ResultsPart] = field(default_factory=dict)
    failed: list[FailedPart] = field(default_factory=list)

    def join(self, other: "GuideParts") -> "GuideParts":
        """Parts of both."""
        return GuideParts({**self.contents, **other.contents}, [*self.failed, *other.failed])


def compute_parts(tasks: Sequence[GuideTask], store: GuideStore, jobs: int, report: Report) -> GuideParts:
    """Compute all parts that the store does not hold.

    Args:
        tasks: Parts of the guide.
        store: Finished parts.
        jobs: Number of processes; 1 computes in this process.
        report: Callback after every part.

    Returns:
        All parts, in the order of the tasks.
    """
    known = {task.name: content for task in tasks if (content := store.read(task)) is not None}
    failed: dict[str, FailedPart] = {}
    waiting = [task for task in tasks if task.name not in known]
    report("", list(known))
    for task, outcome in _run_here(waiting) if jobs == 1 else _run_in_processes(waiting, jobs):
        if isinstance(outcome, FailedPart):
            failed[task.name] = outcome
        else:
            store.write(task, outcome)
            known[task.name] = outcome
        report(task.name, [*known, *failed])
    names = [task.name for task in tasks]
    return GuideParts({name: known[name] for name in names if name in known}, [failed[n] for n in names if n in failed])


def compute_part(task: GuideTask) -> ResultsPart:
    """Content of a part; an exception becomes the reason of a failed part."""
    try:
        return task.compute()
    except Exception as error:
        text = " ".join(f"{type(error).__name__}: {error}".split())[:500]
        return FailedPart(part=task.name, reason=text)


def _run_here(tasks: Sequence[GuideTask]) -> Iterator[tuple[GuideTask, ResultsPart]]:
    for task in tasks:
        yield task, compute_part(task)


def _run_in_processes(tasks: Sequence[GuideTask], jobs: int) -> Iterator[tuple[GuideTask, ResultsPart]]:
    """Parts as they are finished. An interruption ends all processes; a process that dies fails the open parts."""
    limit_threads()
    others = set(multiprocessing.active_children())
    # Fresh interpreters: threads of a compiled kernel do not survive a fork.
    pool = ProcessPoolExecutor(jobs, multiprocessing.get_context("spawn"), handle_worker_signals)
    try:
        futures: dict[Future[ResultsPart], GuideTask] = {pool.submit(compute_part, task): task for task in tasks}
        for future in as_completed(futures):
            task, error = futures[future], future.exception()
            yield task, future.result() if error is None else FailedPart(part=task.name, reason=str(error))
    except KeyboardInterrupt:
        end_workers(set(multiprocessing.active_children()) - others)
        raise
    finally:
        pool.shutdown(wait=True, cancel_futures=True)
