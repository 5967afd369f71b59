"""What the page draws of a session: the arm's motion and a joint's signals, thinned to what can be seen."""

from __future__ import annotations

from dataclasses import replace

from cdia_pin.app.session import Session
from cdia_pin.discovery import Comparison
from cdia_pin.viewers.report_data import JointReport, joint_data
from cdia_pin.viewers.scene import Timeline, TimelineDocument, timeline_of_comparison

FRAMES = 1500  # of a motion; 50 s at the full rate
POINTS = 1600  # samples of a curve


def improved(session: Session) -> Comparison | None:
    """Return the comparison that stands beside that of the model as given: the preview's, or the present one."""
    shown = session.preview or session.present
    return None if shown is session.history.first else shown.comparison


def timeline(session: Session) -> TimelineDocument:
    """Return the motion of the log for the browser, coloured by the error before and after."""
    whole = thinned(timeline_of_comparison(session.history.first.comparison, improved(session)), FRAMES)
    names = ("as given", "preview" if session.preview else "improved")
    tracks = tuple(replace(track, name=name) for track, name in zip(whole.tracks, names, strict=False))
    return replace(whole, tracks=tracks).to_dict()


def thinned(whole: Timeline, most: int) -> Timeline:
    """Return a timeline with at most so many frames."""
    every = slice(None, None, -(-len(whole.time) // most))
    tracks = tuple(
        replace(t, stage=t.stage[every], level=t.level[every], torque=t.torque[every]) for t in whole.tracks
    )
    desired = None if whole.desired is None else whole.desired[every]
    return replace(
        whole, time=whole.time[every], position=whole.position[every], tracks=tracks, desired=desired
    )


def joint(session: Session, name: str) -> JointReport:
    """Return the signals of one joint for its charts."""
    j = session.inputs.robot.joint_index(name)
    return joint_data(j, session.history.first.comparison, improved(session), None, POINTS)
