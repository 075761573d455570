"""Compilation of the core in C. Without a C compiler the installation goes on without it, and numba is needed."""

import runpy

from setuptools import Extension, setup

core = runpy.run_path("model/dynamics/core_source.py")
source, *included = (f"model/dynamics/{path.name}" for path in core["SOURCES"])
time_step = Extension(
    "pantocheck.model.dynamics.time_step",  # a library without Python, in the place of an extension module
    [source],
    depends=included,
    define_macros=[("SOURCE_DIGEST", f'"{core["source_digest"]()}"')],
    extra_compile_args=[*core["COMPILER_OPTIONS"]],
    libraries=["m"],
    py_limited_api=True,
    optional=True,
)
setup(ext_modules=[time_step], options={"bdist_wheel": {"py_limited_api": "cp311"}})
