"""Messages between the line and a rig, over UDP: a command for every step, and samples of the rig.

Little-endian numbers without padding. Heights count from that of the head at the start of the passage, upwards.

| command | type | sample | type |
|---|---|---|---|
| mark `PCR1` | 4 bytes | mark `PCS1` | 4 bytes |
| phase | uint32 | fault of the rig, 0: none | uint32 |
| number, from 1 | uint64 | number of the last command that acts | uint64 |
| height [m] | float64 | time of the sample on the clock of the rig [s] | float64 |
| velocity [m/s] | float64 | height of the head [m] | float64 |
| | | force on the head, downwards [N] | float64 |
"""

import math
import socket
import struct
from collections.abc import Sequence
from enum import IntEnum
from typing import NamedTuple, Protocol

from pantocheck.conformance.core.input_error import InputError

COMMAND, SAMPLE = struct.Struct("<4sIQdd"), struct.Struct("<4sIQddd")
COMMAND_MARK, SAMPLE_MARK = b"PCR1", b"PCS1"
MOST_PER_STEP = 64
"""Largest number of messages that are read in one step."""


class RigPhase(IntEnum):
    """Phase of a run; the rig moves the head in `APPROACH`, `HOLD` and `PASSAGE` alone."""

    CONNECT = 0
    APPROACH = 1
    HOLD = 2
    PASSAGE = 3
    STOP = 4
    """A limit was exceeded: the head is braked, then the rig makes itself safe."""
    END = 5


class RigCommand(NamedTuple):
    """Command to the rig."""

    phase: RigPhase
    number: int
    height: float
    velocity: float


class RigSample(NamedTuple):
    """Sample of the rig."""

    fault: int
    number: int
    time: float
    height: float
    force: float


def pack_command(command: RigCommand) -> bytes:
    """Message of a command."""
    return COMMAND.pack(COMMAND_MARK, *command)


def read_command(message: bytes) -> RigCommand | None:
    """Command of a message; None if it is not a command."""
    if len(message) != COMMAND.size or not message.startswith(COMMAND_MARK):
        return None
    _, phase, *rest = COMMAND.unpack(message)
    return RigCommand(RigPhase(phase), *rest) if phase <= max(RigPhase) else None


def pack_sample(sample: RigSample) -> bytes:
    """Message of a sample."""
    return SAMPLE.pack(SAMPLE_MARK, *sample)


def read_sample(message: bytes) -> RigSample | None:
    """Sample of a message; None if it is not a sample or its numbers are not finite."""
    if len(message) != SAMPLE.size or not message.startswith(SAMPLE_MARK):
        return None
    sample = RigSample(*SAMPLE.unpack(message)[1:])
    return sample if all(map(math.isfinite, sample[2:])) else None


class RigLink(Protocol):
    """Exchange with a rig."""

    def send(self, command: RigCommand) -> None:
        """Send a command without waiting."""

    def receive(self) -> Sequence[RigSample | None]:
        """Samples that have arrived; None: a message that is none."""


class UdpLink:
    """Exchange over UDP; the system passes messages of the address of the rig alone.

    Args:
        address: `HOST:PORT` of the rig.

    Raises:
        InputError: There is no such address.
    """

    def __init__(self, address: str) -> None:
        host, _, port = address.rpartition(":")
        where, hint = f"rig '{address}'", "Write HOST:PORT, such as 192.168.0.20:5318."
        if not host or not port.isdecimal() or not 0 < int(port) < 65536:
            raise InputError(where, "is not an address", hint)
        try:
            family, kind, protocol, _, place = socket.getaddrinfo(host.strip("[]"), int(port), type=socket.SOCK_DGRAM)[
                0
            ]
            self._socket = socket.socket(family, kind, protocol)
            self._socket.connect(place)
        except OSError as error:
            raise InputError(where, f"cannot be reached: {error.strerror}", hint) from None
        self._socket.setblocking(False)

    def send(self, command: RigCommand) -> None:
        """Send a command; one that cannot be sent is lost, like one that is lost on the way."""
        try:
            self._socket.send(pack_command(command))
        except OSError:
            return

    def receive(self) -> list[RigSample | None]:
        """Samples that have arrived."""
        found: list[RigSample | None] = []
        while len(found) < MOST_PER_STEP:
            try:
                found.append(read_sample(self._socket.recv(SAMPLE.size + 1)))
            except BlockingIOError:
                break
            except OSError:  # no program at the address yet
                break
        return found

    def close(self) -> None:
        """Close the socket."""
        self._socket.close()
