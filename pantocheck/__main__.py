"""`python -m pantocheck`: the command of the suite."""

from pantocheck.conformance.app.main import start

start()
