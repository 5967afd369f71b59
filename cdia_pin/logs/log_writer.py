"""Writer of logs in the project's dialect; reading such a file gives the same numbers."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cdia_pin.errors import LogError
from cdia_pin.logs.log import Log
from cdia_pin.phrases import printable
from cdia_pin.whole_files import whole_file

Array = NDArray[np.float64]

SEPARATES = frozenset(",;\"'# ")  # in a name, it needs quotes
WRITABLE = (".csv", ".parquet", ".npz")
"""Suffixes of the formats that can be written."""


def write_log(log: Log, path: str | Path) -> Path:
    """Write a log as CSV, Parquet or npz, according to the suffix.

    Numbers are written with all digits. The log's notes and source are not written.

    Args:
        log: The log [SI units].
        path: File to write; an existing one is replaced.

    Returns:
        The path that was written.

    Raises:
        LogError: If the suffix is unknown, the file cannot be written, or CSV cannot hold the name of a joint.
    """
    path = Path(path)
    suffix = path.suffix.lower()
    if suffix not in WRITABLE:
        raise LogError(
            f"{path.name}: cannot write a log as '{suffix or 'no suffix'}'; known: {', '.join(WRITABLE)}"
        )
    try:
        if suffix == ".npz":
            _write_npz(log, path)
        else:
            _write_arrow(log, path, suffix)
    except OSError as error:
        raise LogError(f"{path}: cannot be written ({error.strerror or error})") from None
    return path


def columns_of(log: Log) -> dict[str, Array]:
    """Return a log as named columns.

    Args:
        log: The log [SI units].

    Returns:
        ``time``, then ``<signal>.<joint>``, each of shape (N,).
    """
    columns = {"time": log.time}
    signals = {
        "position": log.position,
        "velocity": log.velocity,
        "effort": log.effort,
        "temperature": log.temperature,
    }
    for signal, values in signals.items():
        if values is not None:
            columns.update({f"{signal}.{joint}": values[:, k] for k, joint in enumerate(log.joints)})
    return columns


def _write_arrow(log: Log, path: Path, suffix: str) -> None:
    import pyarrow as pa

    table = pa.table(columns_of(log))
    if suffix == ".parquet":
        from pyarrow import parquet

        with whole_file(path) as file:
            parquet.write_table(table, file)
        return
    from pyarrow import csv

    header = _header(table.column_names, path.name)
    with whole_file(path) as file:
        file.write(header)  # pyarrow would put all names in quotes
        csv.write_csv(table, file, csv.WriteOptions(include_header=False))


def _header(names: list[str], source: str) -> bytes:
    """Return the line of names; those that hold what separates columns are in quotes."""
    for name in names:
        if name != printable(name).strip():
            raise LogError(
                f"{source}: CSV cannot hold the name '{printable(name)}', with blanks at its end or characters that "
                "cannot be printed; write .parquet or .npz"
            )
    quoted = ['"' + n.replace('"', '""') + '"' if SEPARATES & set(n) else n for n in names]
    return (",".join(quoted) + "\n").encode()


def _write_npz(log: Log, path: Path) -> None:
    signals = {"position": log.position, "effort": log.effort}
    if log.velocity is not None:
        signals["velocity"] = log.velocity
    if log.temperature is not None:
        signals["temperature"] = log.temperature
    with whole_file(path) as file:
        np.savez_compressed(file, allow_pickle=False, time=log.time, joints=np.array(log.joints), **signals)
