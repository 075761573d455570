"""Comparison of runs: quantities side by side, and forces at the same positions."""

from collections.abc import Mapping, Sequence

import numpy as np

from pantocheck.conformance.comparison.compared_run import ComparedRun
from pantocheck.conformance.comparison.force_difference import (
    PairedForces,
    coherence,
    compare_force_bands,
    compare_spans,
    correlation,
    pair_forces,
    span_profile,
)
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.figure_data import Chart, LineShape, Mark, Series
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.grading.results_building import build_suite
from pantocheck.conformance.quantities.bands import EXTENDED_BAND, amplitude_spectrum
from pantocheck.conformance.quantities.evaluation import LINE, Value
from pantocheck.conformance.quantities.registry import QUANTITIES
from pantocheck.conformance.quantities.unavailable import QuantityUnavailable
from pantocheck.conformance.records.record import SPEED_TOLERANCE
from pantocheck.conformance.records.traces import thin_series
from pantocheck.conformance.results.comparison_format import (
    ComparedCase,
    ComparedOwner,
    ComparedQuantity,
    ComparedSource,
    ForceAgreement,
    RunComparison,
)
from pantocheck.conformance.results.motion_format import LineScene, PassageMotion
from pantocheck.conformance.results.supported_frequency import find_supported_Hz

# Charts of a comparison of runs: forces, spectra, coherence and differences along the spans.


FORCE_LABEL = "contact force [N]"
POSITION_LABEL = "position along the track [m]"
FREQUENCY_LABEL = "frequency [Hz]"


def build_force_charts(
    runs: Mapping[str, ComparedRun], pairs: Mapping[str, PairedForces], owner: int, supports: Sequence[float]
) -> tuple[Chart, ...]:
    """Charts of one pantograph.

    Args:
        runs: Runs by the name of their subject.
        pairs: Forces of the subjects that were compared with the first one.
        owner: Number of the pantograph.
        supports: Positions of the supports [m].

    Returns:
        Charts that have a curve.
    """
    forces = [series for name, run in runs.items() if (series := _draw_force(name, run, owner)) is not None]
    spectra = [series for name, run in runs.items() if (series := _draw_spectrum(name, run, owner)) is not None]
    limits = {name: find_supported_Hz(run.supported, str(owner)) for name, run in runs.items()}
    unsupported = [
        Mark(label=f"{name}: not supported", axis="x", low=limit, high=EXTENDED_BAND.high)
        for name, limit in limits.items()
        if limit is not None and limit < EXTENDED_BAND.high
    ]
    charts = [
        _chart("Contact force along the track.", (POSITION_LABEL, FORCE_LABEL), forces),
        _chart(
            "Difference from the force of the first subject, up to the frequency that both contain.",
            (POSITION_LABEL, "difference [N]"),
            [_line(name, pair.position, pair.difference) for name, pair in pairs.items()],
        ),
        _chart(
            "Amplitude spectrum of the delivered force.",
            (FREQUENCY_LABEL, "amplitude [N]"),
            spectra,
            unsupported,
            wide=False,
        ),
        _build_coherence_chart(pairs, unsupported),
        *_build_span_charts(pairs, supports),
    ]
    return tuple(chart for chart in charts if chart.series)


def _build_coherence_chart(pairs: Mapping[str, PairedForces], unsupported: Sequence[Mark]) -> Chart:
    found = {name: coherence(pair) for name, pair in pairs.items()}
    levels = [result.chance_level for result in found.values()]
    marks = [Mark(label="independent forces (95 %)", axis="y", low=max(levels))] if levels else []
    return _chart(
        "Coherence with the force of the first subject; independent forces lie below the dashed line at 95 % of the "
        "frequencies.",
        (FREQUENCY_LABEL, "coherence [-]"),
        [_line(name, result.frequency, result.value) for name, result in found.items()],
        [*marks, *unsupported],
        wide=False,
    )


def _build_span_charts(pairs: Mapping[str, PairedForces], supports: Sequence[float]) -> list[Chart]:
    spans = {name: compare_spans(pair, supports) for name, pair in pairs.items()}
    profiles = {name: profile for name, pair in pairs.items() if (profile := span_profile(pair, supports)) is not None}
    return [
        _chart(
            "RMS of the difference in each span.",
            ("start of the span [m]", "RMS difference [N]"),
            [
                Series(
                    label=name,
                    style="points",
                    x=[span.start_m for span in found],
                    y=[span.rms_difference_N for span in found],
                )
                for name, found in spans.items()
                if found
            ],
            wide=False,
        ),
        _chart(
            "RMS of the difference over the place in the span, all spans joined; 0 and 1 are supports.",
            ("place in the span [-]", "RMS difference [N]"),
            [_line(name, profile.place, profile.rms) for name, profile in profiles.items()],
            wide=False,
        ),
    ]


