"""Commands whose artefacts are compared, and their execution.

Every command runs in the folder of the artefacts, with relative paths, so that two folders hold the same texts. Its
results lie in the folder of its name, its standard output in `output.txt` there.
"""

import json
import os
import shlex
import shutil
import subprocess
import time
from dataclasses import dataclass
from pathlib import Path

INPUTS = Path(__file__).parent / "inputs"

EXAMPLES = ("dossier", "string_catenary")
"""Folders of `examples/` that the commands read."""

EVERY_FORMAT = "--formats html,pdf,json,csv,junit,md,badge,annotations,codequality"
RESPONSES = "inputs/dossier/measured/response-70N.csv inputs/dossier/measured/response-110N.csv"
DROPPED_LINE = "--line vovan2015/mass-drop/printed"
ADAPTER = "'command:python3 inputs/string_catenary/adapter.py'"

COMMANDS = {
    "en50318-2002": f"run 'en50318-2002/*' {EVERY_FORMAT}",
    "ac-simple": f"run 'en50318-2018/ac-simple/*' --jobs 2 {EVERY_FORMAT}",
    "ac-stitched": f"run 'en50318-2018/ac-stitched/*' --jobs 2 {EVERY_FORMAT}",
    "force-law": "run force-law/300",
    "vovan2015": "run 'vovan2015/*' --jobs 2",
    "damping-study": "run en50318-2002/250 --damping-study",
    "own-limits": "run 'en50318-2002/*' --limits inputs/limits.toml",
    "changed-input": "run en50318-2002/250 --set line.contact_wire.tension_N=20500 --trust provisional",
    "baseline": "run en50318-2002/250 --set speed_km_h=252 --baseline en50318-2002/results.json",
    "library-record": "run 'en50318-2002/*' --system record:en50318-2002/known-passing-code --verdicts criteria",
    "program": f"run en50318-2002/250 --system {ADAPTER} --with-reference",
    "record-csv": "simulate en50318-2002/250 --out record-csv/250.csv",
    "record-h5": "simulate en50318-2018/ac-simple/320-twin --out record-h5/320-twin.h5",
    "record-stitched": "simulate en50318-2018/ac-stitched/275 --out record-stitched/275.csv",
    "record-system": "run en50318-2002/250 --system record:record-csv",
    "assess": "assess record-csv/250.csv --profile acceptance-ac --uplift-space-mm 120",
    "assess-dc": "assess record-csv/250.csv --profile acceptance-dc-3kv --uplift-space-mm 120",
    "assess-twin": "assess record-h5/320-twin.toml --profile acceptance-ac --uplift-space-mm 200",
    "validate": f"validate inputs/dossier/dossier.toml --jobs 2 {EVERY_FORMAT}",
    "line-test": "assess validate/records/160-up.h5 --profile line-test --measured inputs/dossier/measured/run-160.csv",
    "compare-records": "compare validate/records/200-up.h5 inputs/dossier/measured/run-200.csv",
    "compare-results": "compare en50318-2002 own-limits changed-input",
    "compare-systems": f"compare builtin {ADAPTER} --case en50318-2002/250",
    "campaign": "campaign inputs/campaign.toml --workers 2 --traces failing",
    "campaign-grid": "campaign 'en50318-2002/*' --vary speed_km_h=240:260:10 --workers 2 --traces all",
    "campaign-compared": (
        "campaign 'en50318-2002/*' --vary speed_km_h=240:260:10 --set line.contact_wire.tension_N=20500"
        " --workers 2 --compare campaign-grid"
    ),
    "drop-simulate": "drop simulate vovan2015/mass-drop/stand-in --out drop-simulate/drop.csv --drop 1",
    "drop-campaign": (
        "drop campaign vovan2015/mass-drop/printed --mass 15 --mass 30 --noise 0.003 --seed 7"
        " --out drop-campaign/drop.h5"
    ),
    "drop-identify": "drop identify drop-campaign/drop-1.h5 --export drop-identify/exported.csv",
    "drop-population": (
        "drop identify drop-campaign/drop-1.h5 drop-campaign/drop-2.h5 drop-campaign/drop-3.h5 --each"
        " --export drop-population/exported.uff"
    ),
    "drop-fit": f"drop fit drop-population/modes.json {DROPPED_LINE}",
    "drop-compare": f"drop compare drop-campaign/drop-1.h5 {DROPPED_LINE} --damping drop-fit/damping.toml",
    "drop-graded": (
        f"drop compare drop-campaign/drop-1.h5 {DROPPED_LINE} --damping drop-fit/damping.toml"
        " --limits inputs/drop-limits.toml"
    ),
    "line-statics": (
        "line statics inputs/dossier/measured/statics.csv --line inputs/dossier/line.toml --height-tolerance-mm 10"
        " --elasticity-tolerance-pct 10"
    ),
    "line-export": "line export inputs/dossier/line.toml",
    "line-import": (
        "line import line-export/supports.csv --droppers line-export/droppers.csv --base inputs/dossier/line.toml"
        " --out line-import/line.toml"
    ),
    "pantograph-compare": f"pantograph compare {RESPONSES} --pantograph inputs/dossier/pantograph.toml",
    "pantograph-graded": (
        f"pantograph compare {RESPONSES} --pantograph inputs/dossier/pantograph.toml"
        " --limits inputs/response-limits.toml"
    ),
    "pantograph-fit": f"pantograph fit {RESPONSES} --masses 3 --out pantograph-fit/fitted.toml",
    "new-line": "new line new-line/line.toml",
    "new-case": "new case new-case/case.toml",
    "new-pantograph": "new pantograph new-pantograph/pantograph.toml",
    "new-response": "new response new-response/response.toml",
    "new-administration": "new administration new-administration/administration.toml",
    "new-dossier": "new dossier new-dossier/dossier.toml",
    "cases": "cases",
    "show": "show en50318-2018/ac-stitched/275 --derived --request show/request.json",
    "line-draw": "line draw en50318-2018/ac-stitched/275 --out line-draw/line.svg",
    "show-drop": "show vovan2015/mass-drop/stand-in --derived",
    "describe": "describe inputs/dossier/measured/run-160.csv --out describe/run-160.toml",
    "verify-html": "verify en50318-2002/certificate.html",
    "verify-pdf": "verify ac-simple/certificate.pdf --any-verdict",
    "verify-json": "verify record-system/results.json --record record-csv/250.csv",
    "site": "site .",
    "self-test": "system self-test",
}
"""Commands by the name of their folder, in an order in which each finds the files that it reads."""

