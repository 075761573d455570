"""`python -m pantocheck`: the command of the suite."""

from pantocheck.conformance.command_line import main

main()
