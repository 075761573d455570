"""A program as a system under test, spoken to in JSON lines over its standard input and output.

Protocol `pantocheck.command/1`. Every message is one JSON object on one line, UTF-8, ended by a newline.

=====================  ===============================================================================================
to the program         answer of the program
=====================  ===============================================================================================
``start``              ``started``: its name and version
``run`` (a case)       ``delivered`` (record files and their digests, static quantities), ``skipped`` or ``errored``
``stop``               none: it ends
=====================  ===============================================================================================

The case holds every number that a simulation needs and none of its limits. Standard error is free for the program's
own log. JSON Schemas: `pantocheck schema command-request` and `pantocheck schema command-answer`.
"""
