"""`Visit`: what the pages of one address work on; each part is made when its page is shown first."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from cdia_pin.app.live_bench import LiveBench
    from cdia_pin.app.workbench import Workbench


class Visit:
    """What waits on the shelf for its pages.

    Args:
        workbench: Makes the workbench of the first page.
    """

    def __init__(self, workbench: Callable[[], Workbench]) -> None:
        self._workbench = workbench

    @cached_property
    def find(self) -> Workbench:
        """What the page *Find missing effects* works on."""
        return self._workbench()

    @cached_property
    def live(self) -> LiveBench:
        """What the page *While it moves* works on."""
        from cdia_pin.app.live_bench import LiveBench

        return LiveBench()

    def close(self) -> None:
        """Free what was made."""
        for made in {"find", "live"} & vars(self).keys():
            getattr(self, made).close()
