"""Program as a system under test: exchange of JSON lines over its standard input and output.

Protocol `pantocheck.command/1`. Every message is one JSON object on one line, UTF-8, ended by a newline.

=====================  ===============================================================================================
to the program         answer of the program
=====================  ===============================================================================================
``start``              ``started``: its name and version
``run`` (a case)       ``delivered`` (record files and their digests, static quantities), ``skipped`` or ``errored``
``stop``               none: the program ends
=====================  ===============================================================================================

The case contains every number of a simulation and none of its limits. Standard error is free for a log of the program.
 JSON Schemas: `pantocheck schema command-request` and `pantocheck schema command-answer`.
"""
