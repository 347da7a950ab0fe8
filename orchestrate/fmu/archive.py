"""Checks of an FMU archive before anything of it is unpacked."""

from __future__ import annotations

import io
import re
import stat
import zipfile

MAX_FILES = 10_000  # far above any real FMU: an archive with more is an attack or an accident
MAX_BYTES = 1 << 30  # unpacked; the same


def checked_names(data: bytes) -> list[str]:
    """Return the paths in an FMU's zip; raise if one is outside, or it is too large."""
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        entries = archive.infolist()
    if len(entries) > MAX_FILES:
        raise ValueError(f"{len(entries)} files in it, at most {MAX_FILES} expected")
    total = sum(entry.file_size for entry in entries)
    if total > MAX_BYTES:
        raise ValueError(f"{total} bytes unpacked, at most {MAX_BYTES} expected")
    names = [entry.orig_filename for entry in entries]
    if len(set(names)) < len(names):
        raise ValueError("two files of one name in it")
    for entry in entries:
        name = entry.orig_filename
        parts = name.removesuffix("/").split("/")
        plain = name.isprintable() and not re.search(r"[\\:]", name)
        if not plain or {"", ".", ".."} & set(parts):
            raise ValueError(f"{name!r} in it, expected paths below the archive")
        if stat.S_ISLNK(entry.external_attr >> 16):
            raise ValueError(f"{name!r} in it is a link, expected files")
    return names


def check_identifier(name: str) -> None:
    if not re.fullmatch(r"[A-Za-z_]\w*", name, re.ASCII):
        raise ValueError(f"modelIdentifier {name[:100]!r}, expected letters, digits and _")
