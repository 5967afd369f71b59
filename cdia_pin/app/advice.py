"""An advice of a check in the words of the page, which has buttons where the command line has options."""

from __future__ import annotations

import re

from cdia_pin.logs.conversion import CURRENTS

CONVERSION = re.compile(r"--convert (\w+=[\w,.:]+)")
ROBOT = re.compile(r"--robot ([\w-]+)")
ASIDE = re.compile(
    r"(?::| \() ?--(?:convert|gains|robot) [^;)]*\)?"
)  # an option behind words that say what it does
GAINS = re.compile(r" --gains \S+")
SAID = {
    "angle": "read angles in {}",
    "length": "read lengths in {}",
    "torque": "read torques in {}",
    "time": "read times in {}",
    "rate": "count rows at {} Hz",
    "flip_position": "flip the position of {}",
    "flip_velocity": "flip the velocity of {}",
    "flip_effort": "flip the torque of {}",
    "use_velocity": "leave out the recorded velocities",
    "gravity": "adding gravity to efforts without it",
    "reduction": "apply the gear ratios {}",
}  # what each conversion does


def conversion_words(option: str) -> str:
    """Return what a conversion does: ``angle=deg`` is ``read angles in deg``.

    Args:
        option: As an advice of `check_log` names it.
    """
    key, _, value = option.partition("=")
    if key == "torque" and value in CURRENTS:
        unit = "" if value == "A" else f" in {value}"
        return f"read torques as motor currents{unit}, with drive gains"
    return SAID[key].format(value.replace(",", ", ")) if key in SAID else option


def advice_words(advice: str) -> str:
    """Return an advice without options of the command line.

    Args:
        advice: Of a finding, or a sentence that holds one.
    """
    plain = GAINS.sub("", ASIDE.sub("", advice))
    plain = CONVERSION.sub(lambda found: conversion_words(found[1]), plain)
    return ROBOT.sub(r"choose the robot \1", plain)