def _draw_force(name: str, run: ComparedRun, owner: int) -> Series | None:
    """Delivered force over the position in the analysis section; None without a force."""
    if owner in run.signals:
        signals = run.signals[owner]
        return _line(name, signals.position[signals.inside], signals.delivered)
    if owner in run.traces:
        return _line(name, np.array(run.traces[owner].position_m), np.array(run.traces[owner].force_N))
    return None


def _draw_spectrum(name: str, run: ComparedRun, owner: int) -> Series | None:
    """Amplitude spectrum up to the highest frequency that is known; None without a force."""
    if owner in run.signals:
        signals = run.signals[owner]
        return _line(name, *amplitude_spectrum(signals.delivered, signals.force.rate, signals.highest_frequency))
    if owner in run.traces:
        spectrum = run.traces[owner].spectrum
        return _line(name, np.array(spectrum.frequency_Hz), np.array(spectrum.amplitude_N))
    return None


def _line(name: str, x: RealArray, y: RealArray) -> Series:
    return Series(label=name, style="line", x=thin_series(x), y=thin_series(y))


def _chart(
    caption: str, labels: tuple[str, str], series: list[Series], marks: Sequence[Mark] = (), *, wide: bool = True
) -> Chart:
    return Chart(
        caption=caption,
        alternative=f"{caption} Subjects: {', '.join(item.label for item in series)}.",
        x_label=labels[0],
        y_label=labels[1],
        series=series,
        marks=list(marks),
        wide=wide,
    )


THINNED = "{name}: results hold thinned curves. Give the record for differences of the force."


def compare_subjects(subjects: Sequence[Sequence[ComparedRun]], case: str | None) -> RunComparison:
    """Compare the runs of several subjects case by case.

    Args:
        subjects: Runs of each subject, at most one per case; the others are compared with the first subject.
        case: Id of the only compared case; None: all cases that the subjects have in common.

    Returns:
        Content of comparison.json.

    Raises:
        InputError: The subjects have no common case, or it is not clear to which case a record belongs.
    """
    names = _name_subjects([runs[0] for runs in subjects])
    groups = {
        key: {name: _select_run(runs, key) for name, runs in zip(names, subjects, strict=True)}
        for key in _find_common_cases(subjects, case)
    }
    return RunComparison(
        suite=build_suite(),
        subjects=tuple(
            ComparedSource(name=name, source=runs[0].source, digest=runs[0].digest or None)
            for name, runs in zip(names, subjects, strict=True)
        ),
        cases=tuple(_compare_case(key, runs) for key, runs in groups.items()),
    )


def add_scenes(comparison: RunComparison, subjects: Sequence[Sequence[ComparedRun]]) -> RunComparison:
    """Comparison with the passages of the subjects over each other, of the cases where two or more have them.

    The lines must have the same wires; every motion is drawn over the first line at rest.
    """
    names = [subject.name for subject in comparison.subjects]
    scenes = []
    for case in comparison.cases:
        runs = [_select_run(runs, case.id) for runs in subjects]
        shape = next((run.shape for run in runs if _find_passage(run) and run.shape), None)
        if shape is None:
            continue
        moving = {
            name: motion
            for name, run in zip(names, runs, strict=True)
            if (motion := _find_passage(run)) and _list_wires(run.shape) == _list_wires(shape)
        }
        if len(moving) > 1:
            scenes.append(
                LineScene(
                    id=case.id,
                    label="",
                    line_shape=shape,
                    names=list(moving),
                    motions=list(moving.values()),
                    speed=0.1,
                    gain=5,
                    together=True,
                )
            )
    return comparison.model_copy(update={"scenes": tuple(scenes)})


def _find_passage(run: ComparedRun) -> PassageMotion | None:
    """Moving picture of a run with pantographs; None without one."""
    motion = run.motion
    return motion if motion is not None and motion.pantographs and motion.speed_m_s > 0 else None


def _list_wires(shape: LineShape | None) -> list[str]:
    return [] if shape is None else [curve.kind for curve in shape.side.curves]


def _name_subjects(runs: Sequence[ComparedRun]) -> list[str]:
    """Unique names: equal names are followed by their place in the list."""
    names = [run.name for run in runs]
    return [f"{name} ({i})" if names.count(name) > 1 else name for i, name in enumerate(names, 1)]


def _find_common_cases(subjects: Sequence[Sequence[ComparedRun]], case: str | None) -> list[str]:
    """Ids of the compared cases. A subject with one record belongs to any case, preferably to that which it states."""
    several = [[run.case for run in runs] for runs in subjects if not _is_record(runs)]
    stated = {runs[0].case for runs in subjects if _is_record(runs)} - {""}
    if not several:
        return [stated.pop() if len(stated) == 1 else ""]
    common = [name for name in several[0] if all(name in names for names in several)]
    if len(several) < len(subjects) and len(common) > 1:
        common = [name for name in common if name in stated]
    if case is not None:
        common = [name for name in common if name == case]
    if not common or (len(several) < len(subjects) and len(common) > 1):
        found = "; ".join(", ".join(sorted(set(names))) for names in several)
        raise InputError("compare", f"no common case: {found}", "Name a case of every subject with --case.")
    return common


