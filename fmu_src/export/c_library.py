"""Compile one C source to a shared library, for what orchestration uses beside the FMUs.

The source includes ``token.h``, which defines ``TOKEN``, and keeps it as a string: so a library of
other sources is known by its bytes, for whatever platform it was made. A digest of the bytes stands
beside it: one that was damaged, or replaced, is known too.
"""

from __future__ import annotations

import hashlib
from pathlib import Path

from ..kernels import repetition
from .archive import guid_of
from .compiler import link
from .errors import CannotExport
from .platforms import PLATFORMS
from .sources import import_closure
from .translation.kernel import translate

KERNELS = {  # headers that a source may include, translated from Python
    "repetition.h": {"decide": repetition.decide, "repeat": repetition.repeat},
}


def guid(source: Path) -> str:
    """Return the token that a library of the present source bears, in braces.

    Parameters
    ----------
    source : Path
        The C file.
    """
    return guid_of({**import_closure("export/c_library.py"), source.name: source.read_bytes()})


def export(source: Path, platform: str) -> bytes:
    """Compile a C source for a platform.

    Raises
    ------
    CannotExport
        Where there is no compiler for it.
    """
    if platform not in PLATFORMS:
        raise CannotExport(f"platform {platform}: expected one of {', '.join(PLATFORMS)}")
    text = source.read_bytes()
    files = {source.name: text, "token.h": f'#define TOKEN "{guid(source)}"\n'.encode()}
    for name, entries in KERNELS.items():
        if name.encode() in text:
            files[name] = translate(entries).encode()
    return link(platform, source.stem, files)


def file_name(source: Path, platform: str) -> str:
    """Return the library's file name, with its platform as the folder."""
    return f"{platform}/{source.stem}{PLATFORMS[platform].suffix}"


def digest(library: bytes) -> str:
    """Return what the file beside a library says of its bytes."""
    return hashlib.sha256(library).hexdigest()


def digest_file(path: Path) -> Path:
    """Return the path of the file beside a library that has its digest."""
    return path.with_name(f"{path.name}.sha256")


def is_current(path: Path, token: str) -> bool:
    """Return whether a library is of the sources with this token, and as it was compiled."""
    try:
        library, written = path.read_bytes(), digest_file(path).read_bytes()
    except OSError:
        return False
    return token.encode() in library and written == digest(library).encode()
