"""Public interface for plug-ins: readers, quantities and systems of other distributions (docs/extending.md)."""

from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.input_files.measured_table import MeasuredTable, TableColumn
from pantocheck.conformance.input_files.plug_in_reader import TableReader
from pantocheck.conformance.quantities.force_signals import ForceSignals
from pantocheck.conformance.quantities.plug_in_quantity import ForceQuantity
from pantocheck.conformance.quantities.sampling import Sampling
from pantocheck.conformance.systems.plug_in_protocol import CaseSkipped, CaseSystem, DeliveredPassage, SystemFactory

__all__ = [
    "CaseSkipped",
    "CaseSystem",
    "DeliveredPassage",
    "ForceQuantity",
    "ForceSignals",
    "InputError",
    "MeasuredTable",
    "Sampling",
    "SystemFactory",
    "TableColumn",
    "TableReader",
]
