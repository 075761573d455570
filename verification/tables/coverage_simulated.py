"""Coverage of the intervals from the length of a record, on passages of the simulator over lines with irregularity.

python -m verification.tables.coverage_simulated [--passages 200] [--run-in long short] [--correlation 0 0.7]

Line and train. AC simple of EN 50318:2018 without stagger, two pantographs 200 m apart, 320 km/h, elements of 1 m and
steps of 2 ms: a coarse mesh, because the share of intervals does not depend on it. The pantographs feel the additional
height

    3 mm G(x) + 4 mm exp(0.2 A(x)) n(x)

n is a Gaussian series of unit variance with the density f**-2 from 0.02 to 0.5 1/m. G and A have a value at each
support, joined by straight lines: Gaussian autoregressions of first order with unit variance and the coefficient rho
from span to span.

Rows. Every quantity of each pantograph, for rho = 0 and 0.7. Long run-in: each passage has five records of 60 spans
after a run-in of the first pantograph of 30 spans. Short run-in: each passage has one record of 60 spans after three
spans, and there are five times as many passages. Rows are not pooled. Fewer than 60 spans have no interval, see
verification/tables/coverage.py.

Seeds. The irregularity of passage p has the seed (50319, 1, spans of run-in, 100 rho, p), with p = 0, 1, 2 ... This
rule was recorded before the first run.

True values. A mean, a deviation or a share: the mean value of the stretches of 300 spans after the long run-in with the
same rho. An extreme or a number of events: the mean value of all records of 60 spans after the long run-in. Outcomes as
in verification/tables/coverage.py.
"""

import argparse
import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np
from numpy.fft import irfft, rfftfreq

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.quantities.evaluation import evaluate_signals
from pantocheck.conformance.quantities.filters import Filter
from pantocheck.conformance.quantities.line_signals import LineSignals
from pantocheck.conformance.quantities.pantograph_signals import ForceChannel, PantographSignals
from pantocheck.conformance.records.length_uncertainty import LengthUncertainty, length_uncertainties
from pantocheck.model import History, Kind, discretise, simulate_passage
from pantocheck.model.description.irregularity import Irregularity
from pantocheck.model.discretisation.discretised_line import DiscretisedLine
from verification.speed.passage_lines import ac_simple, passage, staggered
from verification.tables.coverage import HEADING, SEED, Row, build_row, draw_autoregression

SPANS, RECORDS = 60, 5
"""Spans of a record; records of a passage with a long run-in."""
RUN_IN = {"long": 30, "short": 3}
"""Spans before the first record."""
BEFORE, RESERVE = 5, 8
"""Spans before the start of the first pantograph and after the last record, for the distance of the pantographs."""
ELEMENT_M, STEP_S, REACH_M = 1.0, 2e-3, 220.0
SPACING_M, WAVES = 0.5, (0.02, 0.5)
"""Distance of the points of the irregularity [m]; lowest and highest spatial frequency [1/m]."""


class Stretch(NamedTuple):
    """Stretch of a passage that is evaluated."""

    first: int
    """Spans before it."""
    spans: int


@dataclass
class Sample:
    """Values and uncertainties of one quantity of a pantograph, of all passages of a condition."""

    values: list[float] = field(default_factory=list)
    uncertainties: list[LengthUncertainty | None] = field(default_factory=list)
    long_values: list[float] = field(default_factory=list)
    """Values of all records of a passage together."""


Samples = Mapping[tuple[int, str], Sample]
"""By number of the pantograph and quantity."""


def make_irregularity(seed: tuple[int, ...], supports: RealArray, rho: float) -> Irregularity:
    """Irregularity over a line.

    Args:
        seed: Seed of the passage.
        supports: Positions of the supports, (s,) [m].
        rho: Correlation of the values at neighbouring supports [-].
    """
    random = np.random.default_rng(seed)
    position = np.arange(supports[0], supports[-1], SPACING_M)
    level, amplitude = (
        np.interp(position, supports, draw_autoregression(random, 1, supports.size, rho)[0]) for _ in range(2)
    )
    frequency = rfftfreq(position.size, SPACING_M)
    inside = (frequency >= WAVES[0]) & (frequency <= WAVES[1])
    lines = np.zeros(frequency.size, complex)
    lines[inside] = random.standard_normal((inside.sum(), 2)).view(complex)[:, 0] / frequency[inside]
    noise = irfft(lines, position.size)
    height = 3e-3 * level + 4e-3 * np.exp(0.2 * amplitude) * noise / noise.std()
    return Irregularity(tuple(position.tolist()), tuple(height.tolist()))


