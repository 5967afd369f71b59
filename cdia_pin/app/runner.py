"""`Runner`: one job at a time beside the pages, and what became of the last one."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from typing import Any, TypeVar

from cdia_pin.app.job import Cancelled, Job
from cdia_pin.errors import CdiaError
from cdia_pin.fault_report import fault_sentence, is_fault
from cdia_pin.progress import Progress

T = TypeVar("T")

LOOK = 0.05  # [s], between looks at a job


class Runner:
    """Runs jobs. A new job replaces the one before and drops its result; pages look at it while it runs.

    Attributes:
        job: The one that runs; None between jobs.
        said: What has happened last, in a sentence.
        wrong: Why the last work failed, in a sentence; empty if it did not.
    """

    def __init__(self) -> None:
        self.job: Job[Any] | None = None
        self.said, self.wrong = "", ""
        self._sentence = ""

    @property
    def doing(self) -> str:
        """What is being done, in a sentence; empty between jobs."""
        if self.job is None:
            return ""
        return f"{self._sentence}: {self.job.said}" if self.job.said else self._sentence

    def cancel(self) -> None:
        """Cancel the running job."""
        if self.job is not None:
            self.job.cancel()

    def say(self, sentence: str) -> None:
        """Announce what has happened.

        Args:
            sentence: The announcement.
        """
        self.said, self.wrong = sentence, ""

    def refuse(self, sentence: str) -> None:
        """Say why something cannot be done.

        Args:
            sentence: The reason.
        """
        self.said, self.wrong = "", " ".join(sentence.split())

    async def run(self, sentence: str, work: Callable[[Progress], T]) -> T | None:
        """Do work beside the pages.

        Args:
            sentence: What the work is.
            work: Called with a function that takes its progress.

        Returns:
            The result; None if the work was cancelled, or failed, which `wrong` then says.
        """
        self.cancel()
        self.job = job = Job(work)
        self.wrong, self._sentence = "", sentence
        try:
            while not job.ended:
                await asyncio.sleep(LOOK)
            return job.result()
        except Cancelled:
            if self.job is job:  # nothing else has taken its place
                self.say(f"Cancelled: {sentence[:1].lower()}{sentence[1:]}. Nothing has changed.")
        except CdiaError as error:
            self.refuse(str(error))
        except BaseException as error:
            if not is_fault(error):
                raise
            fault = fault_sentence(error, f"cdia app: {sentence}")
            self.refuse(f"{fault}. Nothing has changed: go on with other settings or another log.")
        finally:
            if self.job is job:
                self.job = None
        return None
