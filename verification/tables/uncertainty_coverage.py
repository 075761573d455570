"""Calibration of the uncertainty: how often each component contains the true change (docs/uncertainty.md).

python -m verification.tables.uncertainty_coverage start            other starts and ramps of the 2002 model
python -m verification.tables.uncertainty_coverage run-in           sections after a longer run-in on AC simple
python -m verification.tables.uncertainty_coverage section          shifts of the analysis section by any part of a span
python -m verification.tables.uncertainty_coverage discretisation [CASE ...]   elements and steps of a quarter
"""

import argparse
import time
from collections.abc import Callable, Sequence

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import select_cases
from verification.formulations.library_passages import PASSAGES
from verification.tables.calibration import Calibration
from verification.tables.uncertainty_of_mesh import calibrate_discretisation
from verification.tables.uncertainty_of_section import calibrate_run_in, calibrate_section
from verification.tables.uncertainty_of_start import calibrate_start

SHORT, LONG = PASSAGES[:2], PASSAGES[2:4]
CALIBRATIONS: dict[str, tuple[Callable[[Case], Calibration], Sequence[str]]] = {
    "start": (calibrate_start, SHORT),
    "run-in": (calibrate_run_in, LONG),
    "section": (calibrate_section, LONG),
    "discretisation": (calibrate_discretisation, PASSAGES),
}
"""Calibration of each component, and its cases."""


def main() -> None:
    """Run and print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("component", choices=CALIBRATIONS)
    parser.add_argument("cases", nargs="*", metavar="CASE", help="default: all cases of the component")
    options = parser.parse_args()
    calibrate, default = CALIBRATIONS[options.component]
    begin, total = time.process_time(), Calibration({})
    for name in options.cases or default:
        (case,) = (case for case in select_cases([name]) if case.id == name)
        found = calibrate(case)
        found.print_table(name)
        total = total.join(found)
    total.print_summary()
    print(f"\n{time.process_time() - begin:.0f} s of process time.")


if __name__ == "__main__":
    main()