def list_stretches(run_in: str) -> tuple[Stretch, ...]:
    """Records of a passage."""
    count = RECORDS if run_in == "long" else 1
    return tuple(Stretch(BEFORE + RUN_IN[run_in] + SPANS * i, SPANS) for i in range(count))


def run_passages(run_in: str, rho: float, count: int) -> Samples:
    """Simulate and evaluate the passages of a condition.

    Args:
        run_in: Kind of run-in.
        rho: Correlation of neighbouring spans [-].
        count: Number of passages.

    Returns:
        Samples by pantograph and quantity.
    """
    stretches = list_stretches(run_in)
    end = stretches[-1].first + SPANS
    case = ac_simple(end + RESERVE, stagger=0.0)
    geometry = case.line.geometry
    supports = np.array(geometry.supports)
    line = discretise(staggered(case), ELEMENT_M)
    way = passage(case, line, STEP_S, 2, supports[end + 1], REACH_M)
    way = replace(way, watched=())
    whole = Stretch(stretches[0].first, SPANS * len(stretches))
    samples: dict[tuple[int, str], Sample] = {}
    for number in range(count):
        seed = (SEED, 1, RUN_IN[run_in], round(100 * rho), number)
        history = simulate_passage(add_irregularity(line, make_irregularity(seed, supports, rho)), way)
        for pantograph in (1, 2):
            for stretch in stretches:
                signals = cut_signals(history, pantograph, supports, stretch)
                found = length_uncertainties(signals, geometry.longest_span / way.speed)
                for name, value in evaluate(signals):
                    sample = samples.setdefault((pantograph, name), Sample())
                    sample.values.append(value)
                    sample.uncertainties.append(found.get(name))
            for name, value in evaluate(cut_signals(history, pantograph, supports, whole)):
                samples[pantograph, name].long_values.append(value)
    return samples


def add_irregularity(line: DiscretisedLine, irregularity: Irregularity) -> DiscretisedLine:
    """Line with an irregularity of its contact wires, which the statics do not contain."""
    wires = (
        replace(wire, irregularity=irregularity) if wire.kind is Kind.CONTACT_WIRE else wire
        for wire in line.catenary.wires
    )
    return replace(line, catenary=replace(line.catenary, wires=tuple(wires)))


def cut_signals(history: History, pantograph: int, supports: RealArray, stretch: Stretch) -> PantographSignals:
    """Signals of a pantograph over a stretch."""
    row = pantograph - 1
    return PantographSignals(
        history.position[row],
        ForceChannel(history.force[row], 1 / STEP_S, Filter()),
        (float(supports[stretch.first]), float(supports[stretch.first + stretch.spans])),
        history.height[row],
    )


def evaluate(signals: PantographSignals) -> Iterator[tuple[str, float]]:
    """Quantities of a pantograph."""
    evaluation = evaluate_signals({1: signals}, LineSignals(signals.section))
    for name, value in evaluation.values[1].items():
        yield name, float(value)  # type: ignore[arg-type]


def list_rows(samples: Samples, truth: Samples, rho: float) -> Iterator[tuple[int, Row]]:
    """Number of the pantograph and row of each quantity.

    Args:
        samples: Samples of the condition.
        truth: Samples of the long run-in with the same correlation.
        rho: Correlation of neighbouring spans [-].
    """
    for (pantograph, name), sample in samples.items():
        known = truth[pantograph, name]
        true = {name: float(np.mean(known.long_values))}, {name: float(np.mean(known.values))}
        row = build_row(name, SPANS, rho, np.array(sample.values), sample.uncertainties, *true)
        if row is not None:
            yield pantograph, row


def main() -> None:
    """Measure and print the rows of all conditions."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--passages", type=int, default=200, help="passages with a long run-in; default: %(default)s")
    parser.add_argument("--run-in", nargs="*", default=list(RUN_IN), choices=RUN_IN)
    parser.add_argument("--correlation", nargs="*", type=float, default=[0.0, 0.7])
    options, begin = parser.parse_args(), time.process_time()
    for columns, line in zip(("| run-in [spans] | pantograph ", "|--:|--:"), HEADING.splitlines(), strict=True):
        print(columns + line)
    for rho in options.correlation:
        truth = run_passages("long", rho, options.passages)
        for run_in in options.run_in:
            count = options.passages * RECORDS
            samples = truth if run_in == "long" else run_passages(run_in, rho, count)
            for pantograph, row in list_rows(samples, truth, rho):
                print(f"| {RUN_IN[run_in]} | {pantograph} {row.text}", flush=True)
    print(f"\n{time.process_time() - begin:.0f} s of process time.")


if __name__ == "__main__":
    main()
