"""The finished cases of a study that was interrupted: the same command runs the others."""

from __future__ import annotations

import base64
import contextlib
import json
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

from cdia_pin.cli.unfinished import Unfinished
from cdia_pin.whole_files import write_whole

if TYPE_CHECKING:
    from cdia_pin.campaigns.arm_study import ArmCase, ArmCaseRecord
    from cdia_pin.campaigns.closed_loop import LoopSettings
    from cdia_pin.viewers.study_figures import Picture


@dataclass(frozen=True)
class ShownCase:
    """All that is shown and written of a case of the study of arms.

    Attributes:
        record: The case in JSON.
        row: Its line in the table.
        picture: Its figure.
        settings: Of its closed loop.
    """

    record: ArmCaseRecord
    row: tuple[str, ...]
    picture: Picture
    settings: LoopSettings

    @classmethod
    def of(cls, case: ArmCase) -> ShownCase:
        """Show a case.

        Args:
            case: The case.
        """
        from cdia_pin.viewers.arm_figures import arm_pictures
        from cdia_pin.viewers.arm_report import arm_rows

        (row,), (picture,) = arm_rows([case]), arm_pictures([case])
        return cls(case.to_dict(), row, picture, case.compared.loop.settings)

    @classmethod
    def from_dict(cls, given: dict[str, Any]) -> ShownCase:
        """Read what `to_dict` returned.

        Args:
            given: Plain JSON.
        """
        from cdia_pin.campaigns.closed_loop import LoopSettings
        from cdia_pin.viewers.study_figures import Picture

        drawn = {**given["picture"], "png": base64.b64decode(given["picture"]["png"])}
        return cls(given["record"], tuple(given["row"]), Picture(**drawn), LoopSettings(**given["settings"]))

    def to_dict(self) -> dict[str, Any]:
        """Return plain JSON."""
        picture = {**vars(self.picture), "png": base64.b64encode(self.picture.png).decode("ascii")}
        return {
            "record": self.record,
            "row": self.row,
            "picture": picture,
            "settings": asdict(self.settings),
        }


class UnfinishedStudy(Unfinished):
    """The finished cases of a study of arms that has not ended."""

    @contextmanager
    def resumed(self) -> Iterator[list[ShownCase]]:
        """Give the block the cases that an interrupted run has finished, for it to add to them."""
        cases = self._read()
        with self.told(bool(cases)):
            yield cases

    def keep(self, cases: list[ShownCase]) -> None:
        """Save the cases that are finished; a full disk does not end the study.

        Args:
            cases: All of them.
        """
        if self.path is not None:
            with contextlib.suppress(OSError):
                write_whole(self.path, json.dumps({"study": self.key, "cases": [c.to_dict() for c in cases]}))

    def _read(self) -> list[ShownCase]:
        if self.path is None or not self.path.is_file():
            return []
        with contextlib.suppress(OSError, ValueError, KeyError, TypeError):
            document = json.loads(self.path.read_text(encoding="utf-8"))
            if document["study"] == self.key:
                return [ShownCase.from_dict(case) for case in document["cases"]]
        return []
