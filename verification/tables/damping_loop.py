"""Round trip of a damping model: simulated mass drop, identified modes, fitted damping model.

    python -m verification.tables.damping_loop

Prints each coefficient of the simulation, its identified value and 95 % interval. Droppers slacken after the release.
"""

from dataclasses import replace

import numpy as np
from scipy.signal import resample_poly

from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.drops.damping_results import FitOptions, build_damping_results
from pantocheck.conformance.drops.drop_record import DropChannel, DropDescription, DropRecord
from pantocheck.conformance.drops.identify import identify_modes
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.results.identified_modes import MeasuredLine
from pantocheck.model import Kind, Rayleigh
from pantocheck.model.dynamics.drop_values import MassDropSetup as SimulatedDrop
from pantocheck.model.dynamics.mass_drop import simulate_mass_drop

PUT_IN = {
    Kind.CONTACT_WIRE: Rayleigh(0.06, 6e-5),
    Kind.MESSENGER_WIRE: Rayleigh(0.04, 9e-5),
    Kind.DROPPER: Rayleigh(0.0, 1e-5),
}
SENSORS = (("contact wire", 130.0), ("contact wire", 205.5), ("messenger wire", 77.0), ("contact wire", 310.0))
SHORT = {"contact wire": "CW", "messenger wire": "MW"}
SPANS, MASS, PLACE, HANGING, DURATION, STEP, ELEMENT, NOISE = 6, 30.0, 165.0, 6.0, 180.0, 1e-3, 1.0, 0.003


def main() -> None:
    """Simulate, identify, fit and print."""
    case = select_cases(["en50318-2002/250"])[0]
    six_spans = case.line.geometry.shorten(SPANS)
    line = replace(build_catenary(case.line.model_copy(update={"geometry": six_spans})), damping=PUT_IN)
    test = SimulatedDrop(MASS, "contact wire", PLACE, 0.0, HANGING, DURATION, STEP, SENSORS)
    decay = simulate_mass_drop(line, ELEMENT, test)
    print(f"last slack dropper {decay.last_slack} s after the release")
    signals = resample_poly(decay.motion[:, :, 2].T, 1, 5, axis=0)
    signals = signals + NOISE * np.random.default_rng(0).standard_normal(signals.shape)
    record = DropRecord(
        "loop",
        "loop",
        1 / (5 * STEP),
        signals,
        tuple(DropChannel(f"S{i}_z", i, "z", SHORT[wire], x) for i, (wire, x) in enumerate(SENSORS, 1)),
        drop=DropDescription(MASS, "CW", PLACE, HANGING),
        line=MeasuredLine(spans_m=six_spans.span_lengths),
    )
    (identification,) = identify_modes((record,))
    results = build_damping_results(identification.modes, line, ELEMENT, "the loop", FitOptions(free=()))
    for c in results.coefficients:
        expected = getattr(PUT_IN[Kind(c.kind)], f"{c.matrix}_coefficient")
        interval = f"[{c.low_95:.4g}, {c.high_95:.4g}]"
        print(f"{c.kind:<16}{c.matrix:<10} in {expected:<8.4g} out {c.value:<10.4g} {interval}")


if __name__ == "__main__":
    main()
