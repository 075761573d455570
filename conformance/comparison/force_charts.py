"""Charts of a comparison of runs: forces, spectra, coherence and differences along the spans."""

from collections.abc import Mapping, Sequence

import numpy as np

from pantocheck.conformance.comparison.compared_run import ComparedRun
from pantocheck.conformance.comparison.force_difference import PairedForces, coherence, compare_spans, span_profile
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.figure_data import Chart, Mark, Series
from pantocheck.conformance.quantities.bands import amplitude_spectrum
from pantocheck.conformance.records.traces import thin_series

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
    charts = [
        _chart("Contact force along the track.", (POSITION_LABEL, FORCE_LABEL), forces),
        _chart(
            "Difference from the force of the first subject, up to the frequency that both contain.",
            (POSITION_LABEL, "difference [N]"),
            [_line(name, pair.position, pair.difference) for name, pair in pairs.items()],
        ),
        _chart("Amplitude spectrum of the delivered force.", (FREQUENCY_LABEL, "amplitude [N]"), spectra, wide=False),
        _build_coherence_chart(pairs),
        *_build_span_charts(pairs, supports),
    ]
    return tuple(chart for chart in charts if chart.series)


def _build_coherence_chart(pairs: Mapping[str, PairedForces]) -> Chart:
    found = {name: coherence(pair) for name, pair in pairs.items()}
    levels = [result.chance_level for result in found.values()]
    marks = [Mark(label="independent forces (95 %)", axis="y", low=max(levels))] if levels else []
    return _chart(
        "Coherence with the force of the first subject; independent forces lie below the dashed line at 95 % of the "
        "frequencies.",
        (FREQUENCY_LABEL, "coherence [-]"),
        [_line(name, result.frequency, result.value) for name, result in found.items()],
        marks,
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
