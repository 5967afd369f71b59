"""Size of the contents of an MCAP file, from its records, and decompression that stops at the stated size."""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

MAGIC = b"\x89MCAP0\r\n"
CHUNK, CHUNK_INDEX = 0x06, 0x08  # opcodes
SIZE_IN_CHUNK = 16  # [B], before the field uncompressed_size: two times


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


@contextmanager
def bounded_decompression() -> Iterator[None]:
    """Let rosbags decompress no more of a chunk than its stated size, whatever the chunk holds."""
    from rosbags.rosbag2 import storage_mcap

    known: dict[str, Callable[[bytes, int], bytes]] | None = getattr(storage_mcap, "DECOMPRESSORS", None)
    zstd = getattr(storage_mcap, "zstd", None)
    if known is None or zstd is None:  # another version of rosbags
        yield
        return
    from lz4.frame import LZ4FrameDecompressor

    before = dict(known)
    known["lz4"] = lambda data, size: bytes(LZ4FrameDecompressor().decompress(data, max_length=size + 1))
    known["zstd"] = lambda data, size: bytes(zstd.ZstdDecompressor().decompress(data, size + 1))
    try:
        yield
    finally:
        known.update(before)
