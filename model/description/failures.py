"""Failures of the simulator, in the order of the steps of a simulation."""


class SimulationError(Exception):
    """The simulator has no reliable result.

    The cause is in the data of the line or of the pantographs, so the message names the place and the reader can act.
    """


class NoInitialState(SimulationError):
    """The prescribed geometry has no equilibrium with taut droppers: a simulation from it would not start at rest."""


class ImpossibleDropper(NoInitialState):
    """A dropper would have to push, or its wires cross.

    Args:
        message: Description of the cause.
        position: Position of the dropper along the line [m].
    """

    def __init__(self, message: str, position: float) -> None:
        super().__init__(message)
        self.position = position


class NegativeDamping(SimulationError):
    """Modal damping takes more from a mode than the components have: some motion would grow without a load."""


class NoEquilibrium(SimulationError):
    """The set of slack droppers does not settle under a static load: the last iterate is not in equilibrium."""


class ImpossiblePassage(SimulationError):
    """There is no pantograph, or one would leave the line: beyond its ends there is no wire to press against."""


class DidNotConverge(SimulationError):
    """The forces of a time step did not converge: all later steps would be numerical noise."""
