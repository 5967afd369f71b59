"""Identifiability: which effects logs can tell apart, and which motion would."""

from cdia_pin.identifiability.confusion import Confusion

__all__ = ["Confusion"]
