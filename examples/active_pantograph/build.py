"""Build active_pantograph.fmu beside this file, or in the folder that is named: a C compiler and Python suffice."""

import subprocess
import sys
import zipfile
from pathlib import Path

HERE = Path(__file__).parent
folder = Path(sys.argv[1]) if len(sys.argv) > 1 else HERE
library = folder / "active_pantograph.so"
options = ["-std=c11", "-O2", "-Wall", "-Wextra", "-fPIC", "-shared"]
subprocess.run(["cc", *options, str(HERE / "active_pantograph.c"), "-o", str(library), "-lm"], check=True)
with zipfile.ZipFile(folder / "active_pantograph.fmu", "w", zipfile.ZIP_DEFLATED) as archive:
    archive.write(HERE / "modelDescription.xml", "modelDescription.xml")
    archive.write(library, "binaries/linux64/active_pantograph.so")
library.unlink()
