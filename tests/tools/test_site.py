"""The check of the site: what points nowhere, and what comes from other hosts."""

import pytest

from tools.site import Site

WHOLE = """<html><head><link rel="stylesheet" href="style.css"><link rel="canonical" href="https://a.b">
</head><body><h1 id="top">One</h1><a href="two.html#part">there</a> <a href="#top">up</a>
<a href="https://example.org">elsewhere</a><img src="picture.png"></body></html>"""


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "one.html").write_text(WHOLE)
    (tmp_path / "two.html").write_text('<p id="part">Two <a href="one.html">back</a></p>')
    for name in ("style.css", "picture.png"):
        (tmp_path / name).touch()
    return tmp_path


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("two.html#part", "three.html"),
        ("two.html#part", "two.html#elsewhere"),
        ('"#top"', '"#bottom"'),
        ("picture.png", "no.png"),
    ],
)
def test_what_points_nowhere_is_named(folder, old, new):
    (folder / "one.html").write_text(WHOLE.replace(old, new))
    assert Site(folder).broken_links() == [f"one.html: {new.strip(chr(34))}"]
