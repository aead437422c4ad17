"""Solutions in files: one ``.npz`` without pickle, which plain NumPy can open too."""

from robotraj.storage.archive import Contents, read, write
from robotraj.storage.codec import NotPlainData, Packer, Unpacker

__all__ = ["Contents", "NotPlainData", "Packer", "Unpacker", "read", "write"]
