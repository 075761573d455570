"""Reproducibility facts: with what, where and how the numbers were made."""

from typing import Any

from pantocheck.conformance.reports.page_text import format_plain, format_value

Facts = tuple[tuple[str, str], ...]


def list_suite_facts(results: dict[str, Any]) -> Facts:
    """Suite, system, platform and start of a run."""
    platform = results.get("platform") or {}
    versions = [f"{name} {version}" for name, version in platform.items() if name not in ("machine", "system")]
    computer = " ".join(str(platform[key]) for key in ("system", "machine") if platform.get(key))
    return _given(
        ("Suite", name_suite(results)),
        ("Commit of the suite", results["suite"].get("commit") or "not known"),
        ("System under test", name_system(results)),
        ("Platform", ", ".join(filter(None, [computer, *versions]))),
        ("Started", results.get("started")),
        ("Format of the results", results.get("schema")),
    )


def name_suite(results: dict[str, Any]) -> str:
    """Name and version of the suite."""
    return f"Pantocheck {results['suite'].get('version') or ''}".rstrip()


def name_system(results: dict[str, Any]) -> str:
    """Name, version and kind of the system under test."""
    of = results["system"]
    text = " ".join(str(of[key]) for key in ("name", "version") if of.get(key))
    return f"{text} ({of['kind']})" if of.get("kind") else text


def list_case_facts(case: dict[str, Any]) -> Facts:
    """How a case was run; what the run adds beyond the known keys is listed under its own name."""
    run = dict(case.get("run") or {})
    simulated, wall = run.pop("simulated_s", None), run.pop("wall_s", None)
    stretch, rate = run.pop("evaluated_m", None), run.pop("rate_Hz", None)
    known = _given(
        ("Speed", _with(run.pop("speed_km_h", None), "km/h")),
        ("Evaluated stretch", f"{format_plain(stretch[0])} m to {format_plain(stretch[1])} m" if stretch else None),
        ("Filter", describe_filter(run.pop("filter", None))),
        ("Rate of the record", _with(rate, "samples per second")),
        ("Time step", _with(run.pop("dt_s", None), "s")),
        ("Element length", _with(run.pop("element_m", None), "m")),
        ("Simulated time", _with(simulated, "s")),
        ("Wall time", None if wall is None else f"{format_value(wall, 3)} s"),
        ("Wall time / simulated time", format_value(wall / simulated, 3) if wall is not None and simulated else None),
        ("Digest of the inputs", case.get("input_digest")),
    )
    return (*known, *((key, _any(value)) for key, value in sorted(run.items()) if value is not None))


def describe_filter(settings: dict[str, Any] | None) -> str | None:
    """A filter's settings on one line."""
    if not settings:
        return None
    order, cutoff, phase = settings.get("order"), settings.get("cutoff_Hz"), settings.get("phase")
    parts = [str(settings.get("kind", "filter")).capitalize()]
    parts += [f"order {order}"] if order is not None else []
    parts += [f"−3 dB at {format_plain(cutoff)} Hz"] if cutoff is not None else []
    parts += [f"{phase} phase" if phase == "zero" else str(phase)] if phase is not None else []
    return ", ".join(parts)


def _with(value: float | None, unit: str) -> str | None:
    return None if value is None else f"{format_plain(value)} {unit}"


def _any(value: Any) -> str:
    return format_plain(value) if isinstance(value, int | float) and not isinstance(value, bool) else str(value)


def _given(*facts: tuple[str, str | None]) -> Facts:
    return tuple((name, text) for name, text in facts if text)
