"""Commands as a user calls them, in this process."""

from typer.testing import CliRunner, Result

from pantocheck.conformance.app.commands.command_list import app

SKIPPER = """
import json, sys
for line in sys.stdin:
    message = json.loads(line)
    if message["message"] == "stop":
        break
    if message["message"] == "start":
        answer = {"message": "started", "protocol": "pantocheck.command/1", "name": "skipper", "version": "1"}
        answer["features"] = "bending_stiffness chain droppers presag rayleigh_damping steady_arms".split()
    else:
        with open(sys.argv[1], "a") as log:
            print(message["case"]["id"], file=log)
        answer = {"message": "skipped", "id": message["id"], "reason": "no such line"}
    print(json.dumps(answer), flush=True)
"""
"""Program that skips every case, and writes its id into the file that its argument names."""


def pantocheck(*arguments: object, **environment: str) -> Result:
    """Result of `pantocheck` with some arguments; variables of the environment, such as COLUMNS, may be stated."""
    return CliRunner(env=environment).invoke(app, [str(argument) for argument in arguments])
