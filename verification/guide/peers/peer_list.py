"""All comparisons with packages of others."""

from verification.guide.peers.exudyn_passage import compare_contact_forces
from verification.guide.peers.peer_package import Peer
from verification.guide.peers.salib_indices import compare_indices
from verification.guide.peers.scikit_fem_modes import compare_frequencies
from verification.guide.peers.subspace_modes import compare_identified_modes

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
