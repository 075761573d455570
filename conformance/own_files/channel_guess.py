"""Probable meaning of the channels of a logger file, by unit and name; a guess for a sidecar that is to be checked."""

import re
from collections.abc import Sequence

from pantocheck.conformance.input_files.units import find_key_units
from pantocheck.conformance.own_files.channel_facts import ChannelFacts, strip_group
from pantocheck.conformance.records.logger.column_values import find_factor
from pantocheck.conformance.records.record_channels import CHANNELS

_WORDS = {
    "force": r"force|kraft|effort|fuerza|forza|^f_?\d|^fc",
    "position": r"position|chainage|kilomet|^km|strecke|ort\b|^x\b|^pk|abszisse|\bweg\b",
    "speed": r"speed|geschw|vitesse|veloc|^v\b",
    "contact_height": r"height|h(ö|oe)he|hauteur|altezza|altura",
    "uplift": r"uplift|anhub|soul(è|e)vement",
}
_ACCELERATION = re.compile(r"accel|beschl|^acc|^a_?\d|^s\d+_[xyz]", re.IGNORECASE)


def guess_channels(facts: Sequence[ChannelFacts]) -> dict[str, list[ChannelFacts]]:
    """Columns that probably hold each channel of a force record, in the order of the file.

    A column counts for a channel if its name has a word of the channel, and its unit, if stated, is of this quantity.
    """
    found: dict[str, list[ChannelFacts]] = {}
    for fact in facts:
        name = strip_group(fact.column)
        for channel, words in _WORDS.items():
            if fact.missing == 1 or not re.search(words, name, re.IGNORECASE):
                continue
            units = find_key_units(CHANNELS[channel].unit)
            if fact.unit is None or find_factor(fact.unit, units) is not None:
                found.setdefault(channel, []).append(fact)
                break
    return found


def list_force_signals(facts: Sequence[ChannelFacts]) -> list[ChannelFacts]:
    """Columns with the name of a force and the unit of another quantity, such as the volts of a force sensor."""
    units = find_key_units("N")
    return [
        fact
        for fact in facts
        if fact.missing < 1
        and fact.unit is not None
        and re.search(_WORDS["force"], strip_group(fact.column), re.IGNORECASE)
        and find_factor(fact.unit, units) is None
    ]


def is_acceleration(fact: ChannelFacts) -> bool:
    """Whether a column probably holds the acceleration of a mass drop."""
    if fact.unit is not None:
        return find_factor(fact.unit, find_key_units("m_s2")) is not None
    return _ACCELERATION.search(strip_group(fact.column)) is not None
