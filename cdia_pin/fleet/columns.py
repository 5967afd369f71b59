"""The columns of a fleet's store, schema ``cdia-fleet/1``: one row per log, effect and parameter.

A log that failed, or in which nothing could be fitted, has one row without an effect.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    import pyarrow as pa

TIME: Final = "timestamp"  # in UTC, to the microsecond
TEXT, NUMBER, FLAG = "string", "double", "bool"

# Name → type, unit or empty, meaning.
COLUMNS: Final[Mapping[str, tuple[str, str, str]]] = {
    "robot": (TEXT, "", "name of the robot in the map"),
    "log": (TEXT, "", "name of the log's file"),
    "sha256": (TEXT, "", "hash of the log's bytes"),
    "setup": (TEXT, "", "hash of the robot's URDF, model, gains, options of reading and settings of the fit"),
    "recorded": (TIME, "", "when the log was recorded, UTC; empty if nothing says it"),
    "recorded_from": (TEXT, "", "where that is known from: map, log, name or absent"),
    "added": (TIME, "", "when the row was made, UTC"),
    "version": (TEXT, "", "version of cdia-pin that made the row"),
    "settings": (TEXT, "", "settings of the fit, JSON"),
    "failure": (TEXT, "", "why the log gave nothing; empty if it did"),
    "doubts": (TEXT, "", "problems that the check found, one sentence each, with '; ' between them"),
    "duration": (NUMBER, "s", "length of the log"),
    "cutoff": (NUMBER, "Hz", "cut-off of the filter"),
    "effect": (TEXT, "", "name of the effect"),
    "joints": (TEXT, "", "joints of the effect with '+' between them; empty for one of the whole arm"),
    "parameter": (TEXT, "", "name of the parameter"),
    "unit": (TEXT, "", "unit of the parameter"),
    "role": (TEXT, "", "model: a term of the model; usual: what every joint has; job: changes with the job; "
             "searched: looked for beside all others"),
    "model_value": (NUMBER, "unit", "the parameter in the model, zero where the model lacks the effect"),
    "value": (NUMBER, "unit", "the parameter in this log; empty if the log does not show it"),
    "ci95_low": (NUMBER, "unit", "95 % interval, statistical and systematic together"),
    "ci95_high": (NUMBER, "unit", "its upper end"),
    "ci95_statistical_low": (NUMBER, "unit", "95 % interval from the scatter of this log alone"),
    "ci95_statistical_high": (NUMBER, "unit", "its upper end"),
    "torque": (NUMBER, "N·m or N", "RMS torque of the difference from the model, on the joint where it is largest"),
    "named": (FLAG, "", "whether this log alone would name the effect; empty if it was not searched"),
    "not_shown": (TEXT, "", "why the log does not show the parameter; empty if it does"),
    "error": (NUMBER, "N·m or N", "RMS torque of the joint that the fit leaves"),
    "model_error": (NUMBER, "N·m or N", "RMS torque of the joint that the model leaves"),
    "temperature": (NUMBER, "°C", "mean temperature of the joint; empty if the log has none"),
    "load": (NUMBER, "N·m or N", "RMS torque of the joint in the model, with what changes with the job"),
    "moving": (NUMBER, "1", "share of the time in which the joint moves"),
    "speed": (NUMBER, "rad/s or m/s", "RMS speed of the joint"),
    "fastest": (NUMBER, "rad/s or m/s", "largest speed of the joint"),
    "reach": (NUMBER, "rad or m", "range of positions of the joint"),
}  # fmt: skip


def arrow_schema(metadata: Mapping[str, str]) -> pa.Schema:
    """Return the schema of Arrow.

    Args:
        metadata: Written into each file.
    """
    import pyarrow as pa

    types: dict[str, Any] = {
        TEXT: pa.string(),
        NUMBER: pa.float64(),
        FLAG: pa.bool_(),
        TIME: pa.timestamp("us", "UTC"),
    }
    fields = [
        pa.field(name, types[kind], metadata={"unit": unit, "meaning": meaning})
        for name, (kind, unit, meaning) in COLUMNS.items()
    ]
    return pa.schema(fields, metadata=dict(metadata))
