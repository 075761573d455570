"""Packages of the optional extras: one message for each that is not installed, with the line that installs it."""

from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec

from pantocheck.conformance.core.input_error import InputError

EXTRA_OF_PACKAGE = {
    "numba": "simulator",
    "typst": "pdf",
    "pypdf": "pdf",
    "pyuff": "massdrop",
    "h5py": "massdrop",
    "nptdms": "tdms",
    "asammdf": "mdf",
    "pyhanko": "sign",
    "pyhanko_certvalidator": "sign",
    "asn1crypto": "sign",
    "cryptography": "sign",
    "distributed": "cluster",
    "dask": "cluster",
    "dask_jobqueue": "cluster",
    "pyarrow": "parquet",
    "fmpy": "fmi",
    "openpyxl": "sheets",
}
"""Extra of `pyproject.toml` that installs a package, by its name in an import."""

NOT_INSTALLED = "not installed"
"""Version of a package of an extra that is not installed."""


class MissingPackage(InputError):
    """A package of an extra is not installed: the message names the line that installs the extra."""

    def __init__(self, where: str, package: str) -> None:
        self.package = package
        found = f"needs the package {package}, which is not installed"
        super().__init__(where, found, f"Install it: {install_line(package)}")


@contextmanager
def refuse_missing_package(where: str) -> Iterator[None]:
    """Convert the failed import of a package of an extra inside a block into a message for the user.

    Args:
        where: File, option or function that needs the package.

    Raises:
        MissingPackage: The package is not installed.
    """
    try:
        yield
    except ModuleNotFoundError as error:
        package = str(error.name).partition(".")[0]
        if package not in EXTRA_OF_PACKAGE:
            raise
        raise MissingPackage(where, package) from None


def require_package(package: str, where: str) -> None:
    """Require a package of an extra before a long computation, without the time of its import.

    Args:
        package: Name of the package in an import.
        where: File, option or function that needs the package.

    Raises:
        MissingPackage: The package is not installed.
    """
    if not is_installed(package):
        raise MissingPackage(where, package)


def is_installed(package: str) -> bool:
    """Whether a package can be imported."""
    return find_spec(package) is not None


def version_or_absence(package: str) -> str:
    """Version of an optional package; `NOT_INSTALLED` without its extra."""
    from importlib.metadata import version  # slow to load: the help of the commands loads this file

    return version(package) if is_installed(package) else NOT_INSTALLED


def install_line(package: str) -> str:
    """Command that installs the extra of a package."""
    return f"pip install 'pantocheck[{EXTRA_OF_PACKAGE[package]}]'"
