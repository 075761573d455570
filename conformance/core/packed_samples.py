"""Samples of a signal in results.json: compact, without loss of a bit, and with a checksum.

Packing: the 64 bits of each float64 are taken as a whole number; each number is replaced by its second difference
modulo 2^64, with the sign in the lowest bit; the lowest bytes of all numbers come first, then the next ones
(little-endian); zlib compresses them; base64 writes them as text. Neighbours of a smooth signal differ little, so that
the high bytes are zero.
"""

import zlib
from base64 import b64decode, b64encode
from hashlib import sha256
from math import isnan
from typing import Annotated, Self, TypeVar

import numpy as np
from pydantic import Field, model_validator

from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.results_part import ResultsPart

MOST_SAMPLES = 500_000
"""Largest number of samples of a signal in results.json."""

BYTES = 8
"""Size of a sample."""


class PackedDamaged(ValueError):
    """Packed samples that cannot be unpacked, or that are not those of their checksum: no number follows from them."""


class PackedSamples(ResultsPart):
    """Samples of one signal, packed."""

    samples: Annotated[int, Field(ge=0, le=MOST_SAMPLES)]
    """Number of samples."""
    packed_bytes: int
    """Size of the compressed samples."""
    sha256: str
    """SHA-256 of the samples as little-endian float64."""
    data: Annotated[str, Field(max_length=2 * BYTES * MOST_SAMPLES)]
    """Compressed samples in base64."""

    def unpack(self) -> RealArray:
        """Samples, (n,).

        Raises:
            PackedDamaged: The data cannot be unpacked, or size, number or checksum differ from those stated.
        """
        size = BYTES * self.samples
        try:
            packed = b64decode(self.data, validate=True)
            unpacker = zlib.decompressobj()
            shuffled = unpacker.decompress(packed, size + 1)
        except (ValueError, zlib.error) as error:
            raise PackedDamaged(f"the samples cannot be unpacked ({error})") from None
        if len(packed) != self.packed_bytes or len(shuffled) != size or unpacker.unused_data or not unpacker.eof:
            raise PackedDamaged(f"{self.samples} samples in {self.packed_bytes} bytes stated, but the data have others")
        numbers = np.frombuffer(shuffled, np.uint8).reshape(BYTES, -1).T.copy().view("<u8").ravel()
        differences = (numbers >> np.uint64(1)) ^ (np.uint64(0) - (numbers & np.uint64(1)))
        samples = np.cumsum(np.cumsum(differences, dtype=np.uint64), dtype=np.uint64).astype("<u8")
        if _digest(samples.tobytes()) != self.sha256:
            raise PackedDamaged("the samples do not have the stated SHA-256")
        return samples.view("<f8").astype(np.float64)


def pack_samples(samples: RealArray) -> PackedSamples:
    """Pack the samples of a signal, (n,); missing ones are NaN."""
    numbers = np.where(np.isnan(samples), np.nan, samples).astype("<f8")  # NaN has many patterns of bits
    differences = numbers.view("<u8")
    for _ in range(2):
        differences = np.diff(differences, prepend=np.uint64(0))
    signed = (differences << np.uint64(1)) ^ (np.uint64(0) - (differences >> np.uint64(63)))
    shuffled = np.ascontiguousarray(signed.astype("<u8").view(np.uint8).reshape(-1, BYTES).T).tobytes()
    packed = zlib.compress(shuffled, 9)
    return PackedSamples(
        samples=samples.size,
        packed_bytes=len(packed),
        sha256=_digest(numbers.tobytes()),
        data=b64encode(packed).decode("ascii"),
    )


def _digest(content: bytes) -> str:
    return f"sha256:{sha256(content).hexdigest()}"


class PantographSamples(ResultsPart):
    """Signals of one pantograph around the analysis section, sample by sample."""

    filter_applied_Hz: float | None
    """Cut-off of the low-pass filter applied before delivery [Hz]; null: unfiltered."""
    position_m: PackedSamples
    force_N: PackedSamples
    """Contact force as delivered."""
    contact_height_m: PackedSamples | None
    """Height of the contact point in the analysis sections, elsewhere missing; null: not delivered."""
    front_strip_N: Annotated[PackedSamples | None, Field(exclude_if=lambda value: value is None)] = None
    """Contact force of the front strip, of two, as delivered."""
    arcs: PackedSamples | None = None
    loaded: PackedSamples | None = None
    """Arcs, and time under load, as 1 or 0; null: no arc detector."""

    @model_validator(mode="after")
    def _equal_lengths(self) -> Self:
        channels = (
            self.position_m,
            self.force_N,
            self.contact_height_m,
            self.front_strip_N,
            self.arcs,
            self.loaded,
        )
        return _check_lengths(self, [channel for channel in channels if channel is not None])


