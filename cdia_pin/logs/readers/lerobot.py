"""Reader of LeRobot datasets: vectors of several episodes in Parquet files, their names in ``meta/info.json``."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cdia_pin.decoding import decoding
from cdia_pin.errors import LogError
from cdia_pin.input_files import read_text, resolved
from cdia_pin.logs.readers.bounds import parquet_contents, require_bounded
from cdia_pin.logs.readers.checksum import sha256_of
from cdia_pin.logs.readers.table import Table

if TYPE_CHECKING:
    from pyarrow import parquet

INFO = Path("meta/info.json")
TIME, EPISODE = "timestamp", "episode_index"
OBSERVED = "observation."  # before the names of measured features
NUMBERS = ("float32", "float64")  # data types of features that may be signals; pictures are others
DEPTH = 4  # folders from a data file up to its dataset


def dataset_of(path: Path) -> Path | None:
    """Find the dataset that a path belongs to.

    Args:
        path: A folder, or a file in it.

    Returns:
        The folder of the dataset; None if there is none.
    """
    folders = [path] if path.is_dir() else resolved(path).parents[:DEPTH]
    return next((folder for folder in folders if (folder / INFO).is_file()), None)


def read_lerobot(path: Path, episode: int | None) -> tuple[Table, str]:
    """Read one episode of a LeRobot dataset.

    Args:
        path: Folder of the dataset, or one of its data files.
        episode: Number of the episode; None if there is only one.

    Returns:
        Columns ``timestamp`` [s] and ``<feature>.<name>``, and the SHA-256 of the files that were read.

    Raises:
        LogError: If it is no such dataset, or the episode is not in it.
    """
    folder = dataset_of(path)
    if folder is None:
        raise LogError(f"{path}: no {INFO} there or above, so not a LeRobot dataset")
    features = _features(folder)
    files = [path] if path.is_file() else sorted(folder.glob("data/**/*.parquet"))
    if not files:
        raise LogError(f"{path}: a LeRobot dataset without data/…/*.parquet")
    parts = [_part(file, (TIME, *features)) for file in files]
    number = _one_of(sorted({int(k) for part in parts for k in np.unique(part.episodes)}), episode, path.name)
    parts = [part for part in parts if (part.episodes == number).any()]
    require_bounded(
        sum(part.contents for part in parts), sum(part.file.stat().st_size for part in parts), path.name
    )
    read = [part.read((TIME, *features), number) for part in parts]
    columns: dict[str, NDArray[Any]] = {}
    for feature in (TIME, *features):
        values = np.concatenate([each[feature] for each in read])
        if feature == TIME:
            columns[TIME] = values.astype(np.float64).ravel()
            continue
        if values.shape[1] != len(features[feature]):
            raise LogError(
                f"{path.name}: {feature} has {values.shape[1]} values, {INFO} names {len(features[feature])}"
            )
        columns.update({f"{feature}.{n}": values[:, k] for k, n in enumerate(features[feature])})
    digest = sha256_of([folder / INFO, *(part.file for part in parts)])
    notes = (f"episode {number} of a LeRobot dataset read",)
    return Table(columns, time_unit="s", notes=notes, format="lerobot"), digest


def _features(folder: Path) -> dict[str, list[str]]:
    """Return the names of the values of each measured vector."""
    where = folder / INFO
    with decoding(lambda said: LogError(f"{where}: not the information of a LeRobot dataset ({said})")):
        features = json.loads(read_text(where))["features"]
        measured = {
            name: _names(feature)
            for name, feature in features.items()
            if name.startswith(OBSERVED) and feature["dtype"] in NUMBERS and len(feature["shape"]) == 1
        }
    if not measured:
        raise LogError(f"{where}: no vector of numbers named {OBSERVED}…; found {', '.join(features)}")
    return measured


def _names(feature: Mapping[str, Any]) -> list[str]:
    """Return the names of a vector: a list, a list under one key, or numbers where there are none."""
    names = feature.get("names")
    if isinstance(names, Mapping):
        names = next(iter(names.values()), None)
    count = int(feature["shape"][0])
    if not isinstance(names, list) or len(names) != count:
        return [str(k) for k in range(count)]
    return [str(name) for name in names]


def _one_of(known: Sequence[int], asked: int | None, source: str) -> int:
    if asked is None and len(known) == 1:
        return known[0]
    if asked in known:
        return int(asked or 0)
    which = f"holds {len(known)} episodes, {known[0]} to {known[-1]}" if known else "holds no episode"
    why = "they are separate recordings" if asked is None else f"{asked} is none of them"
    raise LogError(f"{source}: {which}; {why}: choose one with --episode N")


@dataclass(frozen=True)
class _Part:
    """A data file: the episode of each of its rows, and the size of what may be read of it [B]."""

    file: Path
    episodes: NDArray[np.int64]
    contents: int

    def read(self, names: Sequence[str], number: int) -> dict[str, NDArray[Any]]:
        """Return the rows of one episode of some columns."""
        with _opened(self.file) as opened:
            return {name: _column(opened, name, self.file.name)[self.episodes == number] for name in names}


def _part(file: Path, names: Sequence[str]) -> _Part:
    """Look at a data file that must have some columns."""
    with _opened(file) as opened:
        missing = [name for name in (EPISODE, *names) if name not in opened.schema_arrow.names]
        if missing:
            raise LogError(f"{file.name}: no column {', '.join(missing)}, which {INFO} names")
        contents = parquet_contents(opened.metadata, (EPISODE, *names))
        require_bounded(contents, file.stat().st_size, file.name)
        return _Part(file, _column(opened, EPISODE, file.name).astype(np.int64).ravel(), contents)


def _opened(file: Path) -> parquet.ParquetFile:
    from pyarrow import parquet

    with decoding(lambda said: LogError(f"{file.name}: not readable as Parquet ({said})")):
        return parquet.ParquetFile(file)


def _column(file: parquet.ParquetFile, name: str, source: str) -> NDArray[Any]:
    """Return a column of numbers or of vectors, shape (N, k)."""
    import pyarrow as pa

    with decoding(lambda said: LogError(f"{source}: {name} cannot be read ({said})")):
        column = file.read(columns=[name])[name].combine_chunks()
        count = len(column)
        if (
            pa.types.is_list(column.type)
            or pa.types.is_fixed_size_list(column.type)
            or pa.types.is_large_list(column.type)
        ):
            column = column.flatten()
        return np.asarray(column.to_numpy(zero_copy_only=False)).reshape(count, -1 if count else 1)
