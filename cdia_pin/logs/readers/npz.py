"""Reader of NumPy archives: one key per column, or arrays (N, n) with the joint names."""

from __future__ import annotations

import io
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdia_pin.decoding import decoding
from cdia_pin.errors import LogError
from cdia_pin.logs.columns import signal_of_all
from cdia_pin.logs.readers.bounds import require_bounded
from cdia_pin.logs.readers.table import Table

ZIP, ARRAY = b"PK", b"\x93NUMPY"  # with which files of these kinds begin
_JOINT_KEYS = ("joints", "joint_names", "names", "name")


def read_npz(data: bytes, source: str) -> Table:
    """Read an ``.npz`` archive; pickled objects are refused.

    Keys may be column names, or ``time`` (N,), ``position``, ``velocity``, ``effort`` or
    ``current`` (N, n) and ``joints`` (n,). Without ``joints`` the columns are numbered.

    Args:
        data: Bytes of the file.
        source: Its name, for messages.

    Returns:
        The columns as numbers.

    Raises:
        LogError: If the bytes are not such an archive.
    """
    arrays = _arrays(data, source)
    joints = next((_names(arrays[k], k, source) for k in _JOINT_KEYS if k in arrays), None)
    columns: dict[str, NDArray[Any]] = {}
    not_numbers: dict[str, str] = {}
    for key, array in arrays.items():
        if array.dtype.kind not in "fiu":
            if key not in _JOINT_KEYS:
                not_numbers[key] = f"an array of {array.dtype}"
        elif array.ndim == 1:
            columns[key] = array.astype(np.int64) if array.dtype.kind == "u" else array
        elif array.ndim == 2 and (signal := signal_of_all(key)) is not None:
            labels = joints if joints is not None else [str(k) for k in range(array.shape[1])]
            if len(labels) != array.shape[1]:
                raise LogError(
                    f"{source}: {key} has shape {array.shape}, expected (N, {len(labels)}) for the joints "
                    f"{', '.join(map(str, labels))}"
                )
            columns.update({f"{signal}.{label}": array[:, k] for k, label in enumerate(labels)})
        else:
            not_numbers[key] = f"an array of shape {array.shape}"
    lengths = {name: len(column) for name, column in columns.items()}
    if len(set(lengths.values())) > 1:
        said = ", ".join(f"{name} {count}" for name, count in list(lengths.items())[:8])
        raise LogError(f"{source}: the arrays have different lengths: {said}")
    return Table(columns, not_numbers)


def _names(array: NDArray[Any], key: str, source: str) -> list[str]:
    if array.ndim != 1 or array.dtype.kind not in "US":
        raise LogError(
            f"{source}: {key} must be a list of names, found an array of {array.dtype}, shape {array.shape}"
        )
    if array.dtype.kind == "U":
        return [str(name) for name in array]
    try:
        return [bytes(name).decode() for name in array]
    except UnicodeDecodeError:
        raise LogError(f"{source}: {key} must be names in UTF-8") from None


def _arrays(data: bytes, source: str) -> dict[str, NDArray[Any]]:
    if not data.startswith((ZIP, ARRAY)):  # NumPy would take it for pickled objects, and advise to load them
        raise LogError(f"{source}: not readable as .npz (it is no zip archive)")
    with decoding(lambda said: LogError(f"{source}: not readable as .npz ({said})")):
        loaded = np.load(io.BytesIO(data), allow_pickle=False)
        if not isinstance(loaded, np.lib.npyio.NpzFile):
            raise LogError(f"{source}: one bare array, expected an .npz archive with named arrays")
        with loaded as archive:
            entries = archive.zip.infolist() if archive.zip is not None else []
            require_bounded(sum(int(entry.file_size) for entry in entries), len(data), source)
            return {key: archive[key] for key in archive.files}
