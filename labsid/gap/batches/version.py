"""Version of the sources of the diagnosis."""

import hashlib
from functools import cache
from pathlib import Path

from labsid import __version__


@cache
def sources_version() -> str:
    """Version and hash of the sources, which change during development although the version does not."""
    digest = hashlib.sha256()
    for path in sorted(Path(__file__).parents[1].rglob("*.py")):
        digest.update(path.read_bytes())
    return f"{__version__} {digest.hexdigest()}"
