"""How results show themselves in a notebook: they ask here, and who shows them is named at the package's door."""

from __future__ import annotations

from collections.abc import Callable

_html: Callable[[object], str] | None = None


def show_with(html: Callable[[object], str]) -> None:
    """Name what turns a result into HTML."""
    global _html  # noqa: PLW0603  (one for the package, set once when it is imported)
    _html = html


class Displayed:
    """A result that Jupyter and IPython show as a small page instead of as its ``repr``."""

    def _repr_html_(self) -> str | None:
        return None if _html is None else _html(self)
