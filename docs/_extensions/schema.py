"""The tables and types of problem files, written out from the classes when the site is built."""

from __future__ import annotations

from mirror import GENERATED, write
from sphinx.application import Sphinx
from sphinx.config import Config

from robotraj.applications.problem_files.schema import reference

HEAD = "# Tables and types of problem files\n\nWritten by `robotraj schema --markdown` from the classes themselves.\n\n"


def schema(app: Sphinx, config: Config) -> None:
    """Write the page."""
    write(GENERATED / "problem-schema.md", HEAD + reference().replace("\n### ", "\n## ").replace("### ", "## ", 1))


def setup(app: Sphinx) -> dict[str, bool]:
    """Write the page before pages are looked for."""
    app.connect("config-inited", schema, priority=100)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
