"""Realistic results.json of a synthetic contact force.

Margin, bands and statistics are computed here independently of `quantities` and `grading`, so that a fault there shows
as a discrepancy. Texts and layout are not repeated.
"""

import math
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from pantocheck.conformance.core.figure_data import Chart
from pantocheck.conformance.pages.certificate_page import build_certificate
from pantocheck.conformance.pages.html import render_html
from pantocheck.conformance.pages.pdf import render_pdf
from pantocheck.conformance.results.results_format import Results
from pantocheck.conformance.runs.check import HOLDS, Check, Finding
from pantocheck.conformance.runs.record_checks import RECORD_CHECKS, list_check_rows

SOURCE = "Wang et al., An extended Habedank's equation-based EMTP model, IEEE Trans. Power Delivery, Table III"
SPEED = 250 / 3.6
RATE = 1000.0
SPANS_M = (240.0, 360.0)
SUPPORTS_M = [240.0, 300.0, 360.0]


def confirm(check: Check) -> Finding:
    """Finding of a check that holds: half of the smallest threshold, or its double for a check from below."""
    if not check.measures:
        return HOLDS
    measure = check.measures[0]
    return measure.compare(min(measure.thresholds.values()) * (0.5 if measure.side == "above" else 2.0), "pantograph 1")


VERIFIED = {
    "state": "consistent",
    "reason": "every consistency check that applies confirms the record",
    "checks": [
        row.model_dump(mode="json") for row in list_check_rows({check.name: confirm(check) for check in RECORD_CHECKS})
    ],
}

Signal = NDArray[np.float64]


def force(mean: float, scale: float, phase: float) -> tuple[Signal, Signal, Signal]:
    """Position [m], unfiltered and 20 Hz force [N]: span-passing, dropper-passing and high-frequency lines."""
    position = np.arange(SPANS_M[0], SPANS_M[1], SPEED / RATE)
    time = position / SPEED
    span, dropper = SPEED / 60, SPEED / 6.5
    slow = sum(a * np.cos(2 * np.pi * f * time + p + phase) for a, f, p in ((24, span, 0.4), (14, 3 * span, 1.9)))
    fast = 18 * np.cos(2 * np.pi * dropper * time + 0.3 + phase)
    above = 13 * np.cos(2 * np.pi * 31 * time + 0.8) + 6 * np.cos(2 * np.pi * 44 * time)
    below_20 = mean + scale * (slow + fast)
    return position, below_20 + scale * above, below_20


def margin(value: float, lower: float | None, upper: float | None) -> float:
    if lower is not None and upper is not None:
        if lower == upper:
            return 0.0 if value == lower else -abs(value - lower) / max(abs(lower), 1.0)
        return min(value - lower, upper - value) / ((upper - lower) / 2)
    if upper is not None:
        return (upper - value) / (abs(upper) or 1.0)
    return (value - lower) / (abs(lower) or 1.0)


def band(x: Signal, low: float, high: float) -> float:
    frequency = np.fft.rfftfreq(x.size, 1 / RATE)
    power = 2 * np.abs(np.fft.rfft(x - x.mean()) / x.size) ** 2
    return float(np.sqrt(power[(frequency > low) & (frequency <= high)].sum()))


def statistics(raw: Signal, filtered: Signal) -> dict[str, float]:
    mean, std = float(filtered.mean()), float(filtered.std())
    return {
        "mean_force_N": mean,
        "std_force_N": std,
        "std_force_50_N": float(raw.std()),
        "cov_20": std / mean,
        "cov_50": float(raw.std()) / mean,
        "rms_0_5_N": band(raw, 0, 5),
        "rms_5_20_N": band(raw, 5, 20),
        "rms_20_50_N": band(raw, 20, 50),
        "statistical_max_N": mean + 3 * std,
        "statistical_min_N": mean - 3 * std,
        "max_force_N": float(filtered.max()),
        "min_force_N": float(filtered.min()),
        "contact_loss_pct": 0.0,
    }


