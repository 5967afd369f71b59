"""What a page needs to draw an arm: meshcat's viewer and what drives it, to be inlined or served."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from importlib.util import find_spec
from pathlib import Path

from cdia_pin.extras import require

PARTS = (
    "arm3d_parts.js",
    "arm3d_mark.js",
    "arm3d_attached.js",
    "arm3d_world.js",
    "arm3d.js",
    "player.js",
)


@dataclass(frozen=True)
class SceneAssets:
    """Texts of the page.

    Attributes:
        meshcat: The viewer's script; it defines ``MeshCat``.
        script: Defines ``Arm3D`` and ``Player``; runs after the viewer's.
        style: Style sheet of both.
        licence: Licences of meshcat and of what its script holds.
    """

    meshcat: str
    script: str
    style: str
    licence: str


@cache
def scene_assets() -> SceneAssets:
    """Return the scripts and the style that draw an arm, from this package and from meshcat's.

    Raises:
        MissingExtraError: If meshcat is not installed.
    """
    require("view", "pictures of an arm")
    own = files("cdia_pin.viewers") / "assets"
    viewer = _meshcat() / "viewer"
    parts = "".join((own / name).read_text(encoding="utf-8") for name in PARTS)
    dist = viewer / "dist"
    licences = ((viewer / "LICENSE"), (dist / "main.min.js.LICENSE.txt"))
    return SceneAssets(
        meshcat=(dist / "main.min.js").read_text(encoding="utf-8"),
        # One scope of its own: a page may have names of the same kind.
        script=f'(() => {{\n"use strict";\n{parts}\nObject.assign(globalThis, {{ Arm3D, Player }});\n}})();\n',
        style=(own / "arm3d.css").read_text(encoding="utf-8"),
        licence="\n".join(path.read_text(encoding="utf-8") for path in licences),
    )


def _meshcat() -> Path:
    """Return the folder of meshcat without importing it: an import would load a server that is not used here."""
    found = find_spec("meshcat")
    assert found is not None and found.submodule_search_locations
    return Path(next(iter(found.submodule_search_locations)))