class SupportSamples(ResultsPart):
    """Uplift of the contact wire at one support, from before the first pantograph until it no longer counts."""

    support_m: float
    first: Annotated[int, Field(ge=0)]
    """Index of the first sample in `time_s` and `last_position_m`; 0 with positions of its own."""
    uplift_m: PackedSamples
    last_position_m: Annotated[PackedSamples | None, Field(exclude_if=lambda value: value is None)] = None
    """Positions of the last pantograph at the samples of a source with its own times; missing: those of the record."""

    @model_validator(mode="after")
    def _equal_lengths(self) -> Self:
        return self if self.last_position_m is None else _check_lengths(self, [self.uplift_m, self.last_position_m])


TrackStretch = tuple[float, float]


class SignalSamples(ResultsPart):
    """Evaluated signals of a record at their full rate: its quantities and curves follow from them."""

    rate_Hz: Annotated[float, Field(gt=0)]
    evaluated_m: Annotated[TrackStretch, Field(strict=False)]
    """Analysis section; start included, end excluded."""
    pantographs: dict[Annotated[str, Field(pattern="^[1-9][0-9]?$")], PantographSamples]
    """Pantographs that cross the whole analysis section."""
    uplift: list[SupportSamples]
    """Supports of the analysis section."""
    time_s: PackedSamples | None
    """Times of the samples of the record; null: not known, or no uplift."""
    last_position_m: PackedSamples | None
    """Positions of the last pantograph at these times; null: no uplift, or every support has its own."""
    line_supports_m: list[float] | None
    """Positions of all supports of the line; null: not known."""
    overlaps_m: Annotated[list[TrackStretch], Field(strict=False)] = []
    """Overlaps of tension sections."""
    excluded_m: Annotated[list[TrackStretch], Field(strict=False)] = []
    """Stretches that are left out of the statistics."""
    shortest_loss_s: float | None = None
    """Shortest duration of a long contact loss; null: not stated."""

    @model_validator(mode="after")
    def _equal_lengths(self) -> Self:
        common = [support for support in self.uplift if support.last_position_m is None]
        if common and (self.last_position_m is None or len(common) < len(self.uplift)):
            raise ValueError("uplift without the positions of the last pantograph")
        samples = 0 if self.last_position_m is None else self.last_position_m.samples
        if any(support.first + support.uplift_m.samples > samples for support in common):
            raise ValueError("uplift beyond the end of the record")
        return _check_lengths(self, [part for part in (self.time_s, self.last_position_m) if part is not None])


Part = TypeVar("Part", bound=ResultsPart)


def _check_lengths(part: Part, channels: list[PackedSamples]) -> Part:
    """Return a part whose channels have one length, of two samples or more."""
    lengths = {channel.samples for channel in channels}
    if len(lengths) > 1 or any(length < 2 for length in lengths):
        raise ValueError(f"channels of {', '.join(map(str, sorted(lengths)))} samples, expected one length from 2")
    return part


def list_numbers(signals: SignalSamples) -> dict[str, list[float | None]]:
    """Samples of all channels by their place; None for a missing sample. Packed data depend on the version of zlib.

    Raises:
        PackedDamaged: As `PackedSamples.unpack`.
    """
    found: dict[str, list[float | None]] = {}
    owners: list[tuple[str, ResultsPart]] = [("signals", signals)]
    owners += [(f"pantograph {number}", part) for number, part in signals.pantographs.items()]
    owners += [(f"support at {part.support_m:g} m", part) for part in signals.uplift]
    for owner, part in owners:
        for name, value in part:
            if isinstance(value, PackedSamples):
                numbers = value.unpack().tolist()
                found[f"{owner}, {name}"] = [None if isnan(number) else number for number in numbers]
    return found
