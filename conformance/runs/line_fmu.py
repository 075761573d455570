"""Line of a case as FMU for co-simulation, in FMI 2.0 or 3.0, compiled by the C compiler of this machine."""

import io
import os
import platform
import shlex
import shutil
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Sequence
from dataclasses import replace
from importlib.metadata import version
from pathlib import Path
from typing import Literal
from xml.etree import ElementTree

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.line.catenary_model import discretise_line
from pantocheck.conformance.runs.case_run import build_passage, watch_supports
from pantocheck.conformance.runs.core_requirement import require_core
from pantocheck.conformance.runs.uplift_tuning import estimate_uplift_forces
from pantocheck.model.dynamics.core_source import COMPILER_OPTIONS, LINE_SOURCES
from pantocheck.model.dynamics.line_image import GivenInput, LineImage, build_line_image

FmiVersion = Literal["2.0", "3.0"]
MODEL = "pantocheck_line"
"""Model identifier: name of the shared library."""
ENTRY_DATE = (1980, 1, 1, 0, 0, 0)
"""Date of the entries, so that equal lines give equal archives."""
LIBRARIES = {"linux": "so", "darwin": "dylib", "windows": "dll"}
"""Suffix of a shared library by the system."""


def build_line_fmu(case: Case, fmi: FmiVersion, given: GivenInput) -> bytes:
    """Build the FMU of the line of a case.

    Args:
        case: Case with a train.
        fmi: Version of FMI.
        given: Input at each strip.

    Returns:
        Archive with model description, data, shared library and sources.

    Raises:
        InputError: There is no C compiler, or it fails.
    """
    library = compile_library()
    image = build_case_image(case, given)
    entries = {
        "modelDescription.xml": describe_model(case.file.title, image, case.file.discretisation.time_step_s, fmi),
        "resources/line.bin": image.content,
        f"binaries/{name_platform(fmi)}": library,
    }
    if fmi == "3.0":
        entries["sources/buildDescription.xml"] = describe_build()
    entries |= {f"sources/{path.name}": path.read_bytes() for path in LINE_SOURCES}
    archive = io.BytesIO()
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as file:
        for name, content in entries.items():
            file.writestr(zipfile.ZipInfo(name, ENTRY_DATE), content, zipfile.ZIP_DEFLATED)
    return archive.getvalue()


def build_case_image(case: Case, given: GivenInput) -> LineImage:
    """Memory image of the line of a case, whose pantographs press with their static forces at its start."""
    require_core("line as FMU")
    discretisation = case.file.discretisation
    line = discretise_line(case.line, discretisation.element_m)
    passage = build_passage(case, line, discretisation, estimate_uplift_forces(case, line))
    return build_line_image(line, replace(passage, watched=watch_supports(case.line.geometry.supports, line)), given)


def compile_library() -> bytes:
    """Compile the shared library, which is the same for all lines.

    Raises:
        InputError: There is no C compiler, or it fails.
    """
    command = shlex.split(os.environ.get("CC", "")) or ["cc"]
    where = "line as FMU"
    if shutil.which(command[0]) is None:
        raise InputError(
            where, f"there is no C compiler '{command[0]}'", "Install GCC or Clang, or name it in the variable CC."
        )
    with tempfile.TemporaryDirectory() as folder:
        library = Path(folder) / MODEL
        sources: Sequence[str] = [str(LINE_SOURCES[0]), "-o", str(library), "-lm"]
        arguments = [*command, *COMPILER_OPTIONS, "-fPIC", "-shared", *sources]
        done = subprocess.run(arguments, capture_output=True, text=True, errors="replace", timeout=600, check=False)
        if done.returncode != 0:
            reason = next((line for line in done.stderr.splitlines() if "error" in line), done.stderr[:200])
            raise InputError(where, f"the C compiler '{command[0]}' failed: {reason}", "GCC or Clang is needed.")
        return library.read_bytes()


