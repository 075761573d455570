"""Settings of every test run, made before numpy is imported."""

import gc
import os
import sys

from hypothesis import settings

# On matrices of a few hundred unknowns, the threads of a linear algebra library wait for each other.
for _library in ("OMP", "OPENBLAS", "MKL"):
    os.environ.setdefault(f"{_library}_NUM_THREADS", "1")

# Every process of the tests would compile the sources again.
sys.dont_write_bytecode = False
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)

# Property tests try the same examples in every run, and have no time limit on a loaded machine.
settings.register_profile("suite", deadline=None, derandomize=True, database=None, max_examples=50)
settings.load_profile("suite")


def pytest_report_header() -> str:
    """Folder of the package that is tested, which may be another one than that of the checkout."""
    import pantocheck.conformance

    return f"pantocheck.conformance: {pantocheck.conformance.__path__[0]}"


def pytest_collection_finish() -> None:
    """Leave the modules and tests, which stay, out of the garbage collection."""
    gc.freeze()
    gc.set_threshold(20_000)


pytest_plugins = [
    "helpers.figure_memory",  # first: it replaces a decorator
    "helpers.case_fixtures",
    "helpers.converged_fixtures",
    "helpers.example_results",
    "helpers.fake_distribution",
    "helpers.fmu_fixtures",
    "helpers.graded_wave",
    "helpers.record_fixtures",
    "helpers.signer_fixtures",
    "helpers.verifier_page",
]
