"""Windows' rule, here: a file that this process holds open or has mapped is not removed or replaced.

``python -m pytest --held-files`` runs tests with it, where ``/proc`` says what is open.
"""

import os
from pathlib import Path

OPEN, MAPPED = Path("/proc/self/fd"), Path("/proc/self/maps")


def whole_path(path, folder):
    """The path that a name below an open folder, or below the present one, stands for."""
    path = os.fsdecode(os.fspath(path))
    return os.path.join(os.readlink(OPEN / str(folder)) if folder is not None else "", path)


def refuse_if_held(path, folder=None):
    path = os.path.realpath(whole_path(path, folder))
    held = {link for number in os.listdir(OPEN) if (link := target(OPEN / number))}
    if path in held or (path.endswith(".so") and f"{path}\n" in MAPPED.read_text()):
        raise PermissionError(13, "in use by this process", path)


def target(link):
    try:
        return os.readlink(link)
    except OSError:  # closed meanwhile
        return ""


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
