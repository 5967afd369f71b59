"""Conditioned motions inside a JSON file, so that a model remembers the logs that it was learned from."""

from __future__ import annotations

import base64
from io import BytesIO
from typing import Any, NotRequired, TypedDict

import numpy as np

from cdia_pin.decoding import decoding
from cdia_pin.errors import LogError
from cdia_pin.logs.motion import Motion, MotionRecord
from cdia_pin.logs.torque_side import TorqueSide

MOST_SAMPLES = 60_000  # samples of a motion that are kept [1], ten minutes at 100 Hz: about 4 MB
LARGEST = 64 * 2**20  # bytes of one array after decompression [B]; a larger one is refused
SIGNALS = ("q", "v", "a", "effort")
OF_JOINTS = ("speed_noise", "acceleration_noise", "effort_step")
MAY_LACK = ("temperature", "effort_tolerance")


class MotionDocument(TypedDict):
    """A motion in JSON.

    Attributes:
        record: Record of its conditioning.
        joints: Joint names.
        start: Time of the first sample [s].
        rate: Samples per second [Hz].
        cutoff: Cut-off of the filter [Hz].
        decimation: Samples per compared torque [1].
        torque_side: Side of the gear on which the torque was measured.
        side_of_format: True where the format alone says so.
        stretches: Time of the first sample [s] and number of samples of each stretch of a long log.
        arrays: Signals in SI units, 32-bit floats: a compressed npz file in base64.
    """

    record: MotionRecord
    joints: list[str]
    start: float
    rate: float
    cutoff: float
    decimation: int
    torque_side: str
    side_of_format: NotRequired[bool]
    stretches: NotRequired[list[tuple[float, int]]]
    arrays: str


def motion_document(motion: Motion) -> MotionDocument:
    """Return a motion for JSON; of a very long one its beginning.

    Args:
        motion: The conditioned log.
    """
    kept = {name: getattr(motion, name)[:MOST_SAMPLES] for name in SIGNALS}
    kept |= {name: getattr(motion, name) for name in OF_JOINTS}
    known = {name: getattr(motion, name) for name in MAY_LACK}
    kept |= {name: x[:MOST_SAMPLES] for name, x in known.items() if x is not None}
    file = BytesIO()
    arrays: dict[str, Any] = {name: np.asarray(x, np.float32) for name, x in kept.items()}
    np.savez_compressed(file, **arrays)
    document: MotionDocument = {
        "record": motion.record,
        "joints": list(motion.joints),
        "start": float(motion.time[0]),
        "rate": float(motion.rate),
        "cutoff": float(motion.cutoff),
        "decimation": int(motion.decimation),
        "torque_side": str(motion.torque_side),
        "arrays": base64.b64encode(file.getvalue()).decode("ascii"),
    }
    if motion.side_of_format:
        document["side_of_format"] = True
    if motion.stretches:
        firsts = motion.time[np.cumsum([0, *motion.stretches[:-1]])].tolist()
        document["stretches"] = list(zip(firsts, _within(motion.stretches, MOST_SAMPLES), strict=False))
    return document


def _within(lengths: tuple[int, ...], most: int) -> list[int]:
    """Return the lengths of stretches of which so many samples are kept, from the first on."""
    ends = np.minimum(np.cumsum(lengths), most)
    return [int(length) for length in np.diff(ends, prepend=0) if length]


def motion_from(document: Any) -> Motion:
    """Return a motion from JSON.

    Args:
        document: What `motion_document` returned.

    Raises:
        LogError: If it is not a motion.
    """
    refusal = LogError("a log that it was learned from is not written as a model file has it")
    with decoding(lambda _: refusal):
        rate, joints = float(document["rate"]), tuple(map(str, document["joints"]))
        with np.load(
            BytesIO(base64.b64decode(document["arrays"], validate=True)), allow_pickle=False
        ) as file:
            sizes = [i.file_size for i in file.zip.infolist()]
            if max(sizes) > LARGEST:
                raise LogError(f"a motion of {max(sizes)} bytes is too large")
            needed = (*SIGNALS, *OF_JOINTS, *(name for name in MAY_LACK if name in file))
            arrays: dict[str, Any] = {name: np.asarray(file[name], float) for name in needed}
        count = len(arrays["q"])
        shapes = {arrays[name].shape for name in SIGNALS} | {(count, *arrays[n].shape) for n in OF_JOINTS}
        if not 0 < rate < np.inf:
            raise LogError(f"a motion of {rate} samples per second")
        if shapes != {(count, len(joints))} or not all(np.isfinite(x).all() for x in arrays.values()):
            raise LogError(
                f"arrays of shapes {sorted(map(str, shapes))} are no motion of {len(joints)} joints"
            )
        given = [(float(first), int(k)) for first, k in document.get("stretches", ())]
        parts = given or [(float(document["start"]), count)]
        if sum(k for _, k in parts) != count or min(k for _, k in parts) < 1:
            raise LogError(f"stretches of {[k for _, k in parts]} samples are no motion of {count}")
        motion = Motion(
            joints=joints,
            time=np.concatenate([first + np.arange(k) / rate for first, k in parts]),
            rate=rate,
            cutoff=float(document["cutoff"]),
            decimation=int(document["decimation"]),
            record=document["record"],
            torque_side=TorqueSide(document.get("torque_side", TorqueSide.UNKNOWN)),
            side_of_format=document.get("side_of_format", False) is True,
            stretches=tuple(k for _, k in given),
            **arrays,
        )
        first = float(motion.record.get("motion_cutoff", motion.cutoff))
        if not first >= motion.cutoff:
            raise LogError(f"a motion filtered at {first:g} Hz, below its {motion.cutoff:g} Hz")
        return motion
