"""A model in the formats of simulators and controllers, and what each format cannot hold."""

from __future__ import annotations

from cdia_pin.exports.formats import FORMATS, TextFormat, first_format
from cdia_pin.exports.ranges import RangeRecord, RangesDocument, ranges_document
from cdia_pin.exports.torque_left_out import torque_left_out

__all__ = [
    "FORMATS",
    "RangeRecord",
    "RangesDocument",
    "TextFormat",
    "first_format",
    "ranges_document",
    "torque_left_out",
]
