"""Small parts of the pages: plain elements with names for people, keyboards and tests."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from nicegui.element import Element
from nicegui.elements.mixins.text_element import TextElement

Handler = Callable[[], Any]


def node(tag: str, text: str = "", classes: str = "", **attributes: str | float | bool) -> TextElement:
    """Make an HTML element; ``aria_label`` is the attribute ``aria-label``."""
    made = TextElement(tag=tag, text=text).classes(classes)
    for name, value in attributes.items():
        made.props[name.rstrip("_").replace("_", "-")] = value
    return made


def button(
    text: str, press: Handler, *, mark: str, classes: str = "", label: str = "", disabled: bool = False
) -> TextElement:
    """Make a button.

    Args:
        text: What it says.
        press: Called when it is pressed; may be a coroutine.
        mark: Its ``data-mark``, by which it is found.
        classes: Of the style sheet.
        label: What it does, for those who do not see where it stands.
        disabled: Whether it cannot be pressed now.
    """
    made = node("button", text, f"button {classes}", type="button", data_mark=mark)
    if label:
        made.props["aria-label"] = label
    if disabled:
        made.props["disabled"] = True
    return made.on("click", press, args=[])


@contextmanager
def folded(summary: str, *, mark: str, open_: bool = False) -> Iterator[Element]:
    """Make a part that is folded away until its summary is pressed."""
    with node("details", data_mark=mark) as made:
        if open_:
            made.props["open"] = True
        node("summary", summary)
        with node("div", classes="folded"):
            yield made


class PageStep:
    """One of the steps down the page: a number, a heading and what is filled in.

    Args:
        number: Its place.
        title: Its heading.
        mark: Its ``data-mark`` is ``step-`` and this.
    """

    def __init__(self, number: int, title: str, mark: str) -> None:
        with node("section", classes="step", data_mark=f"step-{mark}", aria_label=title) as self.section:
            with node("h2", tabindex="-1") as self.heading:
                node("span", str(number), "number", aria_hidden="true")
                node("span", title)
            self.body = node("div", classes="body")

    def focus(self) -> None:
        """Move the keyboard to the heading, as after a button that was pressed has gone."""
        self.heading.client.run_javascript(
            f"getHtmlElement({self.heading.id})?.focus({{preventScroll: true}})"
        )

    @contextmanager
    def filling(self, state: str) -> Iterator[None]:
        """Fill the step anew.

        Args:
            state: ``waiting`` (for a step before it), ``open`` or ``done``.
        """
        self.section.props["data-state"] = state
        self.section.update()
        self.body.clear()
        with self.body:
            yield