def name_platform(fmi: FmiVersion) -> str:
    """Path of the shared library of this machine below `binaries`."""
    system = {"win32": "windows"}.get(sys.platform, sys.platform)
    machine = {"AMD64": "x86_64", "arm64": "aarch64"}.get(platform.machine(), platform.machine())
    folder = f"{machine}-{system}"
    if fmi == "2.0":
        folder = {"linux": "linux64", "darwin": "darwin64", "windows": "win64"}.get(system, folder)
    return f"{folder}/{MODEL}.{LIBRARIES.get(system, 'so')}"


def describe_build() -> bytes:
    """Description of the build of the sources, by which FMI 3.0 compiles them on another platform."""
    root = ElementTree.Element("fmiBuildDescription", fmiVersion="3.0")
    build = ElementTree.SubElement(root, "BuildConfiguration", modelIdentifier=MODEL)
    sources = ElementTree.SubElement(build, "SourceFileSet", language="C11")
    ElementTree.SubElement(sources, "SourceFile", name=LINE_SOURCES[0].name)
    return bytes(ElementTree.tostring(root, "utf-8", xml_declaration=True))


def describe_model(title: str, image: LineImage, time_step: float, fmi: FmiVersion) -> bytes:
    """Model description of a line with a time step [s]."""
    second, state = fmi == "2.0", {"2.0": "canGetAndSetFMUstate", "3.0": "canGetAndSetFMUState"}[fmi]
    root = ElementTree.Element(
        "fmiModelDescription",
        {
            "fmiVersion": fmi,
            "modelName": title,
            "guid" if second else "instantiationToken": image.token,
            "description": "Overhead contact line under pantographs",
            "generationTool": f"Pantocheck {version('pantocheck')}",
            "variableNamingConvention": "structured",
        },
    )
    step = {} if second else {"fixedInternalStepSize": repr(time_step)}
    kind = ElementTree.SubElement(
        root,
        "CoSimulation",
        {"modelIdentifier": MODEL, state: "true", "canHandleVariableCommunicationStepSize": "true", **step},
    )
    if second:
        files = ElementTree.SubElement(kind, "SourceFiles")
        ElementTree.SubElement(files, "File", name=LINE_SOURCES[0].name)
    units = ElementTree.SubElement(root, "UnitDefinitions")
    for name, base in {
        "s": {"s": "1"},
        "m": {"m": "1"},
        "m/s": {"m": "1", "s": "-1"},
        "N": {"kg": "1", "m": "1", "s": "-2"},
    }.items():
        ElementTree.SubElement(ElementTree.SubElement(units, "Unit", name=name), "BaseUnit", base)
    ElementTree.SubElement(root, "DefaultExperiment", startTime="0.0", stepSize=repr(time_step))
    variables = ElementTree.SubElement(root, "ModelVariables")
    outputs = []
    for number, variable in enumerate(image.variables):
        shared = {"name": variable.name, "valueReference": str(number), "causality": variable.causality}
        shared |= {"variability": "fixed" if variable.causality == "parameter" else "continuous"}
        shared |= {"description": variable.description}
        real = {"unit": variable.unit}
        if variable.causality in ("parameter", "input"):
            real["start"] = repr(variable.value)
        if second:
            ElementTree.SubElement(ElementTree.SubElement(variables, "ScalarVariable", shared), "Real", real)
        else:
            ElementTree.SubElement(variables, "Float64", shared | real)
        if variable.causality == "output":
            outputs.append({"index": str(number + 1)} if second else {"valueReference": str(number)})
    structure = ElementTree.SubElement(root, "ModelStructure")
    for name, single in (("Outputs", "Output"), ("InitialUnknowns", "InitialUnknown")):
        parent = ElementTree.SubElement(structure, name) if second else structure
        for output in outputs:
            ElementTree.SubElement(parent, "Unknown" if second else single, output)
    return bytes(ElementTree.tostring(root, "utf-8", xml_declaration=True))
