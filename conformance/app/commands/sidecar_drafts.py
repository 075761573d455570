"""Commented sidecars of logger files, to be completed."""

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from pantocheck.conformance.core.text_settings import TextSettings
from pantocheck.conformance.core.texts import DocumentationPage
from pantocheck.conformance.records.channel_facts import (
    ChannelFacts,
    TimeFacts,
    guess_channels,
    is_acceleration,
    is_drop_channel,
    list_force_signals,
)
from pantocheck.conformance.records.record import CHANNELS, find_column
from pantocheck.conformance.records.source_tables import SOURCE_CHANNELS

TO_DO = "COMPLETE:"
"""Mark of the lines that the user completes."""


@dataclass(frozen=True)
class DescribedTable:
    """Columns of a file that are sampled together."""

    file: str
    """Name of the file."""
    samples: int
    facts: list[ChannelFacts]
    time: TimeFacts | None
    runs: int = 1
    """Number of the runs in the file."""

    @property
    def moves(self) -> bool:
        """Whether it probably holds the accelerations of a mass drop."""
        return "force" not in guess_channels(self.facts) and any(map(is_acceleration, self.facts))


def draft_record_sidecar(parts: Sequence[DescribedTable], layout: TextSettings) -> str:
    """Sidecar of a contact-force record: the table with the force, and further sources; with a stated layout."""
    file, facts, time = parts[0].file, parts[0].facts, parts[0].time
    own = len(parts) == 1 and all(find_column(fact.column.name or "", fact.column.row) for fact in facts)
    guesses = guess_channels(facts)
    forces = sum(len(guess_channels(part.facts).get("force", [])) for part in parts) or 1
    lines = [
        f"# Sidecar of {file}. Complete the lines with {TO_DO.rstrip(':')}, and check the others.",
        f"# See {DocumentationPage.RECORDS}, and {DocumentationPage.LOGGER_FILES}.",
        'schema = "pantocheck.record/1"',
        f"file = {json.dumps(file, ensure_ascii=False)}",
        f"# speed_km_h = 250.0              # {TO_DO} nominal speed of the train",
        f"pantographs = {forces:<19} # check: pantographs with a contact force",
        f'# filter_applied_Hz = "none"      # {TO_DO} cut-off of a low-pass filter before recording, or "none"',
        *_list_section_lines("evaluated", f"{TO_DO} start and end of the analysis section", guesses),
    ]
    if forces > 1:
        spacing = ", ".join(["200.0"] * (forces - 1))
        lines.append(f"# spacing_m = [{spacing}]".ljust(34) + f"# {TO_DO} distances between successive pantographs")
    mark = f"{TO_DO} " if any("uplift" in guess_channels(part.facts) for part in parts) else ""
    lines += _list_section_lines("support", f"{mark}the supports with an uplift", guesses)
    lines += _list_layout(layout)
    lines += ["", "[line]", "# span_m = 65.0                   # longest span, needed for the uplift"]
    lines += ["# wave_speed_m_s = 120.0          # sqrt(tension / mass per length) of the contact wire"]
    lines += ["# uplift_space_mm = 120.0         # space for the uplift at the supports"]
    lines += ["", "[system]", 'name = "measurement"              # name of the measuring system']
    if not own:
        lines += _list_column_lines(facts, guesses, time)
    everywhere = {name: found for part in reversed(parts) for name, found in guess_channels(part.facts).items()}
    lines += _list_position_help(everywhere)
    counts = {channel: len(guesses.get(channel, [])) for channel in ("uplift", "force")}
    for part in parts[1:]:
        lines += _list_source_lines(part, parts[0], counts, layout)
        own_guesses = guess_channels(part.facts)
        counts = {channel: count + len(own_guesses.get(channel, [])) for channel, count in counts.items()}
    return "\n".join(lines) + "\n"


def _list_section_lines(key: str, text: str, guesses: dict[str, list[ChannelFacts]]) -> Iterator[str]:
    """Commented line of the analysis section or the supports, in the kilometres of the file if it has them."""
    fact = _find_kilometres(guesses)
    if fact is not None:
        ends = sorted((fact.smallest, fact.largest), reverse=fact.trend < 0)
        values = ", ".join(f"{end:.3f}" for end in ends) if key == "evaluated" else ""
        yield f"# {key}_km = [{values}]".ljust(34) + f"# {text}, kilometres of the line"
    else:
        name, values = ("evaluated_m", "0.0, 1000.0") if key == "evaluated" else ("support_position_m", "")
        yield f"# {name} = [{values}]".ljust(34) + f"# {text}, x in running direction"


