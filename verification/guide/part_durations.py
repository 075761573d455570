"""Durations of the parts of the guide, which weight its progress: one process on one core, once measured."""

from collections.abc import Iterable

DURATIONS_S = {
    "self-test/all": 240.0,
    "verification/waves": 10.0,
    "verification/long-string": 25.0,
    "library/en50318-2018/ac-simple/275": 35.0,
    "library/en50318-2018/ac-simple/275-twin": 35.0,
    "library/en50318-2018/ac-simple/320": 35.0,
    "library/en50318-2018/ac-simple/320-twin": 35.0,
    "library/en50318-2018/ac-stitched/275": 123.0,
    "library/en50318-2018/ac-stitched/320": 74.0,
    "library/force-law/300": 37.0,
    "library/vovan2015/contact-force": 63.0,
    "library/vovan2015/dropper-damping": 30.0,
    "library/vovan2015/mass-drop/printed": 24.0,
    "library/vovan2015/mass-drop/stand-in": 99.0,
    "library/vovan2015/release-velocity": 21.0,
    "library/vovan2015/steady-arm-damper": 66.0,
    "performance/all": 41.0,
}
"""Durations of the long parts [s]."""

SHORT_DURATION_S = 2.0
"""Duration of every other part [s]."""


def sum_durations(parts: Iterable[str]) -> float:
    """Estimated duration of parts [s].

    Args:
        parts: Names of the parts.
    """
    return sum(DURATIONS_S.get(part, SHORT_DURATION_S) for part in parts)