def _is_record(runs: Sequence[ComparedRun]) -> bool:
    return runs[0].kind == "record"


def _select_run(runs: Sequence[ComparedRun], case: str) -> ComparedRun:
    return runs[0] if _is_record(runs) else next(run for run in runs if run.case == case)


def _compare_case(case: str, runs: Mapping[str, ComparedRun]) -> ComparedCase:
    first = next(iter(runs.values()))
    owners = sorted({owner for run in runs.values() for owner in run.values})
    speeds = (
        f"{name}: {run.speed_km_h:g} km/h, the first subject {first.speed_km_h:g} km/h. Forces are compared at the "
        "same position."
        for name, run in runs.items()
        if run.speed_km_h and first.speed_km_h and abs(run.speed_km_h / first.speed_km_h - 1) > SPEED_TOLERANCE
    )
    reasons = (f"{name} has no quantities: {run.reason}." for name, run in runs.items() if run.reason)
    return ComparedCase(
        id=case,
        notes=(*reasons, *speeds),
        supported=tuple(run.supported for run in runs.values()),
        owners=tuple(_compare_owner(owner, runs) for owner in owners),
    )


def _compare_owner(owner: int, runs: Mapping[str, ComparedRun]) -> ComparedOwner:
    quantities = _compare_quantities(list(runs.values()), owner)
    if owner == LINE:
        return ComparedOwner(number=owner, quantities=quantities)
    first, *others = runs
    supports = next((run.supports for run in runs.values() if run.supports), ())
    pairs: dict[str, PairedForces] = {}
    reasons = [THINNED.format(name=name) for name, run in runs.items() if owner in run.traces]
    for name in others if owner in runs[first].signals else ():
        if owner not in runs[name].signals:
            continue
        try:
            pairs[name] = pair_forces(runs[first].signals[owner], runs[name].signals[owner])
        except QuantityUnavailable as reason:
            reasons.append(f"{name}: {reason}")
    return ComparedOwner(
        number=owner,
        quantities=quantities,
        agreements=tuple(_describe_agreement(name, pair, supports) for name, pair in pairs.items()),
        reasons=tuple(reasons),
        charts=build_force_charts(runs, pairs, owner, supports),
    )


def _describe_agreement(name: str, pair: PairedForces, supports: Sequence[float]) -> ForceAgreement:
    difference = pair.difference
    return ForceAgreement(
        subject=name,
        section_m=(float(pair.position[0]), float(pair.position[-1])),
        highest_Hz=pair.highest_Hz,
        correlation=correlation(pair),
        mean_difference_N=float(difference.mean()),
        rms_difference_N=float((difference**2).mean() ** 0.5),
        bands=compare_force_bands(pair),
        spans=compare_spans(pair, supports),
    )


def _compare_quantities(runs: Sequence[ComparedRun], owner: int) -> tuple[ComparedQuantity, ...]:
    """Every quantity that a run has, in the order of reports; the first run is the reference of the differences."""
    known = {name for run in runs for name in run.values.get(owner, {})}
    return tuple(_compare_quantity(name, runs, owner) for name in QUANTITIES if name in known)


def _compare_quantity(name: str, runs: Sequence[ComparedRun], owner: int) -> ComparedQuantity:
    values = [run.values.get(owner, {}).get(name) for run in runs]
    widths = [run.uncertainty.get(owner, {}).get(name) for run in runs]
    pairs = [_compare_value(values[0], value, widths[0], width) for value, width in zip(values, widths, strict=True)]
    return ComparedQuantity(
        name=name,
        values=tuple(values),
        uncertainty=tuple(widths),
        difference=tuple(difference for difference, _ in pairs),
        beyond_uncertainty=tuple(beyond for _, beyond in pairs),
    )


def _compare_value(
    first: Value | None, other: Value | None, first_width: Value | None, other_width: Value | None
) -> tuple[float | None, bool | None]:
    """Largest difference of two values, and whether it exceeds the root of the sum of squares of their half-widths."""
    if first is None or other is None or np.shape(first) != np.shape(other):
        return None, None
    differences = np.atleast_1d(np.subtract(other, first))
    largest = float(differences[np.argmax(np.abs(differences))]) if differences.size else None
    if first_width is None or other_width is None:
        return largest, None
    return largest, bool(np.any(np.abs(differences) > np.hypot(first_width, other_width)))
