"""Compare the numbers of a guide with those that the documentation prints, or renew them.

python -m verification.guide.printed_values compare GUIDE_DIR     exit code 1 if a number differs
python -m verification.guide.printed_values renew GUIDE_DIR       write docs/guide-values.json

`python -m verification.guide --out GUIDE_DIR` writes guide-values.json. Values of one
version differ between machines by rounding.
"""

import argparse
import json
import shutil
import sys
from pathlib import Path

COMMITTED = Path(__file__).parents[2] / "docs" / "guide-values.json"

RELATIVE, ABSOLUTE = 1e-4, 1e-9
"""Largest differences: rounding of other processors and libraries grows to 1e-6 of a force over a passage. Deviations
at rounding level differ by their own size."""


def list_differences(guide: dict[str, float], committed: dict[str, float]) -> list[str]:
    """Names with both values, where they differ or one is missing."""
    found = []
    for name in sorted(guide.keys() | committed.keys()):
        new, old = guide.get(name), committed.get(name)
        if new is None or old is None or abs(new - old) > RELATIVE * max(abs(new), abs(old)) + ABSOLUTE:
            found.append(f"{name}: {new} in the guide, {old} in {COMMITTED.name}")
    return found


def main() -> None:
    """Compare or renew."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("task", choices=("compare", "renew"))
    parser.add_argument("folder", type=Path)
    options = parser.parse_args()
    written = options.folder / COMMITTED.name
    if options.task == "renew":
        shutil.copyfile(written, COMMITTED)
        return
    values, committed = (json.loads(path.read_text("utf-8"))["values"] for path in (written, COMMITTED))
    differences = list_differences(values, committed)
    print("\n".join(differences) or f"{len(values)} numbers agree")
    sys.exit(1 if differences else 0)


if __name__ == "__main__":
    main()
