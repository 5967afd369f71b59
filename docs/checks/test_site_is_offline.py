"""The built site asks nothing of the network, and its equations are drawn without a script."""

import re
from html.parser import HTMLParser
from pathlib import Path

import pytest

SITE = Path(__file__).resolve().parents[2] / "out" / "docs"
REMOTE = re.compile(r"^(https?:)?//")
IN_STYLES = re.compile(r"""(?:url\(|@import)\s*['"]?\s*((?:https?:)?//[^'")\s]+)""")

pytestmark = pytest.mark.skipif(not SITE.is_dir(), reason="the site is not built: make docs")


class Resources(HTMLParser):
    """Collects what a page loads by itself; a link that a reader may follow is none of it."""

    def __init__(self) -> None:
        super().__init__()
        self.found: list[str] = []

    def handle_starttag(self, tag, attrs):
        given = dict(attrs)
        if tag == "link" and given.get("rel") not in {"prev", "next", "canonical"}:
            self.found.append(given.get("href") or "")
        elif tag != "a":
            self.found.append(given.get("src") or "")


def test_no_page_loads_anything_remote():
    for page in sorted(SITE.rglob("*.html")):
        resources = Resources()
        resources.feed(page.read_text(encoding="utf-8"))
        remote = [address for address in resources.found if REMOTE.match(address)]
        assert not remote, f"{page.relative_to(SITE)} loads {remote}"


def test_no_style_loads_anything_remote():
    for style in sorted(SITE.rglob("*.css")):
        assert not IN_STYLES.findall(style.read_text(encoding="utf-8")), style.relative_to(SITE)


def test_equations_are_mathml():
    assert "<math" in (SITE / "identify.html").read_text(encoding="utf-8")