WITHOUT_FOLDER = ("cases", "show", "describe", "verify", "new", "system", "simulate")
"""Commands without a folder of results: no option `--out` is added."""

ENDED = (0, 1, 3)
"""Exit codes of commands that ended: pass, not passed, no limit judges."""


@dataclass(frozen=True)
class Outcome:
    """End of one command."""

    command: str
    """Words and options, as typed after `pantocheck`."""
    exit_code: int
    seconds: float


def write(folder: Path, program: Path, checkout: Path, selected: list[str]) -> bool:
    """Run the commands with one installed program and keep their artefacts.

    Args:
        folder: Folder of the artefacts; a folder of a selected command is replaced.
        program: Executable `pantocheck`; the programs beside it come first on the search path.
        checkout: Checkout of the same state, for its examples.
        selected: Names of the commands; all if empty.

    Returns:
        True if every command ended with 0 (pass), 1 (not passed) or 3 (no limit judges it).
    """
    folder.mkdir(parents=True, exist_ok=True)
    shutil.rmtree(folder / "inputs", ignore_errors=True)
    shutil.copytree(INPUTS, folder / "inputs")
    for example in EXAMPLES:
        shutil.copytree(checkout / "examples" / example, folder / "inputs" / example)
    listed = folder / "commands.json"
    outcomes = json.loads(listed.read_text()) if selected and listed.is_file() else {}
    names = selected or list(COMMANDS)
    begin = time.monotonic()
    for name in names:
        outcomes[name] = vars(_run(folder, program.absolute(), name))
        listed.write_text(json.dumps(outcomes, indent=1))
    failed = [name for name in names if outcomes[name]["exit_code"] not in ENDED]
    print(f"{len(names)} commands in {time.monotonic() - begin:.0f} s, failed: {', '.join(failed) or 'none'}")
    return not failed


def _run(folder: Path, program: Path, name: str) -> Outcome:
    out = folder / name
    shutil.rmtree(out, ignore_errors=True)
    out.mkdir()
    arguments = shlex.split(COMMANDS[name])
    if "--out" not in arguments and arguments[0] not in WITHOUT_FOLDER:
        arguments += ["--out", name]
    begin = time.monotonic()
    done = subprocess.run(
        [str(program), *arguments], cwd=folder, env=_environment(program), capture_output=True, text=True, check=False
    )
    outcome = Outcome(shlex.join(arguments), done.returncode, round(time.monotonic() - begin, 1))
    (out / "output.txt").write_text(done.stdout)
    print(f"{outcome.seconds:6.1f} s  exit code {outcome.exit_code}  pantocheck {outcome.command}", flush=True)
    if outcome.exit_code not in ENDED:
        print(done.stderr, flush=True)
    return outcome


def _environment(program: Path) -> dict[str, str]:
    path = f"{program.parent}{os.pathsep}{os.environ['PATH']}"
    return os.environ | {"PATH": path, "SOURCE_DATE_EPOCH": "1790000000", "COLUMNS": "120"}
