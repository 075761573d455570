"""Synthetic mass-drop records with known poles, computed with numpy alone."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class SyntheticDrop:
    """Record with its exact poles."""

    samples: NDArray[np.float64]
    """Accelerations, (n, c) [m/s2], at rest before the release."""
    rate: float
    """Sampling rate [Hz]."""
    release: float
    """Time of the release [s]."""
    poles: NDArray[np.complex128]
    """Poles, (m,) [1/s]."""

    @property
    def frequency(self) -> NDArray[np.float64]:
        """Undamped natural frequencies, (m,) [Hz]."""
        return np.abs(self.poles) / (2 * np.pi)

    @property
    def damping_ratio(self) -> NDArray[np.float64]:
        """Shares of critical damping, (m,) [-]."""
        return -self.poles.real / np.abs(self.poles)


def span_modes(
    rng: np.random.Generator, modes: int, spans: int = 6, pairs: int = 0, pair_damping: float = 0.001
) -> NDArray[np.complex128]:
    """Poles in groups of one mode per span, some of them split into pairs 3 to 10 mHz apart."""
    first = rng.uniform(0.8, 1.1)
    spread = rng.uniform(0.15, 0.25)
    frequency: list[float] = []
    damping: list[float] = []
    group = 1
    mass, stiffness = rng.uniform(0.03, 0.08), rng.uniform(3e-5, 1e-4)
    while len(frequency) < modes:
        members = first * group * (1 + 0.004 * group) * (1 + spread * np.linspace(0, 1, spans) ** rng.uniform(0.8, 1.3))
        members *= 1 + rng.uniform(-0.008, 0.008, spans)
        frequency += list(members)
        damping += list(mass / (4 * np.pi * members) + stiffness * np.pi * members + rng.uniform(-1e-4, 1e-4, spans))
        group += 1
    f, z = np.array(frequency[:modes]), np.maximum(np.array(damping[:modes]), 5e-4)
    for j in rng.choice(modes, pairs, replace=False):
        f = np.append(f, f[j] + rng.uniform(0.003, 0.010))
        z[j] = pair_damping * rng.uniform(0.8, 1.2)
        z = np.append(z, pair_damping * rng.uniform(0.8, 1.2))
    order = np.argsort(f)
    f, z = f[order], z[order]
    return -2 * np.pi * f * z + 2j * np.pi * f * np.sqrt(1 - z**2)


def drop(
    rng: np.random.Generator,
    poles: NDArray[np.complex128],
    sensors: int = 4,
    duration: float = 130.0,
    rate: float = 200.0,
    noise: float = 0.003,
    nonlinear: float = 0.6,
    weak: float = 0.15,
) -> SyntheticDrop:
    """Record of a rest, a release after about 5 s, and a decay with noise.

    The residues differ while droppers are slack. A share `weak` of the modes is weakly excited.
    """
    m = poles.size
    strength = 10 ** rng.uniform(-1.3, 0.2, m)
    strength[rng.random(m) < weak] *= 0.01
    residues = strength[:, None] * rng.standard_normal((m, sensors)) * 0.5
    residues = residues * np.exp(
        1j * (rng.uniform(0, 2 * np.pi, m)[:, None] + 0.02 * rng.standard_normal((m, sensors)))
    )
    release = 5.0 + rng.uniform(-0.5, 0.5)
    n = int(duration * rate)
    t = np.arange(n) / rate - release
    samples = noise * rng.standard_normal((n, sensors))
    samples += rng.uniform(-0.1, 0.1, sensors) + np.outer(t / duration, rng.uniform(-0.02, 0.02, sensors))
    samples += 0.005 * np.sin(2 * np.pi * t[:, None] / rng.uniform(100, 300, sensors))
    early, late = (t >= 0) & (t < nonlinear), t >= max(nonlinear, 0)
    samples[late] += (2 * np.exp(np.outer(t[late], poles)) @ residues).real
    other = residues * rng.uniform(0.5, 1.5, residues.shape)
    samples[early] += (2 * np.exp(np.outer(t[early], poles * 1.02)) @ other).real
    return SyntheticDrop(samples, rate, release, poles)
