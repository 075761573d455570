"""Number of threads of linear algebra."""

import numpy as np
from threadpoolctl import threadpool_info, threadpool_limits

from pantocheck.model.description.one_thread import use_one_thread


def count_threads() -> set[int]:
    """Numbers of threads of the loaded libraries of linear algebra."""
    return {library["num_threads"] for library in threadpool_info() if library["user_api"] == "blas"}


def test_function_uses_one_thread_and_leaves_the_number_as_it_was() -> None:
    assert np.linalg.eigvalsh(np.eye(2)).size == 2  # the library is loaded
    with threadpool_limits(limits=2, user_api="blas"):
        assert count_threads() == {2}
        assert use_one_thread(count_threads)() == {1}
        assert count_threads() == {2}
