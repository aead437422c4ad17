"""The replay page inside a notebook."""

from __future__ import annotations

import html

from robotraj._util.errors import InputError
from robotraj.replay_page.write import page_of
from robotraj.solution.solution import Solution

HEIGHT = 560
"""Height of the page in a notebook [px]."""


def inline(solution: Solution) -> str:
    """CycleMap the page as an ``<iframe>`` that holds its own source; the text of the solution where it has no page.

    Solutions whose phases move several robots have no page. The frame runs its own scripts and reaches nothing of the
    notebook around it.
    """
    text = f"<pre style='line-height:1.2'>{html.escape(str(solution))}</pre>"
    try:
        page = page_of(solution)
    except InputError:
        return text
    frame = f"<iframe sandbox='allow-scripts' style='width:100%;height:{HEIGHT}px;border:0' srcdoc='{{}}'></iframe>"
    return frame.format(html.escape(page, quote=True)) + text
