"""The models of a session, one after the other, with undo and redo."""

from __future__ import annotations

from dataclasses import dataclass, replace

from cdia_pin.discovery import Comparison, Discovery
from cdia_pin.dynamics import Dynamics


@dataclass(frozen=True, eq=False)
class Version:
    """A model, and how it compares with the log.

    Attributes:
        comparison: The model against the log.
        added: Texts of the effects that made it from the version before; empty for the first.
        fitted: How it was fitted; None for the first.
        chosen: Whether a search chose what was added, and not the user.
        found: What a search beside this model found; None before one was made.
    """

    comparison: Comparison
    added: tuple[str, ...] = ()
    fitted: Discovery | None = None
    chosen: bool = False
    found: Discovery | None = None

    @property
    def model(self) -> Dynamics:
        """The model."""
        return self.comparison.model

    @property
    def error(self) -> float:
        """Error over torque RMS, mean over the joints [1]."""
        return self.comparison.mean_error


@dataclass(frozen=True, eq=False)
class History:
    """Versions, and which of them is shown; every change is a new history.

    Attributes:
        versions: From the model as given on.
        at: Index of the present one.
    """

    versions: tuple[Version, ...]
    at: int = 0

    @property
    def first(self) -> Version:
        """The model as given."""
        return self.versions[0]

    @property
    def present(self) -> Version:
        """The version that is shown."""
        return self.versions[self.at]

    @property
    def path(self) -> tuple[Version, ...]:
        """The versions that lead to the present one."""
        return self.versions[: self.at + 1]

    @property
    def discovery(self) -> Discovery | None:
        """How the model as given became the present one, as one discovery; None where nothing was added."""
        fitted = [v.fitted for v in self.path if v.fitted is not None]
        if not fitted:
            return None
        final = fitted[-1].model
        labels = {t.label for t in final.terms}
        added = {
            s.term.label: s for f in fitted for s in f.steps if s.term is not None and s.term.label in labels
        }
        steps = tuple(replace(step, term=final.find(label)) for label, step in added.items())
        return replace(fitted[-1], trace=(fitted[0].trace[0], *steps))

    @property
    def can_undo(self) -> bool:
        """Whether there is a version before."""
        return self.at > 0

    @property
    def can_redo(self) -> bool:
        """Whether there is a version after."""
        return self.at < len(self.versions) - 1

    def then(self, version: Version) -> History:
        """Return the history with a version after the present one; undone versions are dropped.

        Args:
            version: The new one.
        """
        return History((*self.path, version), self.at + 1)

    def with_found(self, found: Discovery) -> History:
        """Return the history with the outcome of a search beside the present model.

        Args:
            found: The outcome.
        """
        k, present = self.at, replace(self.present, found=found)
        return replace(self, versions=(*self.versions[:k], present, *self.versions[k + 1 :]))

    def goto(self, at: int) -> History:
        """Return the history with another version present.

        Args:
            at: Its index; the nearest one if there is none.
        """
        return replace(self, at=min(max(at, 0), len(self.versions) - 1))
