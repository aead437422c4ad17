"""One HTML file with body, styles, scripts, meshcat's viewer and the data inlined."""

from __future__ import annotations

import base64
import gzip
import hashlib
import html
import json
from importlib import resources

from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass

SCRIPTS = (
    "page/elements.js",
    "page/theme.js",
    "charts/pen.js",
    "charts/scale.js",
    "charts/selection.js",
    "charts/drawing.js",
    "charts/pointing.js",
    "charts/chart.js",
    "charts/bars.js",
    "charts/groups.js",
    "charts/legend.js",
    "panels/tabs.js",
    "panels/proof.js",
    "panels/meshes.js",
    "panels/settings.js",
    "view/stage.js",
    "view/camera.js",
    "view/contacts.js",
    "view/layers.js",
    "view/picker.js",
    "view/view.js",
    "page/player.js",
    "page/keyboard.js",
    "page/gif.js",
    "page/export.js",
    "page/link.js",
    "page/page.js",
)
STYLES = ("styles/themes.css", "styles/page.css", "styles/charts.css", "styles/small.css")

LIVE_SCRIPTS = (
    "page/elements.js",
    "page/theme.js",
    "charts/pen.js",
    "charts/scale.js",
    "view/stage.js",
    "view/camera.js",
    "live/live_view.js",
    "live/iterate_chart.js",
    "live/residuals.js",
    "live/live.js",
)
LIVE_STYLES = ("styles/themes.css", "styles/page.css", "styles/live.css")

POLICY = (
    "default-src 'none'; script-src {hashes}; style-src 'unsafe-inline'; img-src data: blob:; "
    "connect-src {sources}; base-uri 'none'; form-action 'none'"
)
"""Content-security policy: only the scripts of the page run, identified by hash, and no external source is loaded.

Inline styles are allowed, since the viewer creates some; they cannot load external files. The viewer loads meshes and
textures by ``data:`` and ``blob:`` URLs.
"""


@dataclass(frozen=True)
class Heading(OneLine):
    """The top of the page.

    Attributes
    ----------
    title, subtitle : str
    status : str
    colour : str
        Class of the status in the style sheet: ``"good"``, ``"unproved"`` or ``"bad"``.
    facts : tuple of (str, str)
        Labels and values.
    """

    title: str
    subtitle: str
    status: str
    colour: str
    facts: tuple[tuple[str, str], ...]


def page(heading: Heading, description: dict[str, object], commands: bytes | None) -> str:
    """Return the page of a replay.

    Parameters
    ----------
    heading : Heading
    description : dict
        Data for the page's script, serialisable as JSON.
    commands : bytes or None
        meshcat commands from ``RecordingWindow.packed``. With None the page has no 3D view.
    """
    fields = {
        "title": html.escape(f"{heading.title} · {heading.subtitle}" if heading.subtitle else heading.title),
        "heading": html.escape(heading.title),
        "subtitle": html.escape(heading.subtitle),
        "status": html.escape(heading.status),
        "status_class": heading.colour,
        "facts": "".join(
            f"<div><dt>{html.escape(label)}</dt><dd>{html.escape(value)}</dd></div>" for label, value in heading.facts
        ),
        "layout": "with-view" if commands is not None else "curves-only",
    }
    return _filled("body.html", fields, SCRIPTS, STYLES, "data: blob:", description, commands)


def live_page(title: str, subtitle: str, description: dict[str, object], commands: bytes | None) -> str:
    """Return the page that shows a plan while it is made; it may read from its own server.

    Parameters
    ----------
    title, subtitle : str
    description, commands
        As for ``page``.
    """
    fields = {
        "title": html.escape(f"{title} · live"),
        "heading": html.escape(title),
        "subtitle": html.escape(subtitle),
        "layout": "with-view" if commands is not None else "with-curves",
    }
    return _filled("live/body.html", fields, LIVE_SCRIPTS, LIVE_STYLES, "'self' data: blob:", description, commands)


def _filled(
    body: str,
    fields: dict[str, str],
    scripts: tuple[str, ...],
    styles: tuple[str, ...],
    sources: str,
    description: dict[str, object],
    commands: bytes | None,
) -> str:
    """Fill the document of all pages with a body, texts, scripts, styles and data."""
    text = json.dumps(description, separators=(",", ":"), allow_nan=False).encode()
    viewer = _inline(_meshcat("dist/main.min.js")) if commands is not None else ""
    script = _inline("\n".join(_own(name) for name in scripts))
    fields = fields | {
        "style": "\n".join(_own(name) for name in styles),
        "licences": html.escape(_licences()) if commands is not None else "",
        "policy": POLICY.format(hashes=" ".join(map(_hash, (viewer, script))), sources=sources),
        "viewer": viewer,
        "script": script,
        "data": _base64(gzip.compress(text, 9, mtime=0)),
        "commands": _base64(commands) if commands is not None else "",
    }
    return _with_fields("document.html", fields | {"body": _with_fields(body, fields)})


def _with_fields(template: str, fields: dict[str, str]) -> str:
    """Replace every ``{{ name }}`` of a template by the field of that name."""
    parts = _own(template).split("{{")
    filled = [parts[0]]
    for part in parts[1:]:
        name, rest = part.split("}}", 1)
        filled += [fields[name.strip()], rest]
    return "".join(filled)


def _own(name: str) -> str:
    return resources.files("robotraj.replay_page").joinpath("web", name).read_text(encoding="utf-8")


def _meshcat(name: str) -> str:
    return resources.files("meshcat").joinpath("viewer").joinpath(name).read_text(encoding="utf-8")


def _licences() -> str:
    """Return the licences of the inlined viewer and its libraries; every copy must include them."""
    return _meshcat("LICENSE") + "\n" + _meshcat("dist/main.min.js.LICENSE.txt")


def _inline(script: str) -> str:
    """Escape the sequences that would end the script element."""
    return script.replace("</script", "<\\/script").replace("<!--", "<\\!--")


def _hash(script: str) -> str:
    """Return the source expression that allows one inline script."""
    return f"'sha256-{base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()}'"


def _base64(data: bytes) -> str:
    return base64.b64encode(data).decode("ascii")
