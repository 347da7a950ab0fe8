"""An FMU is a zip file: written so that the same contents give the same bytes."""

import hashlib
import os
import tempfile
import zipfile
from pathlib import Path

EPOCH = (1980, 1, 1, 0, 0, 0)


def fingerprint(files):
    """Hash of named contents, 32 hexadecimal digits.

    Parameters
    ----------
    files : dict of str to bytes
    """
    digest = hashlib.sha256()
    for name in sorted(files):
        digest.update(f"{name}\0{len(files[name])}\0".encode())
        digest.update(files[name])
    return digest.hexdigest()[:32]


def guid_of(digest):
    """A fingerprint in the form of a GUID."""
    return (
        "{" + "-".join((digest[:8], digest[8:12], digest[12:16], digest[16:20], digest[20:])) + "}"
    )


def write_archive(path, files):
    """Write an FMU, whole or not at all.

    Parameters
    ----------
    path : Path
    files : dict of str to bytes
        ``modelDescription.xml`` comes first, the rest in alphabetical order.
    """
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, temporary = tempfile.mkstemp(dir=path.parent, suffix=".tmp")
    try:
        with (
            os.fdopen(handle, "wb") as stream,
            zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive,
        ):
            for name in sorted(files, key=lambda n: (n != "modelDescription.xml", n)):
                entry = zipfile.ZipInfo(name, EPOCH)
                entry.compress_type = zipfile.ZIP_DEFLATED
                entry.create_system = 3
                entry.external_attr = (0o755 if name.endswith((".so", ".dll")) else 0o644) << 16
                archive.writestr(entry, files[name])
        Path(temporary).chmod(0o644)
        Path(temporary).replace(path)
    except BaseException:
        Path(temporary).unlink(missing_ok=True)
        raise


def read_folder(folder, prefix=""):
    """All files below a folder, without caches, as a dict of name to bytes."""
    folder = Path(folder)
    return {
        prefix + path.relative_to(folder).as_posix(): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and "__pycache__" not in path.parts
    }