def criterion(
    values: dict[str, float], pantograph: int, quantity: str, unit: str, *limits: float | None
) -> dict[str, Any]:
    lower, upper = limits
    value = values[quantity]
    nearness = margin(value, lower, upper)
    return {
        "quantity": quantity,
        "pantograph": pantograph,
        "item": None,
        "value": value,
        "unit": unit,
        "lower": lower,
        "upper": upper,
        "verdict": "pass" if nearness >= 0 else "fail",
        "trust": "secondary",
        "source": SOURCE,
        "margin": nearness,
        "discretisation_error": abs(value) * 0.002,
        "reason": None,
        "uncertainty": 0.0025 * abs(value),
        "components": components(value),
    }


def components(value: float) -> dict[str, float]:
    """Half-widths in the proportion 3 to 4: combined 0.25 % of the value."""
    return {"discretisation": 0.0015 * abs(value), "start": 0.002 * abs(value)}


def uncertainty(quantities: dict[str, dict[str, float]]) -> dict[str, Any]:
    return {
        "uncertainty": {k: {name: 0.0025 * abs(v) for name, v in q.items()} for k, q in quantities.items()},
        "uncertainty_components": {k: {name: components(v) for name, v in q.items()} for k, q in quantities.items()},
        "uncertainty_basis": {
            "discretisation": "runs with element length and time step doubled, of the case and halved",
            "start": "7 runs with other starts and ramps, after a run-in of 3 spans",
            "section": "not known: the record does not extend beyond the analysis section",
            "length": "not known: the analysis section is shorter than 5 spans",
        },
    }


def rounded(x: Signal) -> list[float]:
    return [float(f"{v:.6g}") for v in x]


def trace(position: Signal, raw: Signal, filtered: Signal) -> dict[str, Any]:
    frequency = np.fft.rfftfreq(raw.size, 1 / RATE)
    amplitude = 2 * np.abs(np.fft.rfft(raw - raw.mean())) / raw.size
    shares, edges = np.histogram(filtered, bins=30)
    up_to_50 = frequency <= 50
    every = slice(None, None, max(1, math.ceil(raw.size / 1500)))
    return {
        "position_m": rounded(position[every]),
        "force_N": rounded(raw[every]),
        "force_20_N": rounded(filtered[every]),
        "mean_N": float(filtered.mean()),
        "std_N": float(filtered.std()),
        "supports_m": SUPPORTS_M,
        "spectrum": {"frequency_Hz": rounded(frequency[up_to_50]), "amplitude_N": rounded(amplitude[up_to_50])},
        "histogram": {"edges_N": rounded(edges), "share_pct": rounded(100 * shares / raw.size)},
    }


def places(position: Signal, raw: Signal, filtered: Signal) -> dict[str, Any]:
    extremes = {"max_force_N": np.argmax(filtered), "min_force_N": np.argmin(filtered)}
    return {name: {"position_m": float(position[sample])} for name, sample in extremes.items()}


def uplift(support: float, peak: float) -> dict[str, Any]:
    time = np.linspace(3.0, 6.0, 600)
    passing = support / SPEED
    shape = np.exp(-(((time - passing) / 0.12) ** 2)) + 0.15 * np.sin(2 * np.pi * 1.1 * (time - passing))
    return {"support_m": support, "time_s": rounded(time), "uplift_mm": rounded(peak * shape / shape.max())}


def run_facts(speed: float) -> dict[str, Any]:
    return {
        "simulated_s": 7.0,
        "wall_s": 0.412,
        "dt_s": 0.001,
        "element_m": 0.5,
        "speed_km_h": speed,
        "rate_Hz": 1000,
        "filter": {"kind": "butterworth", "order": 6, "cutoff_Hz": 20, "phase": "zero"},
        "evaluated_m": list(SPANS_M),
    }


