"""Settings of every test run, made before numpy is imported."""

import os

# On matrices of a few hundred unknowns, the threads of a linear algebra library wait for each other.
for _library in ("OMP", "OPENBLAS", "MKL"):
    os.environ.setdefault(f"{_library}_NUM_THREADS", "1")

pytest_plugins = [
    "helpers.case_fixtures",
    "helpers.converged_fixtures",
    "helpers.example_results",
    "helpers.record_fixtures",
]
