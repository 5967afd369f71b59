"""What ``discover``, ``add`` and ``demo`` write of a discovery."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from cdia_pin.cli.outputs import require_report, require_writable, write_all, write_json

if TYPE_CHECKING:
    from rich.console import Console

    from cdia_pin.discovery import Discovery
    from cdia_pin.dynamics import Dynamics
    from cdia_pin.logs import Log, LogCheck
    from cdia_pin.logs.conditioning import Conditioning


@dataclass(frozen=True)
class DiscoveryFiles:
    """Files that a discovery is written to; None where one was not asked for.

    Attributes:
        save: The improved model.
        json: The result for machines, ``-`` for stdout.
        report: The result for people.
    """

    save: Path | None = None
    json: str | None = None
    report: Path | None = None

    def require_writable(self, inputs: Sequence[Path]) -> None:
        """Refuse files that cannot be written or that are inputs.

        Args:
            inputs: Files that are read.

        Raises:
            CommandError: If there is such a file.
            MissingExtraError: If a report is wanted and the extra ``view`` is not installed.
        """
        require_report(self.report)
        require_writable(self.save, self.json, self.report, inputs=inputs)

    def write(
        self,
        console: Console,
        found: Discovery,
        known: Dynamics,
        logs: Sequence[Log],
        *,
        conditioning: Conditioning,
        checks: Sequence[LogCheck],
        command: str,
    ) -> None:
        """Write what was asked for.

        Args:
            console: Where the files are named.
            found: The discovery.
            known: The model before it.
            logs: What it was found in.
            conditioning: How the logs were filtered.
            checks: Checks of the logs, if they were made.
            command: What the user typed.
        """
        from cdia_pin.discovery import compare
        from cdia_pin.dynamics import save_model

        def write_report_to(file: str) -> None:
            from cdia_pin.viewers import write_report

            write_report(
                file,
                compare(known, logs, conditioning=conditioning),
                improved=compare(found.model, logs, conditioning=conditioning),
                discovery=found,
                checks=checks,
                command=command,
            )

        write_all(
            console,
            (self.save, lambda file: save_model(found.model, file, record=found.record)),
            (self.json, lambda file: write_json(found.to_dict(), file)),
            (self.report, write_report_to),
        )
