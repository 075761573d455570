"""FMUs of linear pantographs, compiled from C, with faults on request."""

import functools
import shutil
import subprocess
import tempfile
import tomllib
import zipfile
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import tomli_w

from pantocheck.conformance.cases.case_parts import read_pantograph_file
from pantocheck.conformance.core.extras import is_installed
from pantocheck.conformance.pantograph.pantograph_model import build_pantograph
from pantocheck.model.description.arrays import Array
from pantocheck.model.description.pantograph import Pantograph, equilibrium

FAULTS = {
    name: number
    for number, name in enumerate(
        ("none", "sign", "delay", "energy", "crash", "hang", "not a number", "noise", "abort", "memory")
    )
}
"""Faults of the FMU by the value of its parameter `fault`."""


def find_missing_tool() -> str | None:
    """Reason why FMUs cannot be built or loaded here; None if they can."""
    if not is_installed("fmpy"):
        return "the extra fmi (FMPy) is not installed"
    return "there is no C compiler" if shutil.which("cc") is None else None


def build_fmu(path: Path, pantograph: Pantograph, uplift: Array, version: int = 2, has_state: bool = True) -> Path:
    """Build the FMU of a pantograph.

    Args:
        path: Archive to write.
        pantograph: Linear model; its force holds without the uplift force.
        uplift: Effect of the uplift force on the unknowns [-].
        version: Major version of FMI.
        has_state: Whether the description offers state rollback.
    """
    strips, size = len(pantograph.strips), pantograph.head.size
    inverse, shapes = np.linalg.inv(pantograph.mass), pantograph.strip_shapes
    # The FMU counts its heights from the working height of the pantograph, here 0.
    values = {
        "rest": inverse @ pantograph.force,
        "uplift": inverse @ uplift,
        "point": uplift,
        "start": equilibrium(pantograph, 0.0)[0],
        "stiffness": inverse @ pantograph.stiffness,
        "damping": inverse @ pantograph.damping,
        "drive": inverse @ shapes.T,
        "heads": shapes,
    }
    header = f"#define UNKNOWNS {size}\n#define STRIPS {strips}\n"
    for name, value in values.items():
        array = np.asarray(value)
        places = "".join(f"[{n}]" for n in array.shape)
        rows = [", ".join(f"{x!r}" for x in row) for row in np.atleast_2d(array).tolist()]
        body = rows[0] if array.ndim == 1 else ", ".join(f"{{{row}}}" for row in rows)
        header += f"static const double {name}{places} = {{{body}}};\n"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", describe(strips, size, version, has_state))
        folder = "linux64" if version == 2 else "x86_64-linux"
        archive.writestr(f"binaries/{folder}/linear.so", _compile(header))
    return path


def write_fmu_pantograph(folder: Path, source: Path, version: int = 2, has_state: bool = True, **keys: object) -> Path:
    """Write a pantograph file whose chain is also an FMU beside it.

    Args:
        folder: Folder of both files.
        source: Pantograph file of the chain.
        version: Major version of FMI.
        has_state: Whether the FMU offers state rollback.
        keys: Further keys of the table `fmu`.

    Returns:
        Pantograph file.
    """
    file = read_pantograph_file(source)
    still, lifted = (build_pantograph(file, force, 0.0) for force in (0.0, 1.0))
    build_fmu(folder / "model.fmu", still, lifted.force - still.force, version, has_state)
    strips = range(1, len(still.strips) + 1)
    table = {
        "model": "model.fmu",
        "contact_force_N": [f"force{n}" for n in strips],
        "head_height_m": [f"height{n}" for n in strips],
        "working_height_m": 0.0,
        "uplift_force_N": "lift",
    }
    content = tomllib.loads(source.read_text(encoding="utf-8")) | {"fmu": table | keys}
    path = folder / "fmu.toml"
    path.write_text(tomli_w.dumps(content), encoding="utf-8")
    return path


