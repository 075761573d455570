"""Coverage of the coefficients of damping in two stages: modes are sampled by their covariance, without any record.

python -m verification.tables.sampled_modes [--draws 40]

Twelve lines, the three of `field_records` with four layouts of sensors each. The decay of a drop is superposed from the
modes; its Cramer-Rao bound, with the noise of a row, is the covariance of the identified modes. Each draw samples modes
from it, the properties of the line from their tolerances of 1 %, and a scatter of the line model, and solves the fit of
line and damping about the true line. The smallest width takes properties, shapes, energies and scatter as known.

The stated deviations of the modes are the true ones: whether identification states them rightly is the subject of
`field_coverage`. Rates of clocks change frequencies and decay rates by the same factor, and damping ratios not at all.
Draw d of line l in row k has the seed (50337, k, l, d).
"""

import argparse
from dataclasses import dataclass, replace
from functools import cache
from itertools import product

import numpy as np

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.units import STANDARD_GRAVITY
from pantocheck.conformance.drops.damping_results import FORMS, FitOptions
from pantocheck.conformance.drops.drop_record import DropChannel, DropRecord
from pantocheck.conformance.drops.joint_fit import JointFit, fit_jointly, solve_about
from pantocheck.conformance.drops.line_evidence import build_intervals
from pantocheck.conformance.drops.line_fit import UNCERTAIN
from pantocheck.conformance.drops.mode_groups import assign_groups
from pantocheck.conformance.results.identified_modes import Mode, SensorShape
from pantocheck.model import Kind
from pantocheck.model.modal.modes import deflection_at
from verification.tables.field_bound import COVERED, TERMS, SmallestWidths, compute_smallest_widths
from verification.tables.field_coverage import COLOURED, HIGHEST, STRONG, WIND
from verification.tables.field_records import (
    ELEMENT,
    LINES,
    RATE,
    WIRES,
    Disturbance,
    FieldRecord,
    build_line,
    draw_layout,
    force_gain,
    move_by_wind,
)
from verification.tables.interval_share import SHARE_COLUMNS, IntervalShare, print_table

SEED, LAYOUTS, NOISE = 50337, 4, 0.003
"""Seed, layouts on each line, and white noise [m/s2]."""
CALM = Disturbance()
SHAPE_SCATTER = 0.1
"""Error of a shape at a sensor over `SHAPE_ERROR`, as in fits of simulated records [-]."""


@dataclass(frozen=True)
class SampledRow:
    """Noise of the modes, and scatter of the line model."""

    disturbance: Disturbance = CALM
    mass: tuple[float, float] = (20.0, 40.0)
    """Bounds of the mass [kg]."""
    begin: float = 3.5
    """Begin of the decay after the release: an identification begins at 1.3 s, and its filter takes 2.2 s [s]."""
    scatter: float = 0.0
    """Relative scatter of the damping ratios about the line model; that of the frequencies is a twentieth [-]."""


ROWS = {
    "none": SampledRow(),
    "ambient motion 3 mm/s2": SampledRow(Disturbance(WIND)),
    "ambient motion 10 mm/s2": SampledRow(Disturbance(STRONG)),
    "coloured noise 15 mm/s2": SampledRow(Disturbance(coloured=COLOURED)),
    "100 kg, begin after 20 s": SampledRow(mass=(100.0, 100.0), begin=20.0),
    "none, line model 0.1 %": SampledRow(scatter=0.001),
    "none, line model 0.5 %": SampledRow(scatter=0.005),
    "ambient motion 3 mm/s2, line model 0.5 %": SampledRow(Disturbance(WIND), scatter=0.005),
}
"""The number of a row counts from 0."""