def with_identity(case: dict[str, Any]) -> dict[str, Any]:
    """Case with its verdict by the criteria and its place outside the library."""
    digest = "sha256:" + 64 * "6"
    stated = {"criteria_verdict": case["verdict"], "library": "own"}
    return case | stated | {"limits_digest": digest, "stated_limits_digest": digest}


def passing_case() -> dict[str, Any]:
    front, rear = force(118.4, 0.98, 0.0), force(119.2, 1.02, 1.1)
    q1, q2 = statistics(*front[1:]), statistics(*rear[1:])
    q1["max_uplift_at_support_mm"] = 51.3
    q2["max_uplift_at_support_mm"] = 51.3
    highest = {"max_uplift_at_support_mm": {"position_m": 300.0, "time_s": 300 / SPEED}}
    limits: list[tuple[str, str, float | None, float | None]] = [
        ("mean_force_N", "N", 110, 120),
        ("std_force_N", "N", 22, 31),
        ("statistical_max_N", "N", 180, 210),
        ("statistical_min_N", "N", 20, 60),
        ("max_force_N", "N", 160, 210),
        ("min_force_N", "N", 50, 90),
        ("max_uplift_at_support_mm", "mm", 48, 55),
        ("contact_loss_pct", "%", 0, 0),
    ]
    return with_identity(
        {
            "id": "en50318-2002/250",
            "title": "EN 50318:2002 reference model, 250 km/h",
            "verdict": "pass",
            "reason": None,
            "notes": [
                "The steady arm carries its share of the contact wire, so that the wire is level at the support."
            ],
            "warnings": ["The contact force is sampled at 1000 Hz; contact losses shorter than 1 ms are not seen."],
            "inputs": [
                {"group": "contact_wire", "trust": "secondary", "source": SOURCE},
                {"group": "evaluated_spans", "trust": "provisional", "source": "not traced to a printed source"},
                {"group": "pantograph", "trust": "primary", "source": "manufacturer's data sheet"},
            ],
            "input_digest": "sha256:9f86d081884c7d659a2feaa0c55ad015a3bf4f1b2b0b822cd15d6c15b0f00a08",
            "criteria": [criterion(q1, 1, *limit) for limit in limits] + [criterion(q2, 2, *limit) for limit in limits],
            "quantities": {"0": {"wave_speed_m_s": 121.7}, "1": q1, "2": q2},
            **uncertainty({"1": q1, "2": q2}),
            "skipped": {},
            "record": VERIFIED,
            "run": run_facts(250),
            "traces": {"1": trace(*front), "2": trace(*rear)},
            "uplift": [uplift(240.0, 50.1), uplift(300.0, 51.3), uplift(360.0, 48.9)],
            "places": {"1": places(*front) | highest, "2": places(*rear) | highest},
        }
    )


