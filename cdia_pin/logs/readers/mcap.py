"""Records of an MCAP file: the size of its contents, its messages, and decompression that stops at the stated size.

rosbags opens a file and checks it. Its messages are read here, because a recording has a million of them.
"""

from __future__ import annotations

import struct
from binascii import crc32
from collections.abc import Callable, Collection, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, BinaryIO, NamedTuple

MAGIC = b"\x89MCAP0\r\n"
CHANNEL, MESSAGE, CHUNK, CHUNK_INDEX = 0x04, 0x05, 0x06, 0x08  # opcodes
SIZE_IN_CHUNK = 16  # [B], before the field uncompressed_size: two times
RECORD = struct.Struct("<BQ")  # opcode and length of a record
# Opcode, length, channel, sequence, times of reception and publication of a message; its data follow.
MESSAGE_HEAD = struct.Struct("<BQHIQQ")
CHUNK_HEAD = struct.Struct("<QQQI")  # first and last time, uncompressed size, checksum


class Received(NamedTuple):
    """Messages of one topic: times of reception [ns], and the serialised messages."""

    times: list[int]
    messages: list[bytes]


def contents(path: Path) -> int:
    """Return how large the chunks of an MCAP file say that they are when they are decompressed [B].

    Args:
        path: The file; of a broken one, what can be followed is counted.

    Raises:
        OSError: If it cannot be read.
    """
    with path.open("rb") as file:
        if file.read(len(MAGIC)) != MAGIC:
            return 0
        sizes = {CHUNK: 0, CHUNK_INDEX: 0}
        for opcode, record in _records(file):
            if opcode in sizes:
                sizes[opcode] += _uncompressed(opcode, record)
        return max(sizes.values())


def _records(file: BinaryIO) -> Iterator[tuple[int, bytes]]:
    """Yield the opcode of each record, with the contents of an index and the beginning of a chunk."""
    end = file.seek(0, 2)
    file.seek(len(MAGIC))
    while len(head := file.read(9)) == 9:
        opcode, length = head[0], int.from_bytes(head[1:], "little")
        start = file.tell()
        if length > end - start:
            return
        yield opcode, file.read(length if opcode == CHUNK_INDEX else min(length, SIZE_IN_CHUNK + 8))
        file.seek(start + length)


def _uncompressed(opcode: int, record: bytes) -> int:
    """Return the field uncompressed_size, which ends the record of an index [B]."""
    field = record[-8:] if opcode == CHUNK_INDEX else record[SIZE_IN_CHUNK : SIZE_IN_CHUNK + 8]
    return int(struct.unpack("<Q", field)[0]) if len(field) == 8 else 0


def messages(path: Path, topics: Collection[str]) -> dict[str, Received]:
    """Read the messages of some topics, in the order of the file.

    Args:
        path: An MCAP file that rosbags could open.
        topics: Names of the topics.

    Returns:
        The messages of each topic that has any.

    Raises:
        ValueError: If a chunk is damaged.
        OSError: If the file cannot be read.
    """
    found: dict[str, Received] = {}
    channels: dict[int, Received] = {}
    with path.open("rb") as file:
        end = file.seek(0, 2)
        at = len(MAGIC)
        while at + RECORD.size <= end:
            file.seek(at)
            head = file.read(RECORD.size)
            opcode, length = RECORD.unpack(head)
            if opcode in {CHANNEL, MESSAGE, CHUNK}:
                record = file.read(length)
                records = _decompressed(record, path.name) if opcode == CHUNK else head + record
                _take(records, topics, channels, found)
            at += RECORD.size + length
    return found


def _take(
    records: bytes, topics: Collection[str], channels: dict[int, Received], found: dict[str, Received]
) -> None:
    """Append the messages in some records to those found; channels are kept by their number."""
    at, end = 0, len(records)
    records += bytes(MESSAGE_HEAD.size)  # so that the head of a short last record can be unpacked
    unpack, head = MESSAGE_HEAD.unpack_from, MESSAGE_HEAD.size
    while at < end:
        opcode, length, channel, _, received, _ = unpack(records, at)
        stop = at + RECORD.size + length
        if opcode == MESSAGE and channel in channels:
            channels[channel].times.append(received)
            channels[channel].messages.append(records[at + head : stop])
        elif opcode == CHANNEL:
            number, _, size = struct.unpack_from("<HHI", records, at + RECORD.size)
            name = records[at + RECORD.size + 8 : at + RECORD.size + 8 + size].decode()
            if name in topics:
                channels[number] = found.setdefault(name, Received([], []))
        at = stop


def _decompressed(chunk: bytes, source: str) -> bytes:
    """Return the records of a chunk, no more of them than it states."""
    _, _, size, checksum = CHUNK_HEAD.unpack_from(chunk)
    at = CHUNK_HEAD.size
    (length,) = struct.unpack_from("<I", chunk, at)
    kind = chunk[at + 4 : at + 4 + length].decode()
    data = chunk[at + 4 + length + 8 :]
    decompress = _decompressors().get(kind)
    if decompress is None:
        raise ValueError(f"{source}: a chunk is compressed by '{kind}'")
    records = decompress(data, size)
    if len(records) != size or (checksum and crc32(records) != checksum):
        raise ValueError(f"{source}: a chunk is damaged")
    return records


def _decompressors() -> dict[str, Callable[[bytes, int], bytes]]:
    """Return what decompresses a chunk to its stated size and at most one byte more."""
    from lz4.frame import LZ4FrameDecompressor
    from rosbags.rosbag2 import storage_mcap

    zstd: Any = vars(storage_mcap)["zstd"]  # of the standard library or its backport, as Python has it
    return {
        "": lambda data, _: data,
        "lz4": lambda data, size: bytes(LZ4FrameDecompressor().decompress(data, max_length=size + 1)),
        "zstd": lambda data, size: bytes(zstd.ZstdDecompressor().decompress(data, size + 1)),
    }


@contextmanager
def bounded_decompression() -> Iterator[None]:
    """Let rosbags decompress no more of a chunk than its stated size, whatever the chunk holds."""
    from rosbags.rosbag2 import storage_mcap

    known: dict[str, Callable[[bytes, int], bytes]] | None = getattr(storage_mcap, "DECOMPRESSORS", None)
    if known is None:  # another version of rosbags
        yield
        return
    before = dict(known)
    known.update(_decompressors())
    try:
        yield
    finally:
        known.update(before)
