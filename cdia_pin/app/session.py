"""`Session`: what one tab of the browser works on, without any page."""

from __future__ import annotations

from dataclasses import dataclass, replace

from cdia_pin.app.history import History, Version
from cdia_pin.app.inputs import Inputs, Request, read_model
from cdia_pin.discovery import Discovery, add_effect_in, compare_in, discover_in
from cdia_pin.effects import parse_effect
from cdia_pin.errors import CdiaError
from cdia_pin.progress import Progress, silent
from cdia_pin.selection import DiscoverySettings, Problem


@dataclass(frozen=True, eq=False)
class Session:
    """One log of one arm, from loading to export.

    Every step returns a new session and leaves this one as it is, so that a failed or cancelled step changes
    nothing.

    Attributes:
        inputs: What was loaded.
        problem: The log, conditioned once for all steps.
        history: The models.
        preview: The model with one more effect; None without a preview.
    """

    inputs: Inputs
    problem: Problem
    history: History
    preview: Version | None = None

    @classmethod
    def load(cls, asked: Request, tell: Progress = silent) -> Session:
        """Load a robot and a log, check them and compare them.

        Args:
            asked: What to load.
            tell: Reports progress.

        Raises:
            CdiaError: If they cannot be read or used.
        """
        tell("reading the robot", 0.0)
        return cls.of(Inputs.load(asked, tell, read_model(asked)), tell)

    @classmethod
    def of(cls, inputs: Inputs, tell: Progress = silent) -> Session:
        """Compare a robot with its log.

        Args:
            inputs: Both.
            tell: Reports progress.

        Raises:
            CdiaError: If the log is too short.
        """
        tell("comparing", 0.8)
        problem = Problem.conditioned(inputs.robot, [inputs.log], [], DiscoverySettings())
        first = Version(compare_in(problem.experiment, inputs.model))
        tell("done", 1.0)
        return cls(inputs, problem, History((first,)))

    @property
    def present(self) -> Version:
        """The version that is shown."""
        return self.history.present

    @property
    def found(self) -> Discovery | None:
        """The outcome of the search beside the present model; None before a search."""
        return self.present.found

    @property
    def known(self) -> Discovery | None:
        """A result whose improved model is the present one; None where there is none yet."""
        found = self.found
        return found if found is not None and not found.steps else self.present.fitted

    def search(self, tell: Progress = silent) -> Session:
        """Find what the present model lacks: the ranking of single effects, and the effects that the search would add.

        Args:
            tell: Reports progress.
        """
        model = self.present.model
        found = discover_in(self.problem.around(model), model, tell)
        return replace(self, history=self.history.with_found(found))

    def with_preview(self, text: str, tell: Progress = silent) -> Session:
        """Fit one more effect without adding it.

        Args:
            text: Such as ``coulomb_friction@elbow_joint``, or an expression.
            tell: Reports progress.

        Raises:
            CdiaError: If there is no such effect, or the log does not show it.
        """
        return replace(self, preview=self._with(text, tell))

    def without_preview(self) -> Session:
        """Drop the preview."""
        return replace(self, preview=None)

    def add(self, text: str, tell: Progress = silent) -> Session:
        """Add one effect, fitted together with those of the model; a preview is not fitted again.

        Args:
            text: Such as ``coulomb_friction@elbow_joint``, or an expression.
            tell: Reports progress.

        Raises:
            CdiaError: If there is no such effect, or the log does not show it.
        """
        ready = self.preview
        version = ready if ready is not None and ready.added == (text,) else self._with(text, tell)
        return replace(self, history=self.history.then(version), preview=None)

    def add_found(self) -> Session:
        """Add all effects of the search.

        Raises:
            CdiaError: If there was no search, or it found nothing.
        """
        found = self.found
        if found is None or not found.steps:
            raise CdiaError("no search has found an effect to add")
        added = tuple(s.term.label for s in found.steps if s.term is not None)
        version = Version(compare_in(self.problem.experiment, found.model), added, found, chosen=True)
        return replace(self, history=self.history.then(version), preview=None)

    def goto(self, at: int) -> Session:
        """Return to a model of the history; later models stay until another one is added.

        Args:
            at: Its index.
        """
        return replace(self, history=self.history.goto(at), preview=None)

    def undo(self) -> Session:
        """Return to the model before."""
        return self.goto(self.history.at - 1)

    def redo(self) -> Session:
        """Return to the model that was undone last."""
        return self.goto(self.history.at + 1)

    def _with(self, text: str, tell: Progress) -> Version:
        model = self.present.model
        effect = parse_effect(text, self.inputs.robot)
        fitted = add_effect_in(self.problem.around(model), model, effect, tell)
        return Version(compare_in(self.problem.experiment, fitted.model), (text,), fitted)
