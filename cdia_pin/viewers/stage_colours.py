"""One colour for each stage, everywhere: those of Okabe and Ito, told apart by colour-blind people too."""

from __future__ import annotations

from cdia_pin.diagnosis.status import Stage

STAGE_COLOURS: dict[Stage, str] = {
    Stage.HEALTHY: "#009e73",  # bluish green
    Stage.SUSPECT: "#f0e442",  # yellow
    Stage.DETECTED: "#d55e00",  # vermilion
    Stage.ISOLATED: "#cc79a7",  # reddish purple
    Stage.ACCOMMODATED: "#0072b2",  # blue
    Stage.IDLE: "#56b4e9",  # sky blue
}
STAGE_WORDS: dict[Stage, str] = {
    Stage.HEALTHY: "",
    Stage.SUSPECT: "beyond the threshold, not for long enough",
    Stage.DETECTED: "a fault, which one is being decided",
    Stage.ISOLATED: "named, not corrected",
    Stage.ACCOMMODATED: "corrected",
    Stage.IDLE: "gone, remembered",
}