def failing_case() -> dict[str, Any]:
    signal = force(116.0, 1.35, 0.5)
    q = statistics(*signal[1:])
    del q["rms_20_50_N"], q["std_force_50_N"], q["cov_50"]
    provisional = criterion(q, 1, "rms_5_20_N", "N", 20, 22)
    provisional |= {"verdict": "info", "trust": "provisional", "source": "not traced to a printed source"}
    distance = f"{20 - q['rms_5_20_N']:.3g} N below the lower limit"
    provisional["reason"] = f"would fail: {distance}; the limit is provisional and does not count"
    failed = criterion(q, 1, "std_force_N", "N", 32, 34)
    failed["reason"] = f"{32 - q['std_force_N']:.3g} N below the lower limit"
    skipped = criterion(q, 1, "std_force_N", "N", 10, 20) | {"quantity": "rms_20_50_N", "verdict": "skip"}
    skipped |= dict.fromkeys(("value", "margin", "discretisation_error", "uncertainty")) | {"components": {}}
    skipped["reason"] = "the force was low-pass filtered at 20 Hz before delivery, which removed the band 20-50 Hz"
    return with_identity(
        {
            "id": "en50318-2002/300",
            "title": "EN 50318:2002 reference model, 300 km/h",
            "verdict": "fail",
            "reason": None,
            "notes": [],
            "warnings": [],
            "inputs": [{"group": "contact_wire", "trust": "secondary", "source": SOURCE}],
            "input_digest": "sha256:2c26b46b68ffc68ff99b453c1d30413413422d706483bfa0f98a5e886266e7ae",
            "criteria": [
                criterion(q, 1, "mean_force_N", "N", 110, 120),
                failed,
                criterion(q, 1, "max_force_N", "N", None, 225),
                criterion(q, 1, "min_force_N", "N", 30, None),
                provisional,
                skipped,
            ],
            "quantities": {"1": q},
            **uncertainty({"1": q}),
            "skipped": {"1": {"rms_20_50_N": skipped["reason"], "std_force_50_N": skipped["reason"]}},
            "record": VERIFIED,
            "run": run_facts(300),
            "traces": {"1": trace(*signal)},
            "uplift": [],
            "places": {"1": places(*signal)},
        }
    )


def skipped_case() -> dict[str, Any]:
    return with_identity(
        {
            "id": "en50318-2018/ac-simple/320-twin",
            "title": "EN 50318:2018 AC simple, 320 km/h, two pantographs",
            "verdict": "skip",
            "reason": "the static case en50318-2018/ac-simple/static did not pass",
            "notes": [],
            "warnings": [],
            "inputs": [],
            "input_digest": "sha256:fcde2b2edba56bf408601fb721fe9b5c338d10ee429ea04fae5511b68fbf8fb9",
            "criteria": [],
            "quantities": {},
            "skipped": {},
            "run": run_facts(320)
            | dict.fromkeys(("simulated_s", "wall_s", "dt_s", "element_m", "rate_Hz", "evaluated_m")),
            "traces": {},
            "uplift": [],
        }
    )


def example() -> dict[str, Any]:
    results = {
        "schema": "pantocheck.results/1",
        "suite": {"version": "0.1.0", "commit": "4f2c9d1e7a3b", "digest": "sha256:" + 64 * "4"},
        "system": {"name": "Pantocheck reference simulator", "version": "0.1.0", "kind": "builtin"},
        "statement": "self-declared conformance report, in the style of EN 50318",
        "verdict": "fail",
        "trust": "secondary",
        "decision": "simple",
        "started": "2026-11-20T23:50:00Z",
        "platform": {
            "python": "3.11.9",
            "numpy": "2.4.6",
            "scipy": "1.17.1",
            "core": "C (GCC 12.2.0)",
            "machine": "x86_64",
            "system": "Linux",
        },
        "criteria_verdict": "fail",
        "renderer": {
            "typst": "0.15.0",
            "matplotlib": "3.10.8",
            "jinja2": "3.1.6",
            "numpy": "2.4.6",
            "fonts": "sha256:" + 64 * "5",
            "machine": "x86_64",
            "system": "Linux",
        },
        "scope": [],
        "cases": [passing_case(), failing_case(), skipped_case()],
    }
    return Results.model_validate(results).to_dict()


@pytest.fixture
def results() -> dict[str, Any]:
    """One passing, one failing and one skipped case; two pantographs; a provisional limit; a skipped quantity."""
    return example()


@pytest.fixture
def passing() -> dict[str, Any]:
    """The passing case alone."""
    results = example()
    return results | {"verdict": "pass", "criteria_verdict": "pass", "cases": results["cases"][:1]}


def chart(label: str, caption: str) -> dict[str, Any]:
    """Chart of a study whose texts come from a file."""
    series = {"label": label, "style": "line", "x": [0.0, 1.0], "y": [1.0, 2.0]}
    labels = {"caption": caption, "alternative": label, "x_label": label, "y_label": label}
    return Chart.model_validate({**labels, "series": [series]}).model_dump(mode="json")


