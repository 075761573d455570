"""Optional packages of the peer comparisons: presence, version and install line."""

from collections.abc import Callable
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version

from verification.guide.guide_format import CheckedValue, PeerComparison


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
