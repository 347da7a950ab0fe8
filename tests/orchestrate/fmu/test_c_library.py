"""Compiled libraries in the cache: loaded as they were compiled, where nobody else can write."""

import os
import random
import stat
import sys

import pytest

from fmu_src.export import c_library as sources
from orchestrate.errors import InputError
from orchestrate.fmu import c_library, exported
from orchestrate.fmu.c_library import SOURCES, find_or_compile_library
from tests.faults import FILE_DAMAGE

SOURCE = SOURCES[0]
COMPILED = b"compiled " + sources.library_guid(SOURCE).encode()


@pytest.fixture
def cache(tmp_path, monkeypatch):
    """A cache folder; a compiler that notes what it compiles."""
    made = []
    monkeypatch.setattr(sources, "compile_loop", lambda *what: made.append(what) or COMPILED)
    exported.log_once.cache_clear()
    monkeypatch.setattr("orchestrate.files.trusted_owners", lambda: ({os.getuid()}, set()))
    umask = os.umask(0o002)  # as of systems with a group for each user
    yield tmp_path / "cache", made
    os.umask(umask)


def test_it_is_compiled_once_and_others_cannot_write_it(cache):
    folder, made = cache
    path = find_or_compile_library(SOURCE, folder)
    assert path.read_bytes() == COMPILED
    assert find_or_compile_library(SOURCE, folder) == path and len(made) == 1
    for part in (path, sources.digest_path(path), path.parent, path.parent.parent):
        assert not part.stat().st_mode & (stat.S_IWGRP | stat.S_IWOTH)


@pytest.mark.parametrize("damage", [*FILE_DAMAGE, "no digest", "no library"])
def test_what_is_not_as_it_was_compiled_is_compiled_anew(cache, damage):
    folder, made = cache
    path = find_or_compile_library(SOURCE, folder)
    if damage.startswith("no"):
        (sources.digest_path(path) if damage == "no digest" else path).unlink()
    else:
        FILE_DAMAGE[damage](path, random.Random(1))
    assert find_or_compile_library(SOURCE, folder) == path and path.read_bytes() == COMPILED
    assert len(made) == 2


@pytest.mark.skipif(sys.platform == "win32", reason="other permissions there")
@pytest.mark.parametrize("part", ["library", "digest", "folder", "its folder"])
@pytest.mark.parametrize("mode", [0o002, 0o020])
def test_what_others_could_have_written_is_compiled_anew(cache, part, mode):
    """Their group too, unless it can write these sources."""
    folder, made = cache
    path = find_or_compile_library(SOURCE, folder)
    planted = b"planted " + COMPILED
    path.write_bytes(planted)
    sources.digest_path(path).write_text(sources.library_digest(planted))
    parts = path, sources.digest_path(path), path.parent, path.parent.parent
    one = parts[("library", "digest", "folder", "its folder").index(part)]
    one.chmod(one.stat().st_mode | mode)
    assert find_or_compile_library(SOURCE, folder) == path and path.read_bytes() == COMPILED
    assert len(made) == 2


@pytest.mark.skipif(sys.platform == "win32", reason="other owners there")
@pytest.mark.parametrize("shipped", [False, True])
def test_what_is_somebody_else_s_is_loaded_only_from_the_package(cache, monkeypatch, shipped):
    folder, _ = cache
    path = find_or_compile_library(SOURCE, folder)
    others = {path.stat().st_uid + 1}, set()
    monkeypatch.setattr("orchestrate.files.trusted_owners", lambda: others)
    if shipped:
        monkeypatch.setattr(c_library, "SHIPPED", folder)
        assert find_or_compile_library(SOURCE, folder) == path
    else:
        with pytest.raises(InputError, match=f"{path}: others can write .*expected"):
            find_or_compile_library(SOURCE, folder)
