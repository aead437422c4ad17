"""The site: `pip install -e '.[docs]' && sphinx-build -W docs build/site`."""

import re
import sys
from pathlib import Path

DOCS = Path(__file__).parent
sys.path[:0] = [str(DOCS / "_extensions")]

project = "robotraj"
author = "robotraj developers"
copyright = author
version = release = re.search(r'__version__ = "(.*)"', (DOCS.parent / "robotraj" / "__init__.py").read_text())[1]

extensions = [
    "mirror",
    "api",
    "schema",
    "tiles",
    "mathml",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.napoleon",
    "myst_nb",
    "sphinx_design",
    "sphinx_copybutton",
]
exclude_patterns = ["**.ipynb_checkpoints", "replays/*.png", "replays/*.json", "replays/*.log"]

html_theme = "furo"
html_title = "robotraj"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_search_scorer = str(DOCS / "_static" / "search_order.js")  # Sphinx opens it from anywhere
html_math_renderer = "mathml"
html_theme_options = {
    "source_repository": "https://github.com/robotraj/robotraj/",
    "source_branch": "main",
    "source_directory": "docs/",
}

myst_enable_extensions = ["colon_fence", "dollarmath", "amsmath", "deflist"]
myst_heading_anchors = 4
suppress_warnings = ["myst.header"]  # tables of benchmarks are written for a forge

# A notebook runs when the site is built, and an exception in a cell stops the build.
nb_execution_mode = "force"
nb_execution_raise_on_error = True
nb_execution_timeout = 300
nb_execution_show_tb = True

autodoc_member_order = "bysource"
autodoc_typehints = "none"  # the docstrings give types, shapes and units
autodoc_class_signature = "mixed"
napoleon_google_docstring = False
napoleon_use_rtype = False
napoleon_use_ivar = True
