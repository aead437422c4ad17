"""``robotraj cache``: the compiled functions on disk."""

from __future__ import annotations

from typing import Annotated

import typer

from robotraj.cli.terminal import say


def cache(
    clear: Annotated[bool, typer.Option("--clear", help="Remove everything in it.")] = False,
) -> None:
    """Show where compiled functions are kept, how many and how large; or remove them."""
    from robotraj.native.engines.compiled import Compiled

    kept = Compiled().open_cache()
    if clear:
        say(f"freed {kept.clear() / 1e6:.1f} MB in {kept.folder}")
    else:
        say(f"{len(kept.libraries())} functions, {kept.size() / 1e6:.1f} MB in {kept.folder}")
