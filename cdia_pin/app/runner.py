"""`Runner`: one job at a time, with a bar, a sentence and a button to cancel."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from typing import Any, TypeVar

from cdia_pin.app.job import Cancelled, Job
from cdia_pin.app.parts import button, node
from cdia_pin.errors import CdiaError
from cdia_pin.fault_report import fault_sentence, is_fault
from cdia_pin.progress import Progress

T = TypeVar("T")

LOOK = 0.05  # [s], between looks at a job


class Runner:
    """Shows the running job. A new job replaces it and drops its result."""

    def __init__(self) -> None:
        self.job: Job[Any] | None = None
        self.said = node("p", classes="said", role="status", aria_live="polite", data_mark="said")
        self.wrong = node("p", classes="wrong", role="alert", data_mark="wrong")
        with node("div", classes="running", data_mark="running") as self.bar:
            self._sentence = node("span")
            self._share = node("progress", value=0, max=1, aria_label="progress")
            button("Cancel", self.cancel, mark="cancel", classes="quiet")
        self._hide()

    def cancel(self) -> None:
        """Cancel the running job."""
        if self.job is not None:
            self.job.cancel()

    def say(self, sentence: str) -> None:
        """Announce what has happened.

        Args:
            sentence: The announcement.
        """
        self.wrong.text = ""
        self.said.text = sentence

    async def run(self, sentence: str, work: Callable[[Progress], T]) -> T | None:
        """Do work beside the page.

        Args:
            sentence: What the work is.
            work: Called with a function that takes its progress.

        Returns:
            The result; None if the work was cancelled, or failed, which the page then says.
        """
        self.cancel()
        self.job = job = Job(work)
        self.wrong.text = ""
        self._sentence.text = sentence
        self._show(0.0)
        try:
            while not job.ended:
                await asyncio.sleep(LOOK)
                if self.job is job:
                    self._show(job.share, job.said and f"{sentence}: {job.said}")
            return job.result()
        except Cancelled:
            if self.job is job:  # nothing else has taken its place
                self.say(f"Cancelled: {sentence[:1].lower()}{sentence[1:]}. Nothing has changed.")
            return None
        except CdiaError as error:
            self.said.text, self.wrong.text = "", " ".join(str(error).split())
            return None
        except BaseException as error:
            if not is_fault(error):
                raise
            fault = fault_sentence(error, f"cdia app: {sentence}")
            self.said.text = ""
            self.wrong.text = f"{fault}. Nothing has changed: go on with other settings or another log."
            return None
        finally:
            if self.job is job:
                self.job = None
                self._hide()

    def _show(self, share: float, sentence: str = "") -> None:
        self._share.props["value"] = round(share, 3)
        self._share.update()
        if sentence:
            self._sentence.text = sentence
        self.bar.props["data-busy"] = "yes"
        self.bar.update()

    def _hide(self) -> None:
        self.bar.props["data-busy"] = "no"
        self.bar.update()
