"""Manipulations that change the samples of a channel or their rate."""

import random

import numpy as np
from scipy.signal import butter, sosfiltfilt

from verification.attacks.manipulation_dossier import STEMS, Dossier, channel_kind


def rescale(dossier: Dossier, chance: random.Random) -> str | None:
    """Multiply all columns of a kind of channel, or one of them."""
    stem = chance.choice((*STEMS, "time"))
    names = dossier.names(stem)
    if not names:
        return None
    names = chance.choice((names, [chance.choice(names)]))
    factor = chance.choice((-1.0, 1e-3, 0.1, 0.5, 0.9, 1.1, 2.0, 10.0, 1e3))
    dossier.columns |= {name: factor * dossier.columns[name] for name in names}
    return f"multiply {stem}{'' if len(names) > 1 else ' of one'} by {factor:g}"


def smooth(dossier: Dossier, chance: random.Random) -> str | None:
    """Filter a channel, stated or not."""
    stem, cutoff = chance.choice(("force", "contact_height", "uplift")), chance.choice((2.0, 5.0, 10.0, 15.0, 20.0))
    names = dossier.names(stem)
    if not names or len(dossier.columns[names[0]]) < 100:
        return None
    sections = butter(3, cutoff, fs=1000.0, output="sos")
    dossier.columns |= {name: sosfiltfilt(sections, dossier.columns[name]) for name in names}
    stated = chance.random() < 0.5
    if stated:
        dossier.sidecar["filter_applied_Hz"] = chance.choice((cutoff, 20.0))
    return f"filter {stem} at {cutoff:g} Hz{', stated' if stated else ''}"


def hold(dossier: Dossier, chance: random.Random) -> str | None:
    """Replace a column by zero or by its first value, as from a dead sensor."""
    if (name := dossier.choose(chance, "force", "contact_height", "uplift")) is None:
        return None
    value = chance.choice((0.0, float(dossier.columns[name][0])))
    dossier.columns[name] = np.full(len(dossier.columns[name]), value)
    return f"hold {channel_kind(name)}"


def change_rate(dossier: Dossier, chance: random.Random) -> str | None:
    """Keep every nth sample, or call the rate another one."""
    if "time_s" not in dossier.columns:
        return None
    if chance.random() < 0.5:
        n = chance.choice((2, 4, 5, 10, 20, 50))
        dossier.columns = {name: column[::n] for name, column in dossier.columns.items()}
        return f"keep every sample of {n}"
    factor = chance.choice((0.5, 0.9, 0.996, 1.004, 1.1, 2.0))
    dossier.columns["time_s"] = factor * dossier.columns["time_s"]
    return f"time axis {factor:g} times as long"
