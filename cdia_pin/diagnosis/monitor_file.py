"""The file of a monitor in mid-run: a zip archive of JSON and arrays, which holds all that it has learned and believes.

``monitor.json`` is text; each array beside it is a ``.npy`` file, so that NumPy opens the whole as ``.npz``.
"""

from __future__ import annotations

import json
import zipfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, fields
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cdia_pin import schemas
from cdia_pin.decoding import decoding
from cdia_pin.diagnosis.bank import Bank
from cdia_pin.diagnosis.engine_interface import Engine
from cdia_pin.diagnosis.engines import ENGINES, Knowledge
from cdia_pin.diagnosis.monitor_record import MonitorRecord
from cdia_pin.diagnosis.monitor_settings import MonitorSettings
from cdia_pin.diagnosis.sample_bounds import SampleBounds
from cdia_pin.diagnosis.state_codec import StateReader, StateWriter
from cdia_pin.diagnosis.stateful import Stateful
from cdia_pin.dynamics.dynamics import Dynamics
from cdia_pin.dynamics.model_file import model_document, model_from_document
from cdia_pin.effects import Term
from cdia_pin.errors import CdiaError, EffectError, ModelError
from cdia_pin.input_files import LARGEST, require_small_file
from cdia_pin.robot.model import RobotModel
from cdia_pin.version import __version__
from cdia_pin.whole_files import whole_file

if TYPE_CHECKING:
    from cdia_pin.diagnosis.thesis import ThesisSettings

Array = NDArray[np.float64]

TEXT = "monitor.json"
PROBE = 0.3  # [rad or m, and per s], of all joints, where the rigid bodies of two arms are compared
SAME = 1e-9  # [1], relative difference that rounding leaves between the same bodies on two machines


@dataclass(frozen=True)
class MonitorParts:
    """What a monitor is made of once it has learned: enough to make it again without its healthy runs.

    Attributes:
        model: The healthy arm as it was given.
        bank: Known effects.
        settings: Settings of the engine.
        rate: Ticks per second [Hz]; None if it was not given.
        has_velocity: Whether velocities are measured.
        bounds: What samples can be.
        learned: What the engine has learned.
        record: The monitor's record.
    """

    model: Dynamics
    bank: Bank
    settings: MonitorSettings | ThesisSettings
    rate: float | None
    has_velocity: bool
    bounds: SampleBounds
    learned: Any
    record: MonitorRecord

    def engine(self) -> Engine:
        """Make the engine again."""
        known = Knowledge(rate=self.rate, position_only=not self.has_velocity, learned=self.learned)
        return ENGINES[self.record["engine"]](self.model, self.bank, self.settings, known)[0]


def write_monitor(path: str | Path, parts: MonitorParts, state: Stateful) -> Path:
    """Write a monitor; see `Monitor.save`.

    Args:
        path: File to write.
        parts: What it is made of.
        state: Its engine with all around it.
    """
    robot = parts.model.robot
    entries = zip(parts.bank.prototypes, parts.bank.profiles, strict=True)
    bank = [Term(effect, (0.0,) * effect.size, profile) for effect, profile in entries]
    for term in (*parts.model.terms, *bank):
        _require_name(term, robot)
    writer = StateWriter(robot)
    held = [
        f.name for f in fields(parts) if f.name not in ("model", "bank")
    ]  # those have an entry of their own
    document = {
        "schema": schemas.MONITOR,
        "version": __version__,
        "model": writer.value(dict(model_document(parts.model)), "model"),
        "bodies": writer.value(_bodies(robot), "bodies"),
        "bank": writer.value(tuple(bank), "bank"),
        "parts": {name: writer.value(getattr(parts, name), name) for name in held},
        "state": writer.part(state, "state"),
    }
    text = json.dumps(document, indent=1, allow_nan=False)
    try:
        with whole_file(path) as file, zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive:
            archive.writestr(TEXT, text)
            for name, array in writer.arrays.items():
                member = BytesIO()
                np.lib.format.write_array(member, np.asarray(array, order="C"), allow_pickle=False)
                archive.writestr(f"{name}.npy", member.getvalue())
    except OSError as error:
        raise ModelError(f"cannot write the monitor to {path}: {error.strerror}") from None
    return Path(path)


