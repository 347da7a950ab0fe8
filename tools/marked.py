"""Replace a generated part of a Markdown page, between two marks."""

from __future__ import annotations

from collections.abc import Sequence

MARK = "<!-- {}: {} -->\n"


def replace_part(text: str, name: str, lines: Sequence[str]) -> str:
    """Return a page's text with the lines between the marks of a name replaced."""
    before, rest = text.split(MARK.format(name, "begin"))
    after = rest.split(MARK.format(name, "end"))[1]
    own = "\n".join(lines)
    return f"{before}{MARK.format(name, 'begin')}{own}\n{MARK.format(name, 'end')}{after}"
