"""Reading a log takes memory and time in proportion to its file, whatever the file holds."""

import io
import json
import os
import struct
import time

import numpy as np
import pyarrow as pa
import pytest
from pyarrow import parquet

from cdia_pin.errors import LogError
from cdia_pin.logs import read_log
from cdia_pin.logs.readers.bounds import ALWAYS
from cdia_pin.robot import load_robot

ROWS = 20_000_000


@pytest.fixture(scope="module")
def pendulum():
    return load_robot("double_pendulum")


def refused(robot, file, said: str, seconds: float = 10.0) -> None:
    start = time.process_time()
    with pytest.raises(LogError, match=said) as error:
        read_log(file, robot)
    assert len(str(error.value)) < 2000
    assert time.process_time() - start < seconds


def test_an_archive_of_zeros_is_not_unpacked(pendulum, tmp_path):
    import zipfile

    header = io.BytesIO()
    np.lib.format.write_array_header_1_0(header, {"descr": "<f8", "fortran_order": False, "shape": (ROWS,)})
    with zipfile.ZipFile(tmp_path / "bomb.npz", "w", zipfile.ZIP_DEFLATED) as archive:
        for name in ("time", "position.joint1"):
            with archive.open(f"{name}.npy", "w") as file:
                file.write(header.getvalue())
                for _ in range(ROWS // 10**6):
                    file.write(bytes(8 * 10**6))
    refused(pendulum, tmp_path / "bomb.npz", "decompressed")


def test_a_parquet_file_of_one_value_is_not_unpacked(pendulum, tmp_path):
    column = pa.DictionaryArray.from_arrays(pa.array(np.zeros(10**6, np.int8)), pa.array([0.0]))
    table = pa.table({f"position.joint{k}": pa.chunked_array([column] * 20) for k in (1, 2)})
    parquet.write_table(table, tmp_path / "bomb.parquet", compression="zstd")
    assert (tmp_path / "bomb.parquet").stat().st_size < 10**6
    refused(pendulum, tmp_path / "bomb.parquet", "decompressed")


def test_vectors_of_one_value_are_not_unpacked_and_files_count_together(pendulum, tmp_path):
    rows = 500_000
    vector = {"dtype": "float32", "shape": [10], "names": None}
    (tmp_path / "meta").mkdir()
    (tmp_path / "meta" / "info.json").write_text(json.dumps({"features": {"observation.state": vector}}))
    (tmp_path / "data").mkdir()
    zeros = pa.FixedSizeListArray.from_arrays(pa.array(np.zeros(10 * rows)), 10)
    columns = {"timestamp": np.zeros(rows), "episode_index": np.zeros(rows, np.int64)}
    for name in ("a", "b"):
        table = pa.table({**columns, "observation.state": zeros})
        parquet.write_table(table, tmp_path / "data" / f"{name}.parquet", compression="zstd")
    assert ALWAYS / 2 < 96 * rows < ALWAYS  # each file by itself is small enough
    refused(pendulum, tmp_path, "decompressed")


def record(opcode: int, content: bytes) -> bytes:
    return struct.pack("<BQ", opcode, len(content)) + content


def text(value: str) -> bytes:
    return struct.pack("<I", len(value)) + value.encode()


def mcap(compressed: bytes, says: int, compression: str = "zstd") -> bytes:
    """An MCAP file of one chunk that says how large it becomes."""
    chunk = (
        struct.pack("<QQQI", 0, 10**9, says, 0)
        + text(compression)
        + struct.pack("<Q", len(compressed))
        + compressed
    )
    magic = b"\x89MCAP0\r\n"
    schema = struct.pack("<H", 1) + text("sensor_msgs/msg/JointState") + text("ros2msg") + text("")
    channel = struct.pack("<HH", 1, 1) + text("/joint_states") + text("cdr") + struct.pack("<I", 0)
    parts = [record(1, text("ros2") + text("")), record(3, schema), record(4, channel), record(6, chunk)]
    return b"".join([magic, *parts, record(2, bytes(20)), magic])


@pytest.mark.parametrize("says", [600 * 2**20, 2**62, 1000])
@pytest.mark.parametrize("compression", ["zstd", "lz4"])
def test_a_chunk_that_becomes_huge_is_not_unpacked(pendulum, tmp_path, says, compression):
    import resource

    lz4 = pytest.importorskip("lz4.frame")
    storage = pytest.importorskip("rosbags.rosbag2.storage_mcap")
    compress = lz4.compress if compression == "lz4" else storage.zstd.compress
    content = compress(bytes(600 * 2**20))
    (tmp_path / "bomb.mcap").write_bytes(mcap(content, says, compression))
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    refused(pendulum, tmp_path / "bomb.mcap", "decompressed|not readable")
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 200_000  # [kB]


@pytest.mark.parametrize(
    ("name", "metadata"),
    [("bag_0.db3.zstd", None), ("bag_0.db3.zstd", "version: 5"), ("bag_0.db3", 'compression_mode: "FILE"')],
)
def test_a_bag_that_is_compressed_as_a_whole_is_not_unpacked(pendulum, tmp_path, name, metadata):
    (tmp_path / name).write_bytes(b"x")
    if metadata:
        (tmp_path / "metadata.yaml").write_text(metadata)
    refused(pendulum, tmp_path, "decompress it first")
    if name.endswith("zstd"):
        refused(pendulum, tmp_path / name, "decompress it first")


@pytest.mark.parametrize("name", ["position.x{}", "position.j{}", "c{}", "x{}_joint1", "position.{}joint1"])
def test_very_many_columns_take_time_in_proportion(pendulum, tmp_path, name):
    count = 20_000
    columns = ["time", *(name.format(k) for k in range(count))]
    rows = [f"{0.01 * k:g}" + ",0" * count for k in range(3)]
    (tmp_path / "wide.csv").write_text("\n".join([",".join(columns), *rows]) + "\n")
    refused(pendulum, tmp_path / "wide.csv", "position", 10.0)


def test_a_name_of_very_many_digits_and_a_row_of_very_many_blanks_take_no_time(pendulum, tmp_path):
    (tmp_path / "long.csv").write_text(f"time,position.{'1' * 200_000}x,effort.joint1\n0,1,2\n1,2,3\n")
    refused(pendulum, tmp_path / "long.csv", "position", 5.0)
    blanks = " " * 300_000
    (tmp_path / "blank.csv").write_text(f"time position.joint1{blanks}effort.joint1\n0 1{blanks}2\n1 2 3\n")
    refused(pendulum, tmp_path / "blank.csv", "position", 5.0)


def test_pipes_and_devices_are_refused(pendulum, tmp_path):
    os.mkfifo(tmp_path / "pipe.csv")
    refused(pendulum, tmp_path / "pipe.csv", "pipe or a device")
    (tmp_path / "zero.csv").symlink_to("/dev/zero")
    refused(pendulum, tmp_path / "zero.csv", "pipe or a device")
