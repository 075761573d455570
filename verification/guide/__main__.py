"""Write the verification and validation guide: every number is computed now, by this version.

    python -m verification.guide --out guide --jobs 2

Closed forms, second formulations, peers, published cases, uncertainty, self-test and computing times. Packages of peers
are compared where they are installed. Finished parts are stored: after an interruption the same command continues, and
another version computes all parts again. The exit code is 1 if a result lies outside its tolerance or is not computed.
"""

import argparse
import json
import sys
from collections.abc import Sequence
from pathlib import Path

from pantocheck.conformance.app.commands.guard import guard_command
from pantocheck.conformance.app.commands.progress_display import follow_steps
from pantocheck.conformance.core.files import check_writable, write_atomically
from pantocheck.conformance.core.json_file import write_model
from pantocheck.conformance.pages.report_writers import remark_missing_formats, write_document
from verification.guide.guide_building import build_guide, guide_identity, list_deviations
from verification.guide.guide_driver import compute_parts
from verification.guide.guide_format import Guide
from verification.guide.guide_tasks import GuideStore, list_tasks, list_timings, sum_durations
from verification.guide.guide_values import list_guide_values
from verification.guide.pages.guide_page import build_guide_page

VALUES_FILE = "guide-values.json"
"""Numbers of the guide by name, which the documentation prints."""


def write_guide(out: Path, jobs: int) -> list[str]:
    """Write guide.html, guide.pdf, guide.json and the numbers for the documentation.

    Args:
        out: Folder of the files.
        jobs: Number of parallel processes.

    Returns:
        Names of the results that lie outside their tolerance or are not computed.
    """
    check_writable(out)
    store = GuideStore(out, guide_identity())
    tasks, timings = list_tasks(), list_timings()
    with follow_steps("guide", len(tasks) + len(timings)) as progress:
        names = [task.name for task in tasks]
        total = sum_durations([*names, *(task.name for task in timings)])

        def report(part: str, finished: Sequence[str]) -> None:
            progress.reach(part, len(finished), sum_durations(finished) / total)

        parts = compute_parts(tasks, store, jobs, report)
        timed = compute_parts(timings, store, 1, lambda part, finished: report(part, [*names, *finished]))
    guide = build_guide(parts.join(timed))
    write_model(out / "guide.json", guide)
    write_atomically(out / VALUES_FILE, _encode_values(guide))
    write_document(build_guide_page(guide.model_dump(mode="json", by_alias=True)), out / "guide")
    return list_deviations(guide)


def _encode_values(guide: Guide) -> bytes:
    """Numbers of the guide for the documentation, with the stamps of suite and date."""
    stamps = {"suite": guide.suite.model_dump(mode="json"), "created": guide.created}
    content = {**stamps, "values": list_guide_values(guide)}
    return (json.dumps(content, indent=1, allow_nan=False) + "\n").encode("ascii")


def main(arguments: Sequence[str] | None = None) -> int:
    """Write the guide; exit code 0 if every part holds, 1 if not, 2 after wrong input."""
    parser = argparse.ArgumentParser(
        prog="python -m verification.guide", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--jobs", type=int, default=1)
    options = parser.parse_args(arguments)
    deviations = guard_command(write_guide)(options.out, options.jobs)
    for remark in remark_missing_formats():
        print(f"remark: {remark}", file=sys.stderr)
    if deviations:
        print(f"{len(deviations)} results outside their tolerance, or not computed")
    print("\n".join(f"  {name}" for name in deviations) or "All parts hold.")
    return 1 if deviations else 0


if __name__ == "__main__":
    sys.exit(main())
