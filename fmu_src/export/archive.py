"""Write FMUs, which are zip files: the same contents give the same bytes."""

from __future__ import annotations

import hashlib
import os
import tempfile
import zipfile
from collections.abc import Mapping
from pathlib import Path

EPOCH = (1980, 1, 1, 0, 0, 0)


def content_hash(files: Mapping[str, bytes]) -> str:
    """Return a hash of named contents, 32 hexadecimal digits."""
    digest = hashlib.sha256()
    for name in sorted(files):
        digest.update(f"{name}\0{len(files[name])}\0".encode())
        digest.update(files[name])
    return digest.hexdigest()[:32]


def guid_of_files(files: Mapping[str, bytes]) -> str:
    digest = content_hash(files)
    return f"{{{digest[:8]}-{digest[8:12]}-{digest[12:16]}-{digest[16:20]}-{digest[20:]}}}"


def write_archive(path: Path, files: Mapping[str, bytes]) -> None:
    """Write an FMU of contents by name, whole or not at all: the model description comes first."""
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(dir=path.parent, suffix=".tmp")
    temporary = Path(name)
    try:
        with os.fdopen(handle, "wb") as stream, zipfile.ZipFile(stream, "w") as archive:
            for entry in sorted(files, key=lambda n: (n != "modelDescription.xml", n)):
                header = zipfile.ZipInfo(entry, EPOCH)
                header.compress_type = zipfile.ZIP_DEFLATED
                header.create_system = 3
                is_library = entry.endswith((".so", ".dll", ".dylib"))
                header.external_attr = (0o755 if is_library else 0o644) << 16
                archive.writestr(header, files[entry])
        temporary.chmod(0o644)
        temporary.replace(path)
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise


def read_folder(folder: Path, prefix: str = "") -> dict[str, bytes]:
    """Return contents by name below a folder, without caches and editors' copies."""
    return {
        prefix + path.relative_to(folder).as_posix(): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
        and "__pycache__" not in path.parts
        and not (path.name.startswith(".") or path.name.endswith("~"))
    }
