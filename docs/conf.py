"""How Sphinx builds the site: guides from Markdown, a reference from docstrings, a gallery."""

from __future__ import annotations

import logging
import shutil
import sys
from importlib import metadata
from pathlib import Path

DOCS = Path(__file__).parent
PROJECT = DOCS.parent
sys.path.insert(0, str(DOCS))

import numpydoc.xref  # noqa: E402
from gallery_pictures import WrittenPictures  # noqa: E402
from project_pages import write_project_pages  # noqa: E402
from reference_pages import (  # noqa: E402
    every_name_has_a_page,
    public_bases,
    public_names,
    write_reference,
)

project = "terrain_lod"
author = "the terrain_lod authors"
project_copyright = "the terrain_lod authors, MIT licence"
release = metadata.version("terrain_lod")

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.viewcode",
    "numpydoc",
    "sphinx_gallery.gen_gallery",
]
exclude_patterns = ["_examples"]
# a word in `single backquotes` is code: an argument, an attribute
default_role = "code"

# a reference that leads nowhere is a mistake; rooms inside the package have no pages of their own
nitpicky = True
nitpick_ignore_regex = [("py:.*", r"terrain_lod\.[a-z_]+\..*")]

# it is the checkout's folder that may have one
suppress_warnings = ["sphinx_gallery.space_in_filename"]

myst_enable_extensions = ["attrs_block", "deflist"]
myst_heading_anchors = 3

write_reference(DOCS / "reference")
write_project_pages(PROJECT, DOCS / "project")
autosummary_generate = False
autodoc_typehints = "none"  # docstrings say more: shapes and units
autodoc_member_order = "bysource"
autoclass_content = "class"
numpydoc_show_class_members = False
numpydoc_xref_param_type = True
numpydoc_xref_ignore = "all"
numpydoc.xref.DEFAULT_LINKS.clear()  # to the pages of Python and NumPy: nothing is fetched
# classes: other names are words, too
numpydoc_xref_aliases = {
    short: full for full, short in public_names().items() if short[0].isupper()
}

logging.getLogger("terrain_lod").setLevel(logging.WARNING)  # what loading notes is no news here
# examples run in a copy of their folder, where they leave what they write
shutil.copytree(
    PROJECT / "examples",
    DOCS / "_examples",
    dirs_exist_ok=True,
    ignore=shutil.ignore_patterns("*.ipynb", "__pycache__"),
)
sphinx_gallery_conf = {
    "examples_dirs": "_examples",
    "gallery_dirs": "gallery",
    "filename_pattern": r"\.py$",
    "within_subsection_order": "gallery_pictures.ReadingOrder",
    "image_scrapers": (WrittenPictures(),),
    "reset_argv": "gallery_pictures.arguments_of",
    "reset_modules": ("gallery_pictures.name_file",),
    "capture_repr": (),
    "abort_on_example_error": True,
    "download_all_examples": False,
    "show_memory": False,
    "show_signature": False,
    "nested_sections": False,
    "min_reported_time": 3600,
}

html_theme = "furo"
html_title = "terrain_lod"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_show_sphinx = False
html_theme_options = {
    "light_css_variables": {"color-brand-primary": "#1d5b7a", "color-brand-content": "#1d5b7a"},
    "dark_css_variables": {"color-brand-primary": "#7fc4e0", "color-brand-content": "#7fc4e0"},
}


def setup(app) -> None:
    """Let the reference name bases as users import them, and miss no name."""
    app.connect("autodoc-process-bases", public_bases)
    app.connect("env-check-consistency", every_name_has_a_page)
