"""Windows' rule, here: a file that is open or mapped by this process is not removed or replaced.

``python -m pytest --held-files`` runs tests with it, where ``/proc`` says what is open.
"""

import os
from pathlib import Path

OPEN, MAPPED = Path("/proc/self/fd"), Path("/proc/self/maps")


def target(link):
    try:
        return link.readlink()
    except OSError:  # closed meanwhile
        return None


def refuse_if_held(path, folder=None):
    """Raise as Windows does; ``folder`` is the descriptor of an open one that the path is in."""
    base = Path() if folder is None else (OPEN / str(folder)).readlink()
    path = (base / os.fsdecode(path)).resolve()
    is_mapped = path.suffix == ".so" and f"{path}\n" in MAPPED.read_text()
    if is_mapped or path in map(target, OPEN.iterdir()):
        raise PermissionError(13, "in use by this process", str(path))


def install():
    """Let ``os.unlink``, ``os.replace`` and ``os.rename`` refuse files that are held."""
    unlink, replace, rename = os.unlink, os.replace, os.rename

    def unlink_unless_held(path, *, dir_fd=None):
        refuse_if_held(path, dir_fd)
        unlink(path, dir_fd=dir_fd)

    def moved(move):
        def move_unless_held(source, to, *, src_dir_fd=None, dst_dir_fd=None):
            refuse_if_held(source, src_dir_fd)
            refuse_if_held(to, dst_dir_fd)
            move(source, to, src_dir_fd=src_dir_fd, dst_dir_fd=dst_dir_fd)

        return move_unless_held

    os.unlink = os.remove = unlink_unless_held
    os.replace, os.rename = moved(replace), moved(rename)