@dataclass(frozen=True)
class StoredMonitor:
    """A monitor as a file holds it.

    Attributes:
        parts: What it is made of.
    """

    parts: MonitorParts
    _reader: StateReader
    _state: Mapping[str, Any]

    def restore(self, state: Stateful) -> None:
        """Give a new monitor the stored state.

        Args:
            state: Its engine with all around it, at the start.
        """
        self._reader.part(state, self._state)


@contextmanager
def reading(path: str | Path, robot: RobotModel) -> Iterator[StoredMonitor]:
    """Give the monitor of a file; what is not valid in the file becomes one line, also within the block.

    Args:
        path: The file.
        robot: The arm.

    Yields:
        The stored monitor.

    Raises:
        ModelError: If it cannot be read, or belongs to another arm or version of the package.
    """
    path = Path(path)
    document, arrays = _read(path)
    _require_same_version(document, path)
    try:
        stored = StateReader(arrays, Dynamics(robot)).value(document["model"])
        model = model_from_document(stored, path, robot)
        reader = StateReader(arrays, model)
        _require_same_bodies(reader.value(document["bodies"]), path, robot)
        terms = reader.value(document["bank"])
        bank = Bank(robot, tuple(t.effect for t in terms), tuple(t.profile for t in terms))
        parts = {name: reader.value(value) for name, value in document["parts"].items()}
        yield StoredMonitor(MonitorParts(model, bank, **parts), reader, document["state"])
    except CdiaError as error:
        raise error if str(path) in str(error) else ModelError(f"{path}: {error}") from None
    except (KeyError, TypeError, AttributeError, ValueError, IndexError, AssertionError):
        raise ModelError(f"{path} is not a whole monitor: a value is missing or of another kind") from None


def _read(path: Path) -> tuple[dict[str, Any], dict[str, NDArray[Any]]]:
    """Return the text and the arrays of a file."""
    try:
        require_small_file(path)
        data = path.read_bytes()
    except OSError as error:
        raise ModelError(f"cannot read the monitor {path}: {error.strerror or error}") from None
    with (
        decoding(lambda said: ModelError(f"{path} is not a whole monitor: {said}")),
        zipfile.ZipFile(BytesIO(data)) as archive,
    ):
        if sum(member.file_size for member in archive.infolist()) > LARGEST:
            raise ValueError(f"more than {LARGEST / 1e6:.0f} MB")
        document = json.loads(archive.read(TEXT))
        arrays = {
            name.removesuffix(".npy"): np.load(BytesIO(archive.read(name)), allow_pickle=False)
            for name in archive.namelist()
            if name != TEXT
        }
    if not isinstance(document, dict) or document.get("schema") != schemas.MONITOR:
        given = document.get("schema") if isinstance(document, dict) else None
        raise ModelError(f"{path} is no monitor of the schema {schemas.MONITOR}, it is of {given!r}")
    return document, arrays


def _require_same_version(document: Mapping[str, Any], path: Path) -> None:
    if document.get("version") != __version__:
        raise ModelError(
            f"{path} was written by cdia-pin {document.get('version')}, this is {__version__}, which may decide "
            "otherwise: let the monitor learn from the healthy runs again"
        )


def _bodies(robot: RobotModel) -> tuple[Array, ...]:
    """Return what tells the rigid bodies and frames of one arm from those of another."""
    q = v = np.full(robot.n, PROBE)
    M, nle = (np.array(x) for x in robot.rigid_terms(q, v))
    return M, nle, robot.link_end_jacobians(q)


def _require_same_bodies(stored: tuple[Array, ...], path: Path, robot: RobotModel) -> None:
    for a, b in zip(stored, _bodies(robot), strict=True):
        if a.shape != b.shape or not np.allclose(a, b, rtol=0.0, atol=SAME * float(np.abs(b).max())):
            raise ModelError(
                f"{path} was written for an arm '{robot.name}' with other masses, lengths or gravity: give the same "
                "description, or let the monitor learn from the healthy runs again"
            )


def _require_name(term: Term, robot: RobotModel) -> None:
    """Refuse an effect that cannot be read back by its name."""
    try:
        same = Term.from_dict(term.to_dict(robot)) == term
    except EffectError:
        same = False
    if not same:
        raise ModelError(
            f"a monitor with the effect {term.label} cannot be stored: its class has no name in the vocabulary; "
            "name it with effects.register"
        )
