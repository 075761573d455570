"""Consistency of a record with itself and with the case it claims to be of.

Limits on statistics cannot detect a wrong record whose statistics lie inside them. The checks of this package need no
second simulation: they compare a record with its own channels, with its sidecar and with the pantograph of the case.
`record_checks.RECORD_CHECKS` lists them.
"""
