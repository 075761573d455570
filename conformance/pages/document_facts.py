"""Identity of a report on its page 1: administrative data, date, digest, means of checking and signature."""

from pantocheck.conformance.core.reproducibility import format_date
from pantocheck.conformance.pages.document import Facts
from pantocheck.conformance.pages.page_code import describe_verifier
from pantocheck.conformance.pages.scope_page import list_sources
from pantocheck.conformance.pages.words import format_plain, format_value
from pantocheck.conformance.results.administration import Administration
from pantocheck.conformance.results.results_format import CaseResult, Results, RunFacts

ADMINISTRATION = {
    "report_number": "Report number",
    "issuer": "Issuer",
    "organisation": "Organisation",
    "contact": "Contact",
    "assessor": "Assessor",
    "remarks": "Remarks",
}
"""Labels of the administrative data in the order of the page."""

NO_ISSUER = "not stated"
SIGNATURE = "added after writing, if any; pantocheck verify shows its state"
COMMAND = "pantocheck verify FILE, with the name of this file"


def list_issuer_facts(results: Results, date: int) -> tuple[tuple[str, str], ...]:
    """Administrative data, date [s since 1970, 0: not known], sources from outside and signature of a report."""
    return _drop_empty(
        *list_administration(results.administration),
        ("Date", format_date(date)),
        *list_sources(results),
        ("Signature", SIGNATURE),
    )


def list_check_facts(results: Results, digest: str) -> tuple[tuple[str, str], ...]:
    """Means of checking a report, and the digest of its results with the administrative data, without the page."""
    return (
        ("Verifier", describe_verifier(results.suite)),
        ("Command", COMMAND),
        ("Digest of the results", digest),
    )


def list_administration(administration: Administration | None) -> tuple[tuple[str, str], ...]:
    """Labels and texts of the administrative data; without an issuer, that it is not stated."""
    stated = {key: text for key, text in (administration or ()) if text is not None}
    known = {"issuer": NO_ISSUER, **stated}
    return tuple((label, known[key]) for key, label in ADMINISTRATION.items() if key in known)


# Facts for reproducing a run: suite, system, platform, filter, time step, digests.
def list_suite_facts(results: Results) -> Facts:
    """Suite, system, platform and start of a run."""
    platform = results.platform
    versions = [f"{name} {version}" for name, version in platform if name not in ("machine", "system")]
    computer = f"{platform.system} {platform.machine}"
    return Facts(
        _drop_empty(
            ("Suite", name_suite(results)),
            ("Digest of the suite", results.suite.digest),
            ("Commit of the suite", results.suite.commit or "not known"),
            ("System under test", name_system(results)),
            ("Platform", ", ".join([computer, *versions])),
            ("Format of the results", results.schema_),
        ),
        times=_drop_empty(("Started", results.started)),
    )


def name_suite(results: Results) -> str:
    """Name and version of the suite."""
    return f"Pantocheck {results.suite.version}"


def name_system(results: Results) -> str:
    """Name, version and kind of the system under test."""
    system = results.system
    return f"{' '.join(filter(None, (system.name, system.version)))} ({system.kind})"


def list_case_facts(case: CaseResult) -> Facts:
    """Facts of one run; unknown facts are left out."""
    run = case.run
    record, changed = case.record, case.limits_digest != case.stated_limits_digest
    simulated, wall, section = run.simulated_s, run.wall_s, run.evaluated_m
    return Facts(
        _drop_empty(
            ("Speed", _with_unit(run.speed_km_h, "km/h")),
            *((f"Force law of pantograph {number}", force.text) for number, force in run.law_forces.items()),
            ("Analysis section", f"{format_plain(section[0])} m to {format_plain(section[1])} m" if section else None),
            ("Filter", _describe_filter(run)),
            ("Sampling rate of the record", _with_unit(run.rate_Hz, "samples per second")),
            ("Time step", _with_unit(run.dt_s, "s")),
            ("Element length", _with_unit(run.element_m, "m")),
            ("Simulated time", _with_unit(simulated, "s")),
            ("Edition", case.edition),
            ("Superseded by", case.superseded_by),
            ("Digest of the inputs", case.input_digest),
            ("Digest of the limits", case.limits_digest),
            ("Digest without the limits file", case.stated_limits_digest if changed else None),
            ("Digest of the record", None if record is None else record.digest),
            ("Digest of the measured record", None if record is None else record.measured_digest),
        ),
        times=_drop_empty(
            ("Wall time", None if wall is None else f"{format_value(wall, 3)} s"),
            ("Wall time / simulated time", format_value(wall / simulated, 3) if wall and simulated else None),
        ),
    )


def _describe_filter(run: RunFacts) -> str:
    settings = run.filter
    kind, cutoff = settings.kind.capitalize(), format_plain(settings.cutoff_Hz)
    bands = "" if settings.bands == "spectral lines" else f"; bands by {settings.bands}"
    edge = f"−{settings.attenuation_dB} dB at {cutoff} Hz"
    return f"{kind}, order {settings.order}, {edge}, {settings.phase} phase{bands}"


def _with_unit(value: float | None, unit: str) -> str | None:
    return None if value is None else f"{format_plain(value)} {unit}"


def _drop_empty(*pairs: tuple[str, str | None]) -> tuple[tuple[str, str], ...]:
    return tuple((name, text) for name, text in pairs if text)
