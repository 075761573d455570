"""Freeze the artefacts of the commands of one state, and compare them with those of another.

    python -m verification.frozen write DIR --pantocheck PROGRAM [--checkout DIR] [--only NAME ...]
    python -m verification.frozen compare OLD NEW [--only NAME ...]

`write` runs the commands of `commands.py` with the executable PROGRAM (default: the one on the search path).
`compare` prints every difference with its file and place; its exit code is 1 if there is one. `placeholders.py` names
the digests, versions, dates and facts of a run that are not compared.
"""

import argparse
import shutil
from pathlib import Path

from verification.frozen.commands import COMMANDS, write


def main() -> None:
    """Entry point."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    actions = parser.add_subparsers(dest="action", required=True)
    writing = actions.add_parser("write", help="run the commands of one state")
    writing.add_argument("folder", type=Path, metavar="DIR")
    writing.add_argument("--pantocheck", type=Path, default=Path(shutil.which("pantocheck") or "pantocheck"))
    writing.add_argument("--checkout", type=Path, default=Path(__file__).parents[2], help="checkout with the examples")
    comparing = actions.add_parser("compare", help="compare the artefacts of two states")
    comparing.add_argument("old", type=Path)
    comparing.add_argument("new", type=Path)
    for action in (writing, comparing):
        action.add_argument("--only", nargs="+", default=[], metavar="NAME", help="names of commands (default: all)")
    options = parser.parse_args()
    unknown = set(options.only) - set(COMMANDS)
    if unknown:
        parser.error(f"no command {', '.join(sorted(unknown))}; there are {', '.join(COMMANDS)}")
    if options.action == "write":
        agreed = write(options.folder, options.pantocheck, options.checkout, options.only)
    else:
        from verification.frozen.comparison import compare

        agreed = compare(options.old, options.new, options.only)
    raise SystemExit(0 if agreed else 1)


if __name__ == "__main__":
    main()