def _find_kilometres(guesses: dict[str, list[ChannelFacts]]) -> ChannelFacts | None:
    """Channel with the kilometres of the line."""
    return next((fact for fact in guesses.get("position", []) if _is_kilometre(fact)), None)


def _is_kilometre(fact: ChannelFacts) -> bool:
    """Whether a column is in kilometres by its unit, or by its name if the file states no unit."""
    return "km" in (fact.unit, (fact.column.name or "").strip().casefold() if fact.unit is None else None)


def _list_source_lines(
    part: DescribedTable, first: DescribedTable, counts: dict[str, int], layout: TextSettings
) -> list[str]:
    """Lines of a table `source`; `counts` are the numbers of uplifts and forces of the files before it."""
    known = guess_channels(first.facts).keys() & {"position", "speed"}
    channels = set(SOURCE_CHANNELS) - known
    guesses = {name: found for name, found in guess_channels(part.facts).items() if name in channels}
    times = [one.time for one in (first, part) if one.time is not None]
    seconds = max((time.duration for time in times), default=1.0)
    # Both files begin at about the same time, as far as is known.
    offset = f"{times[0].start - times[-1].start:.3f}"
    ways = {
        "uplift": f'{{ kind = "passage", offset_s = {offset}, within_s = {seconds:.1f} }}',
        "the same clock, or a known difference": '{ kind = "time", offset_s = 0.0, uncertainty_s = 0.01 }',
        "a pulse per second": f'{{ kind = "pps", column = "PPS", record_column = "PPS", offset_s = {offset} }}',
    }
    return [
        "",
        "[[source]]                         # offset_s: time of the record less time of the source",
        f"file = {json.dumps(part.file, ensure_ascii=False)}",
        *(
            f"# join = {text}   # {TO_DO if n == 0 else 'or'} joined by {way}"
            f"{', within_s below the time between two supports' if way == 'uplift' else ''}"
            for n, (way, text) in enumerate(ways.items())
            if way != "uplift" or "uplift" in guesses
        ),
        *(line.replace("[table]", "[source.table]") for line in _list_layout(layout)),
        *(
            line.replace("[columns]", "[source.columns]")
            for line in _list_column_lines(part.facts, guesses, part.time, counts=counts, needed=False)
        ),
    ]


def _list_layout(layout: TextSettings) -> list[str]:
    stated = layout.model_dump(exclude_none=True)
    return ["", "[table]", *(f"{key} = {json.dumps(value)}" for key, value in stated.items())] if stated else []


def _list_column_lines(
    facts: Sequence[ChannelFacts],
    guesses: dict[str, list[ChannelFacts]],
    time: TimeFacts | None,
    *,
    counts: dict[str, int] | None = None,
    needed: bool = True,
) -> Iterator[str]:
    """Lines of the table `columns`: guesses by unit and name, and the other columns as comments."""
    used = set[int]()
    yield from ("", "[columns]                          # guessed from names and units: check each line")
    if time is not None and time.column is not None:
        fact = next(fact for fact in facts if fact.column is time.column)
        used.add(id(fact))
        yield _column_line("time_s", fact, "s" if fact.unit is None else None)
    elif time is None:
        yield f'# time_s = {{ column = "...", unit = "s" }}   # {TO_DO} column of the time'
    for channel, found in guesses.items():
        several = CHANNELS[channel].per == "support"
        for number, fact in enumerate(found, 1 + (counts or {}).get(channel, 0)):
            used.add(id(fact))
            name = CHANNELS[channel].column(number)
            remark = f"   # {TO_DO} with the supports above" if several else ""
            unit = "km" if channel == "position" and _is_kilometre(fact) else None
            yield f"{'# ' if several else ''}{_column_line(name, fact, unit)}{remark}"
    if len(guesses.get("force", [])) > 1:
        yield "# forces of one pantograph (left and right): one [columns.force_1_N] with sum = [...], see"
        yield f"# {DocumentationPage.LOGGER_FILES}"
    signals = list_force_signals(facts) if needed else []
    used |= {id(fact) for fact in signals}
    for number, fact in enumerate(signals, 1):
        column = json.dumps(fact.column.label, ensure_ascii=False)
        yield f'# force_{number}_N = {{ column = {column}, unit = "N", scale = 1.0 }}   # {TO_DO} N per {fact.unit}'
    if len(signals) > 1:
        yield "# or the sum of several sensors of one pantograph: [columns.force_1_N] with sum"
        yield f"# in {DocumentationPage.LOGGER_FILES}"
    if needed and "force" not in guesses and not signals:
        yield f'# force_1_N = {{ column = "...", unit = "N" }}   # {TO_DO} column of the contact force'
    unused = [fact.column.label for fact in facts if id(fact) not in used and fact.column.label]
    if unused:
        yield f"# not used: {', '.join(json.dumps(name, ensure_ascii=False) for name in unused)}"


