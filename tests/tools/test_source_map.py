"""The map of the source files is that of the source files."""

from tools import source_map


def test_the_map_is_that_of_the_files():
    assert source_map.PAGE.read_text(encoding="utf-8") == source_map.source_map(), (
        "repeat: python -m tools.source_map"
    )


def test_each_file_has_its_sentence():
    """A file without one would be missing; C, JavaScript and reStructuredText are read as text."""
    paths = source_map.source_files()
    assert {path.suffix for path in paths} == {".py", ".c", ".h", ".js"}
    assert [path for path in paths if not source_map.first_paragraph(path)] == []
    page = source_map.source_map()
    assert ":func:" not in page
    assert "*/" not in page
