"""The suite tested: systems that are wrong on purpose must not pass, and the right one must."""
