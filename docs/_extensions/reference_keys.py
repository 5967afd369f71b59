"""A reference key such as [Lee2020] in a page or a docstring links to its entry of references.md."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from docutils import nodes
from sphinx.application import Sphinx

PAGE = "references"
KEY = re.compile(r"(?<!\[)\[((?:[A-Z][A-Za-z]+\d{4}[a-z]?)|Thesis)\](?!\()")


def setup(app: Sphinx) -> dict[str, Any]:
    """Link keys in pages; docstrings are linked by `plain_docstrings`."""
    app.connect("source-read", _link_page)
    app.connect("doctree-read", _label_entries)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def linked(text: str, role: str) -> str:
    """Return the text with each key as a link, by the role as the markup writes it."""
    return KEY.sub(lambda key: f"{role}`[{key[1]}] <{key[1].lower()}>`", text)


def _link_page(app: Sphinx, docname: str, source: list[str]) -> None:
    if docname != PAGE and Path(app.env.doc2path(docname)).suffix == ".md":
        source[0] = linked(source[0], "{ref}")


def _label_entries(app: Sphinx, doctree: nodes.document) -> None:
    if app.env.docname != PAGE:
        return
    domain = app.env.get_domain("std")
    for strong in doctree.findall(nodes.strong):
        if found := KEY.fullmatch(strong.astext()):
            label = found[1].lower()
            strong["ids"].append(label)
            domain.labels[label] = (PAGE, label, found[0])
            domain.anonlabels[label] = (PAGE, label)
