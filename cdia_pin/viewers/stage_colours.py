"""One colour for each stage, everywhere: those of Okabe and Ito, which colour-blind people can distinguish."""

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
    Stage.SUSPECT: "residual above its threshold, but not yet for long enough",
    Stage.DETECTED: "not isolated yet",
    Stage.ISOLATED: "not compensated",
    Stage.ACCOMMODATED: "compensated",
    Stage.IDLE: "cleared, kept in memory",
}