@dataclass(frozen=True)
class SampledLine:
    """Fit of the true modes of a line, about which modes are sampled."""

    field: FieldRecord
    widths: SmallestWidths
    fit: JointFit
    """Its pairs are the certain modes in a group, p of them."""
    covariance: RealArray
    """Covariance of their damping ratios [-] and frequencies [Hz], (2 p, 2 p)."""

    @property
    def true(self) -> RealArray:
        """Coefficients in the order of `TERMS`, (4,)."""
        damping = self.field.line.stated.rayleigh
        return np.array([getattr(damping(Kind(kind)), f"{matrix}_coefficient") for kind, matrix in TERMS])


def superpose_drop(row: SampledRow, random: np.random.Generator, name: str, layout: int) -> FieldRecord:
    """Decay of a drop on a line as stated; the record has the places of the sensors, and no samples."""
    chosen = draw_layout(random, name, 2 + layout, row.mass)
    line = build_line(name, (1.0, 1.0), (chosen.drop[1], *(x for _, x in chosen.sensors)))
    places = [*chosen.sensors, chosen.drop]
    rows = [deflection_at(line.mesh, line.modes, line.mesh.mesh.row_of[WIRES[wire], "z"], x) for wire, x in places]
    shape, poles, n = np.array(rows[:-1]), line.poles, int(60 * chosen.minutes * RATE)
    # Free decay from the static deflection under the weight.
    start = -chosen.mass * STANDARD_GRAVITY * rows[-1] * shape / np.abs(poles) ** 2
    residue = start * poles.conj() / (poles.conj() - poles) * poles**2
    decay = 2 * (np.exp(np.outer(np.arange(n) / RATE, poles)) @ residue.T).real
    ambient, wind = np.zeros(poles.size), NOISE * row.disturbance.wind
    if wind:
        ambient = move_by_wind(poles, shape, random, n, wind)[1] * force_gain(poles)
    channels = tuple(DropChannel(f"S{i}_z", i, "z", *place) for i, place in enumerate(chosen.sensors, 1))
    record = DropRecord("sampled", "sampled", RATE, np.zeros((0, len(channels))), channels, line=line.description)
    return FieldRecord(record, line, decay, row.begin, NOISE, NOISE * row.disturbance.coloured, ambient, shape)


@cache
def build_sampled_line(row: SampledRow, number: int) -> SampledLine:
    """Line of a row, with the fit of its true modes."""
    name, layout = list(product(LINES, range(LAYOUTS)))[number]
    field = superpose_drop(row, np.random.default_rng((SEED, number)), name, layout)
    widths, poles = compute_smallest_widths(field, HIGHEST), field.line.poles
    m, std = widths.ratio.size, widths.ratio / COVERED
    reported = [j for j in range(m) if np.abs(poles[j]) < 2 * np.pi * HIGHEST]
    modes = assign_groups(
        [build_mode(field, j, float(widths.frequency[j] / COVERED), float(std[j])) for j in reported],
        len(field.line.description.spans_m),
    )
    usable = [mode for mode in modes if mode.certain and mode.group is not None]
    form = FORMS["separate"]
    fit = fit_jointly(usable, field.line.stated, FitOptions().build_prior(("tensions",)), form.shares, ELEMENT, "modes")
    paired = [reported[modes.index(mode)] for mode in fit.linear.matched.paired]
    unit = np.concatenate([1 / np.abs(poles[paired]), np.full(len(paired), 1 / (2 * np.pi))])
    places = np.concatenate([paired, np.array(paired) + m])
    return SampledLine(field, widths, fit, widths.covariance[np.ix_(places, places)] * np.outer(unit, unit))


def build_mode(field: FieldRecord, j: int, frequency_std: float, ratio_std: float) -> Mode:
    """True mode with the deviations of an identification."""
    pole, shape = field.line.poles[j], field.shape[:, j] / np.abs(field.shape[:, j]).max()
    ratio = -pole.real / abs(pole)
    return Mode(
        frequency_Hz=abs(pole) / (2 * np.pi),
        frequency_std_Hz=frequency_std,
        damping_ratio=ratio,
        damping_ratio_std=ratio_std,
        certain=bool(ratio_std < UNCERTAIN * ratio),
        sensor_shape=tuple(
            SensorShape(sensor=c.sensor, wire=c.wire, position_m=c.position, re=float(value), im=0.0, std=1e-3)
            for c, value in zip(field.record.channels, shape, strict=True)
        ),
    )