def _column_line(name: str, fact: ChannelFacts, unit: str | None) -> str:
    stated = fact.unit if fact.unit is not None else unit
    column = json.dumps(fact.column.label, ensure_ascii=False)
    known = f", unit = {json.dumps(stated, ensure_ascii=False)}" if stated is not None else ""
    remark = "" if stated is not None else f"   # {TO_DO} unit"
    return f"{name} = {{ column = {column}{known} }}{remark}"


def _list_position_help(guesses: dict[str, list[ChannelFacts]]) -> Iterator[str]:
    """Commented tables for the position."""
    kilometres = _find_kilometres(guesses)
    if kilometres is not None:
        known = kilometres.trend != 0
        mark, remark = ("", "check") if known else ("# ", TO_DO)
        zero, direction = (
            (kilometres.smallest, "increasing") if kilometres.trend >= 0 else (kilometres.largest, "decreasing")
        )
        yield from (
            "",
            f"{mark}[track]".ljust(34) + f"# {remark} the position is a kilometre of the line",
            f"{mark}zero_km = {zero:.3f}".ljust(34) + "# x = 0, any kilometre",
            f'{mark}kilometres = "{direction}"'.ljust(34) + "# in running direction, as in the file",
        )
    elif "position" not in guesses:
        yield from (
            "",
            "# position: a column position_1_m above; or speed_m_s above and start_m = 0.0 at the top; or",
            "# [position]",
            '# kind = "counter"               # or "pulses", "marks"',
            '# column = "..."',
            "# metres_per_pulse = 0.25",
            "# start_m = 0.0",
        )


def draft_drop_sidecar(part: DescribedTable, layout: TextSettings) -> str:
    """Sidecar of a mass-drop record."""
    file, facts, time = part.file, part.facts, part.time
    others = [fact for fact in facts if time is None or fact.column is not time.column]
    channels = [(number, fact) for number, fact in enumerate(others, 1) if fact.missing < 1 and is_drop_channel(fact)]
    unused = [fact.column.label for fact in others if all(fact is not used for _, used in channels)]
    rate = "200.0" if time is None else f"{time.rate:.6g}"
    rate = rate if "." in rate or "e" in rate else f"{rate}.0"
    lines = [
        f"# Sidecar of {file}. Complete the lines with {TO_DO.rstrip(':')}, and check the others.",
        f"# See {DocumentationPage.IDENTIFICATION}.",
        "[test]",
        'name = ""',
        "# spans_m = [63.0, 63.0]          # lengths of the spans",
        "# cw_tension_n = 20000.0          # tension of one contact wire",
        "# mw_tension_n = 15000.0",
        "",
        "[drop]",
        "# mass_kg = 40.0",
        '# wire = "CW"                     # CW contact wire, MW messenger wire',
        "# position_m = 0.0                # from the first support",
        "",
        "[record]",
        f"sampling_rate_hz = {rate:<16}# {'COMPLETE' if time is None else 'found in the file'}",
        "# trigger_nominal_s = 5.0         # planned time of the release",
        *_list_layout(layout),
    ]
    if unused:
        lines += ["", f"# not used: {', '.join(json.dumps(name, ensure_ascii=False) for name in unused)}"]
    for number, fact in channels:
        name = fact.column.name or f"channel {number}"
        unit = json.dumps(fact.unit or "m/s2", ensure_ascii=False)
        lines += [
            "",
            "[[channel]]",
            f"column = {number}",
            f"name = {json.dumps(name, ensure_ascii=False)}",
            f"sensor = {number:<26}# {TO_DO} one number per sensor",
            f'direction = "+z"                  # {TO_DO} x along the track, y lateral, z upward',
            f"unit = {unit:<28}# {'found in the file' if fact.unit else f'{TO_DO} unit'}",
            '# wire = "CW"',
            "# position_m = 0.0                # from the first support",
        ]
    return "\n".join(lines) + "\n"
