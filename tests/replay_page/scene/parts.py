"""Parts of one mesh file, as the page reads them."""

from robotraj.replay_page.scene.visuals import Parts, read_meshes


def read_mesh(path: str) -> Parts:
    """Return the parts of a file that is read."""
    found = read_meshes([path])[path]
    assert not isinstance(found, str), found
    return found
