"""Facts for reproducing a run: suite, system, platform, filter, time step, digests."""

from typing import Any

from pantocheck.conformance.reports.document import Facts
from pantocheck.conformance.reports.page_text import format_plain, format_value


def list_suite_facts(results: dict[str, Any]) -> Facts:
    """Suite, system, platform and start of a run."""
    platform = results.get("platform") or {}
    versions = [f"{name} {version}" for name, version in platform.items() if name not in ("machine", "system")]
    computer = " ".join(str(platform[key]) for key in ("system", "machine") if platform.get(key))
    return Facts(
        _drop_empty(
            ("Suite", name_suite(results)),
            ("Commit of the suite", results["suite"].get("commit") or "not known"),
            ("System under test", name_system(results)),
            ("Platform", ", ".join(filter(None, [computer, *versions]))),
            ("Format of the results", results.get("schema")),
        ),
        times=_drop_empty(("Started", results.get("started"))),
    )


def name_suite(results: dict[str, Any]) -> str:
    """Name and version of the suite."""
    return f"Pantocheck {results['suite'].get('version') or ''}".rstrip()


def name_system(results: dict[str, Any]) -> str:
    """Name, version and kind of the system under test."""
    system = results["system"]
    text = " ".join(str(system[key]) for key in ("name", "version") if system.get(key))
    return f"{text} ({system['kind']})" if system.get("kind") else text


def list_case_facts(case: dict[str, Any]) -> Facts:
    """Facts of one run; facts that this page does not know are listed under their keys."""
    run = dict(case.get("run") or {})
    simulated, wall = run.pop("simulated_s", None), run.pop("wall_s", None)
    section, rate = run.pop("evaluated_m", None), run.pop("rate_Hz", None)
    known = _drop_empty(
        ("Speed", _with_unit(run.pop("speed_km_h", None), "km/h")),
        ("Analysis section", f"{format_plain(section[0])} m to {format_plain(section[1])} m" if section else None),
        ("Filter", describe_filter(run.pop("filter", None))),
        ("Sampling rate of the record", _with_unit(rate, "samples per second")),
        ("Time step", _with_unit(run.pop("dt_s", None), "s")),
        ("Element length", _with_unit(run.pop("element_m", None), "m")),
        ("Simulated time", _with_unit(simulated, "s")),
        ("Digest of the inputs", case.get("input_digest")),
    )
    times = _drop_empty(
        ("Wall time", None if wall is None else f"{format_value(wall, 3)} s"),
        ("Wall time / simulated time", format_value(wall / simulated, 3) if wall is not None and simulated else None),
    )
    others = tuple((key, _format_any(value)) for key, value in sorted(run.items()) if value is not None)
    return Facts((*known, *others), times)


def describe_filter(settings: dict[str, Any] | None) -> str | None:
    """Settings of a filter on one line."""
    if not settings:
        return None
    order, cutoff, phase = settings.get("order"), settings.get("cutoff_Hz"), settings.get("phase")
    parts = [str(settings.get("kind", "filter")).capitalize()]
    parts += [f"order {order}"] if order is not None else []
    parts += [f"−3 dB at {format_plain(cutoff)} Hz"] if cutoff is not None else []
    parts += [f"{phase} phase" if phase == "zero" else str(phase)] if phase is not None else []
    return ", ".join(parts)


def _with_unit(value: float | None, unit: str) -> str | None:
    return None if value is None else f"{format_plain(value)} {unit}"


def _format_any(value: Any) -> str:
    return format_plain(value) if isinstance(value, int | float) and not isinstance(value, bool) else str(value)


def _drop_empty(*pairs: tuple[str, str | None]) -> tuple[tuple[str, str], ...]:
    return tuple((name, text) for name, text in pairs if text)
