"""Where the compiled steps come from: the library, made anew where it is not that of the source."""

from orchestrate.fmu import c_library as libraries
from orchestrate.weak_drive.master import couple_loop

SOURCE = libraries.sources.LOOPS / "couple.c"


def test_a_library_of_other_sources_is_made_anew(tmp_path):
    found = libraries.library(SOURCE, tmp_path)
    first = found.read_bytes()
    assert libraries.library(SOURCE, tmp_path) == found
    assert found.read_bytes() == first
    found.write_bytes(first.replace(b"{", b"("))
    assert libraries.library(SOURCE, tmp_path).read_bytes() == first


def test_structures_have_the_sizes_of_the_source():
    """A field forgotten on one side would shift all that follow: the loop is loaded with that."""
    assert couple_loop() is not None
