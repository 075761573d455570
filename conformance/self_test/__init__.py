"""The suite tested: systems that are wrong on purpose must not pass, and the right one must."""

from pantocheck.conformance.self_test.bench import Row, SelfTest, self_test

__all__ = ["Row", "SelfTest", "self_test"]