@functools.cache
def _compile(header: str) -> bytes:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "model.h").write_text(header)
        source = Path(__file__).parent / "linear_fmu.c"
        arguments = [
            "cc",
            "-O2",
            "-w",
            "-shared",
            "-fPIC",
            "-I",
            name,
            str(source),
            "-o",
            str(folder / "linear.so"),
            "-lm",
        ]
        subprocess.run(arguments, check=True)
        return (folder / "linear.so").read_bytes()


def describe(
    strips: int, size: int, version: int, has_state: bool = True, units: Mapping[str, str] | None = None
) -> str:
    """Model description; heights in millimetres."""
    state = "canGetAndSetFMUstate" if version == 2 else "canGetAndSetFMUState"
    units = {"force": "N", "height": "mm"} | dict(units or {})

    def variable(name: str, number: int, causality: str, attributes: str, unit: str = "") -> str:
        variability = {"parameter": "fixed"}.get(causality, "continuous")
        shared = f'name="{name}" valueReference="{number}" causality="{causality}" variability="{variability}"'
        attributes += f' unit="{unit}"' if unit else ""
        if version == 2:
            return f"<ScalarVariable {shared}><Real {attributes}/></ScalarVariable>"
        return f"<Float64 {shared} {attributes}/>"

    names = [("force1", 0, "input", 'start="0"', units["force"]), ("force2", 1, "input", 'start="0"', units["force"])]
    names += [("lift", 2, "parameter", 'start="120"', "N"), ("fault", 3, "parameter", 'start="0"', "")]
    names += [("substeps", 4, "parameter", 'start="1"', "")]
    names += [(f"height{s + 1}", 5 + s, "output", "", units["height"]) for s in range(2)]
    names += [(f"x{k}", 7 + k, "local", "", "") for k in range(2 * size)]
    controls = [(name, 900 + k, "parameter", 'start="0"', "") for k, name in enumerate(("skyhook", "delay", "limit"))]
    offset = len(names) if version == 2 else 7
    first = offset - 2 * size + 1 if version == 2 else 7
    names += [(f"der(x{k})", 7 + 2 * size + k, "local", f'derivative="{first + k}"', "") for k in range(2 * size)]
    variables = "".join(variable(*row) for row in [*names, *controls])
    if version == 2:
        variables = variables.replace('causality="local"', 'causality="local" initial="calculated"')
        outputs, slopes = (
            "".join(f'<Unknown index="{k}"/>' for k in indices)
            for indices in ((6, 7), range(offset + 1, offset + 1 + 2 * size))
        )
        structure = f"<Outputs>{outputs}</Outputs><Derivatives>{slopes}</Derivatives>"
        kinds = "".join(
            f'<{kind} modelIdentifier="linear" {state}="{str(has_state).lower()}" {extra}/>'
            for kind, extra in (
                ("ModelExchange", ""),
                ("CoSimulation", 'canHandleVariableCommunicationStepSize="true"'),
            )
        )
        identity = 'guid="linear"'
    else:
        structure = '<Output valueReference="5"/><Output valueReference="6"/>'
        structure += "".join(
            f'<ContinuousStateDerivative valueReference="{7 + 2 * size + k}"/>' for k in range(2 * size)
        )
        kinds = "".join(
            f'<{kind} modelIdentifier="linear" {state}="{str(has_state).lower()}"/>'
            for kind in ("ModelExchange", "CoSimulation")
        )
        identity = 'instantiationToken="linear"'
        variables += '<Float64 name="time" valueReference="999" causality="independent" variability="continuous"/>'
    return (
        f'<?xml version="1.0" encoding="UTF-8"?><fmiModelDescription fmiVersion="{version}.0"'
        f' modelName="linear pantograph" {identity} generationTool="test compiler" version="1.2">{kinds}'
        "<UnitDefinitions>"
        '<Unit name="N"><BaseUnit kg="1" m="1" s="-2"/></Unit><Unit name="mm"><BaseUnit m="1" factor="0.001"/></Unit>'
        f"</UnitDefinitions><ModelVariables>{variables}</ModelVariables>"
        f"<ModelStructure>{structure}</ModelStructure></fmiModelDescription>"
    )
