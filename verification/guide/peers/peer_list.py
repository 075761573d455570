"""Optional packages of the peer comparisons: presence, version and install line."""

from collections.abc import Callable
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version

import numpy as np
from scipy.stats import qmc

from pantocheck.conformance.campaigns.sample_statistics import estimate_sobol_indices
from pantocheck.conformance.core.array_types import RealArray
from verification.guide.comparisons import compare_absolute
from verification.guide.guide_format import CheckedValue, PeerComparison
from verification.guide.peers.exudyn_passage import compare_contact_forces
from verification.guide.peers.scikit_fem_modes import compare_frequencies
from verification.guide.peers.subspace_modes import compare_identified_modes


@dataclass(frozen=True)
class Peer:
    """Comparison with an optional package."""

    package: str
    """Name of the package in its registry."""
    title: str
    setting: str
    """Subject of the comparison; computation, and parts that both programs share."""
    compare: Callable[[], list[CheckedValue]]
    """Comparison; it imports the package."""


def find_version(package: str) -> str | None:
    """Installed version of a package; None if it is not installed."""
    try:
        return version(package)
    except PackageNotFoundError:
        return None


def run_peer(peer: Peer) -> PeerComparison:
    """Run the comparison if its package is installed; otherwise state that it was not run."""
    installed = find_version(peer.package)
    if installed is None:
        return PeerComparison(package=peer.package, version=None, title=peer.title, setting=peer.setting)
    return PeerComparison(
        package=peer.package, version=installed, title=peer.title, setting=peer.setting, comparisons=peer.compare()
    )


# SALib: Sobol indices of the function of Ishigami and Homma.
DESIGNS = 1024
INDEX_TOLERANCE = 1e-6
"""Largest difference of an index: both centre the values with slightly different means."""


def evaluate_ishigami(x: RealArray) -> RealArray:
    """Values sin x1 + 7 sin^2 x2 + 0.1 x3^4 sin x1 of designs (..., 3) (Ishigami and Homma 1990)."""
    return np.asarray(np.sin(x[..., 0]) + 7 * np.sin(x[..., 1]) ** 2 + 0.1 * x[..., 2] ** 4 * np.sin(x[..., 0]))


def compare_indices() -> list[CheckedValue]:
    """Indices of first order and total indices beside those of SALib, from the same designs."""
    from SALib.analyze import sobol

    points = np.pi * (2 * qmc.Sobol(6, scramble=True, rng=1).random(DESIGNS) - 1)
    first_set, second_set = points[:, :3], points[:, 3:]
    exchanged = np.stack([first_set] * 3, axis=1)
    for i in range(3):
        exchanged[:, i, i] = second_set[:, i]
    values = (evaluate_ishigami(first_set), evaluate_ishigami(second_set), evaluate_ishigami(exchanged))
    shares = estimate_sobol_indices(*values)
    problem = {"num_vars": 3, "names": ["x1", "x2", "x3"], "bounds": [[-np.pi, np.pi]] * 3}
    ordered = np.column_stack([values[0], values[2], values[1]]).ravel()
    theirs = sobol.analyze(problem, ordered, calc_second_order=False, num_resamples=100, seed=1)
    reason = "The same estimators (Saltelli et al. 2010, Jansen 1999) on the same designs."
    rows = []
    for kind, ours, key in (("first-order", shares.first[0], "S1"), ("total", shares.total[0], "ST")):
        rows += [
            compare_absolute(f"{kind}-{i + 1}", f"{kind} index of x{i + 1}", "-", pair, INDEX_TOLERANCE, reason)
            for i, pair in enumerate(zip(ours, theirs[key], strict=True))
        ]
    return rows


# All comparisons with packages of others.
PEERS = {
    "exudyn": Peer(
        "exudyn",
        "Exudyn: contact forces of two pantographs",
        "Exudyn receives the assembled matrices of line and pantographs and the initial state. It integrates them with "
        "its own Newmark method, Newton's method and sparse solver. Slack droppers and the moving contact are user "
        "functions of this comparison. It confirms time integration, slackening and contact, not the matrices. Line of "
        "four spans of 44 m, two pantographs 30 m apart, 216 km/h, 0.4 s.",
        compare_contact_forces,
    ),
    "scikit-fem": Peer(
        "scikit-fem",
        "scikit-fem: natural frequencies of a line",
        "scikit-fem assembles both wires with elements of an eighth of the length; the springs of droppers, arms and "
        "supports are added to its matrices. Line of three spans of 44 m, 30 modes.",
        compare_frequencies,
    ),
    "pyOMA-2": Peer(
        "pyOMA-2",
        "pyOMA-2: modes from a mass drop with known poles",
        "A synthetic record with six known modes and noise. pyOMA-2 identifies the same linear decay by its "
        "covariance-driven subspace method, with one model order and no further choice.",
        compare_identified_modes,
    ),
    "SALib": Peer(
        "SALib",
        "SALib: Sobol indices of the function of Ishigami",
        "Both estimate the indices from the same 1024 designs of a Sobol sequence.",
        compare_indices,
    ),
}
"""Comparisons by package."""
