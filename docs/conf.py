"""How Sphinx builds the documentation: `make docs`."""

import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent), str(HERE / "_extensions")]

from cdia_pin.version import __version__  # noqa: E402

project = "cdia-pin"
author = "The cdia-pin authors"
copyright = author
release = version = __version__

extensions = [
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "myst_nb",
    "command_reference",
    "console",
    "effect_entries",
    "example_gallery",
    "mathml",
    "plain_docstrings",
    "public_objects",
    "reference_keys",
]
exclude_patterns = ["_extensions", "checks"]
default_role = "py:obj"  # `name` in a docstring links to the name where the reference has it

myst_enable_extensions = ["dollarmath", "deflist"]
myst_heading_anchors = 3

nb_execution_mode = "auto"  # a notebook that changed; an error or a late answer fails the build
nb_execution_timeout = 600  # [s], of a cell, on a machine that does much else
nb_execution_raise_on_error = True
nb_merge_streams = True

autodoc_member_order = "bysource"
autodoc_typehints = "description"
autodoc_typehints_description_target = "documented"
autodoc_typehints_format = "short"
python_use_unqualified_type_names = True
napoleon_numpy_docstring = False
napoleon_use_ivar = True

html_theme = "furo"
html_title = "cdia-pin"
html_copy_source = False
html_show_sourcelink = False
pygments_style = "friendly"
