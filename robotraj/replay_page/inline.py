"""The replay page inside a notebook."""

from __future__ import annotations

import html

from robotraj._util.errors import InputError
from robotraj.replay_page.write import page_of
from robotraj.solution.solution import Solution

HEIGHT = 560
"""Height of the page in a notebook [px]."""


def inline(solution: Solution) -> str:
    """Return the page as an ``<iframe>`` with inlined source, followed by the text of the solution.

    A solution whose phases move several robots has no page; the text alone is returned. The scripts of the sandboxed
    frame cannot access the notebook.
    """
    text = f"<pre style='line-height:1.2'>{html.escape(str(solution))}</pre>"
    try:
        page = page_of([solution])
    except InputError:
        return text
    allowed, style = "allow-scripts allow-downloads", f"width:100%;height:{HEIGHT}px;border:0"
    return f"<iframe sandbox='{allowed}' style='{style}' srcdoc='{html.escape(page, quote=True)}'></iframe>{text}"
