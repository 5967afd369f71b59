"""The directive `effect`: an entry of the catalogue. Its argument is a term as people type it, its content the physics.

Equation, picture, parameters, measured sizes and what the effect is mistaken for come from the program. The option
`size` tells what sets the size; an effect that was found on no measured arm needs it.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from docutils import nodes
from docutils.parsers.rst import directives
from docutils.statemachine import StringList
from imitation import imitations
from measured_sizes import sentence
from sphinx.application import Sphinx
from sphinx.environment import BuildEnvironment
from sphinx.util import logging
from sphinx.util.docutils import SphinxDirective
from standard_motion import robot
from torque_pictures import picture

from cdia_pin.effects import EFFECTS, Term, parse_term
from cdia_pin.effects.parameter import Parameter

LOGGER = logging.getLogger(__name__)
ENTRIES = "effects"  # of a page, among its metadata
TINY = 1e-6  # share of the torque [1] that is rounding
SOURCE = "../results.md#what-each-arm-lacks-according-to-the-effects-found"
FEW = 4  # parameters [1] that are listed one by one


def setup(app: Sphinx) -> dict[str, Any]:
    """Register the directive, and check the catalogue once all pages are read."""
    app.add_directive("effect", EffectEntry)
    app.connect("env-check-consistency", _check)
    return {"parallel_read_safe": False, "parallel_write_safe": True}


class EffectEntry(SphinxDirective):
    """Write the section of an effect."""

    required_arguments = 1
    final_argument_whitespace = True
    has_content = True
    option_spec = {"size": directives.unchanged_required}  # noqa: RUF012

    def run(self) -> list[nodes.Node]:
        """Return the section."""
        term = parse_term(self.arguments[0], robot())
        name, size = term.effect.name, self.options.get("size", "")
        if not (size or sentence(name)):
            LOGGER.warning("effect %s was found on no measured arm: say with :size: what sets its size", name)
        self.env.metadata[self.env.docname].setdefault(ENTRIES, []).append(name)
        section = nodes.section(ids=[name.replace("_", "-")], names=[name])
        section.document = self.state.document
        section += nodes.title("", "", nodes.literal("", name))
        self.state.nested_parse(self.content, self.content_offset, section)
        section += self._picture(term)
        self.state.nested_parse(StringList([*facts(term, size), "", *resemblances(term)], name), 0, section)
        return [section]

    def _picture(self, term: Term) -> nodes.figure:
        drawn = nodes.raw("", f'<div class="torque-picture">{picture(term)}</div>', format="html")
        caption = nodes.caption("", "", nodes.literal("", self.arguments[0]))
        return nodes.figure("", drawn, caption)


def facts(term: Term, size: str) -> Iterator[str]:
    """Yield equation, parameters and sizes as Markdown."""
    effect = term.effect
    yield from ("| | |", "|---|---|", f"| f | {effect.equation.replace('|', '&#124;')} |")
    yield f"| parameters | {listed(effect.parameters)} |"
    if effect.shape:
        yield f"| shape | {listed(effect.shape)} |"
    if found := sentence(effect.name):
        yield f"| on measured arms | {found} [(source)]({SOURCE}) |"
    if size:
        yield f"| size | {size} |"


def listed(parameters: tuple[Parameter, ...]) -> str:
    """Return parameters with units, the last ones of many left out."""
    said = [f"`{p.name}` [{p.unit_on(prismatic=False)}]" for p in parameters]
    return ", ".join(said if len(said) <= FEW else [*said[:FEW], f"{len(said) - FEW} more"])


def resemblances(term: Term) -> Iterator[str]:
    """Yield what imitates the term on the motion shown, and what tells the two apart."""
    found = imitations(term)
    if not found:
        yield "**Mistaken for:** on the motion shown, no other effect imitates half of it."
        return
    yield from ("**Mistaken for**, with what tells them apart:", "")
    for it in found:
        percent = 100 if it.share > 1 - TINY else min(int(100 * it.share), 99)
        yield f"- `{it.effect.name}`, which imitates {percent} %: {it.motion}"


def _check(app: Sphinx, env: BuildEnvironment) -> None:
    told = {name for page in env.metadata.values() for name in page.get(ENTRIES, ())}
    for name in sorted(set(EFFECTS) - told):
        LOGGER.warning("effect %s has no entry in the catalogue", name)