def with_measured_run() -> dict[str, Any]:
    """The failing case with a measured run beside it: its force, 3 N higher."""
    results = example()
    case = results["cases"][1]
    curves, mean = case["traces"]["1"], case["quantities"]["1"]["mean_force_N"]
    forces = {"simulated": curves["force_20_N"], "measured": [force + 3 for force in curves["force_20_N"]]}
    statistics = {name: dict.fromkeys(("mean_N", "std_N", "max_N", "min_N"), 1.0) for name in forces}
    case["comparison"] = {
        "name": "measured.csv",
        "cutoff_Hz": 20.0,
        "quantities": {"1": {"mean_force_N": mean + 3}},
        "uncertainty": {},
        "pantographs": {
            "1": {
                "position_m": curves["position_m"],
                **{f"{name}_N": values for name, values in forces.items()},
                **{f"{name}_spectrum": curves["spectrum"] for name in forces},
                "spans": [{"start_m": 240.0, "end_m": 300.0, **statistics}],
            }
        },
    }
    return Results.model_validate(results).to_dict()


HOSTILE = [
    "<script>alert(1)</script>",
    '#import "x.typ": * "]) #panic()',
    "${{7*7}} {{ 7*7 }} {% raw %}",
    "a|b `c` *d* [e](f) \\ _g_",
    "x" * 300,
    "naïve Ω 東京 🚄 \u202egnp.exe \x00\x1b[31m \ud800 \ufffe \ue000",
    "]]> &amp; <!-- -->",
    "line one\nline two\r\n\tindented",
]


def with_hostile_text() -> dict[str, Any]:
    """Example whose free texts contain markup, code and control characters."""
    results = example()
    results["system"] |= {"name": HOSTILE[0], "version": HOSTILE[1]}
    keys = ("report_number", "issuer", "organisation", "contact", "assessor", "remarks")
    results["administration"] = dict(zip(keys, (*HOSTILE[:4], HOSTILE[6]), strict=False))
    for number, case in enumerate(results["cases"]):
        case["id"] += HOSTILE[number + 2]
        case["title"] = HOSTILE[number]
        case["notes"] = list(HOSTILE)
        case["warnings"] = list(HOSTILE)
        for row in case["criteria"][-1:]:
            row["quantity"] = "a|b<i>"
        case["inputs"] = [
            {"group": text, "trust": "secondary", "source": text, "values": {text: text}} for text in HOSTILE
        ]
        case["charts"] = [chart(*HOSTILE[:2])]
        for i, row in enumerate(case["criteria"]):
            row["source"] = HOSTILE[i % len(HOSTILE)]
            row["reason"] = HOSTILE[(i + 1) % len(HOSTILE)]
    return results


@pytest.fixture
def hostile() -> dict[str, Any]:
    return with_hostile_text()


@pytest.fixture(scope="session")
def page_text() -> str:
    """The example as HTML."""
    return render_html(build_certificate(Results.model_validate(example())))


@pytest.fixture(scope="session")
def hostile_text() -> str:
    """The example with hostile text as HTML."""
    return render_html(build_certificate(Results.model_validate(with_hostile_text())))


@pytest.fixture(scope="session")
def certificate() -> bytes:
    """The example as PDF."""
    return render_pdf(build_certificate(Results.model_validate(example())))


def with_reference() -> dict[str, Any]:
    """Example whose first case has a reference with 2 N more everywhere."""
    results = example()
    case = results["cases"][0]
    forces = {owner: [force + 2 for force in curves["force_20_N"]] for owner, curves in case["traces"].items()}
    case["reference"] = {
        "name": "Reference", "version": "3", "reason": None, "quantities": case["quantities"], "uncertainty": {},
        "force_20_N": forces,
    }  # fmt: skip
    return Results.model_validate(results).to_dict()