def sample_fit(line: SampledLine, scatter: float, random: np.random.Generator) -> JointFit:
    """Fit of sampled modes; the relative scatter of the line model adds to their noise."""
    linear, prior = line.fit.linear, FitOptions().build_prior(("tensions",))
    matched, p = linear.matched, len(linear.matched.pairs)
    change = np.sqrt(np.diag(prior.covariance)) * random.standard_normal(len(prior.parameters))
    # The fit is linear about the true tensions; other properties are not those that it assumes.
    factors, other = np.where(prior.is_free, 1 + change, 1.0), np.where(prior.is_free, 0.0, change)
    noise = np.linalg.cholesky(line.covariance) @ random.standard_normal(2 * p)
    model = random.standard_normal((2, p)) * np.array([[scatter], [scatter / 20]])
    measured = matched.measured
    ratio = (measured.damping_ratio + linear.damping_slope(line.true) @ other) * (1 + model[0]) + noise[:p]
    frequency = measured.frequency * np.exp(linear.frequency_slope @ other + model[1]) + noise[p:]
    usable = list(matched.usable)
    for pair, mode, f, z in zip(matched.pairs, matched.paired, frequency, ratio, strict=True):
        usable[pair.measured] = mode.model_copy(update={"frequency_Hz": float(f), "damping_ratio": float(z)})
    shapes = linear.shape_slope @ other + SHAPE_SCATTER * random.standard_normal(linear.shape_residual.size)
    sampled = replace(linear, matched=replace(matched, usable=usable), shape_residual=shapes)
    about = replace(line.fit, linear=sampled, factors=factors, values=line.true)
    return solve_about(about, prior, FORMS["separate"].shares)


def find_smallest(line: SampledLine, scatter: float) -> RealArray:
    """Smallest half-widths of the coefficients for the modes of the fit, with a known scatter, (4,)."""
    linear = line.fit.linear
    own, p = ~linear.matched.overlapping, len(linear.matched.pairs)
    covariance = line.covariance[:p, :p] + np.diag((scatter * linear.matched.measured.damping_ratio) ** 2)
    columns = linear.ratios[own]
    information = columns.T @ np.linalg.solve(covariance[np.ix_(own, own)], columns)
    return np.asarray(COVERED * np.sqrt(np.diag(np.linalg.inv(information))))


def describe_row(name: str, draws: int) -> list[str]:
    """Table row of the four coefficients together."""
    row, errors, widths, smallest = ROWS[name], [], [], []
    for number in range(len(LINES) * LAYOUTS):
        line = build_sampled_line(replace(row, scatter=0.0), number)
        known = find_smallest(line, row.scatter)
        for draw in range(draws):
            random = np.random.default_rng((SEED, list(ROWS).index(name), number, draw))
            fit = sample_fit(line, row.scatter, random)
            low, high = build_intervals(fit)
            errors.append((low + high) / 2 - line.true)
            widths.append((high - low) / 2)
            smallest.append(known)
    error, width = np.abs(np.array(errors)), np.array(widths)
    ratio, inside = width / np.array(smallest), error <= width
    share = IntervalShare(inside.size, int(inside.sum()), float(np.median(ratio)))
    return [name, f"{len(error)}", share.text, f"{COVERED * float((error / width).max()):.1f}", share.outcome]


def main() -> None:
    """Sample and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--draws", type=int, default=40, help="draws of each line; default: %(default)s")
    parser.add_argument("--rows", nargs="+", choices=ROWS, default=list(ROWS), help="default: all")
    options = parser.parse_args()
    heads = ["modes", "fits", SHARE_COLUMNS, "largest error [sd]", "outcome"]
    print_table(heads, (describe_row(name, options.draws) for name in options.rows))


if __name__ == "__main__":
    main()
