"""What the README and the manual show: blocks of Python, TOML files, command lines."""

from __future__ import annotations

import re
import shlex
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted(DOCS.glob("*.md"))]
FENCE = re.compile(
    r"^(?P<fence>```+|~~~+) *(?P<kind>[^\n`]*)\n(?P<body>.*?)^(?P=fence) *$", re.M | re.S
)
COMMAND = re.compile(r"(?:[\w./]*/)?python3? -m orchestrate\b[^\n`]*|\bvibroimpact [a-z][^\n`]*")
PLACEHOLDER = re.compile(r"\b(?:COMMAND|QUESTION)\b|\.\.\.$")


@dataclass(frozen=True)
class Block:
    """A fenced block: what stands behind its fence, options, and text."""

    kind: str
    options: dict[str, str]
    text: str


def blocks(page: Path) -> list[Block]:
    """All fenced blocks of a page, in their order."""
    found = []
    for match in FENCE.finditer(page.read_text(encoding="utf-8")):
        lines = match["body"].splitlines(keepends=True)
        options = {}
        while lines and (option := re.match(r":([\w-]+): *(.*)\n", lines[0])):
            options[option[1]] = option[2]
            lines.pop(0)
        found.append(Block(match["kind"].strip(), options, "".join(lines)))
    return found


def python_blocks(page: Path) -> list[str]:
    """Blocks of Python that the build of the manual does not run."""
    return [block.text for block in blocks(page) if block.kind == "python"]


def cells(page: Path) -> list[str]:
    """Code cells, which the build runs."""
    return [block.text for block in blocks(page) if block.kind == "{code-cell}"]


def toml_files(page: Path) -> dict[str, str]:
    """TOML blocks by the name of the file that they show."""
    found = {}
    for block in blocks(page):
        if block.kind in ("toml", "{code-block} toml"):
            name = block.options.get("caption") or re.match(r"# ([\w.]+\.toml)", block.text)
            if name:
                found[name if isinstance(name, str) else name[1]] = block.text
    return found


def commands(page: Path) -> list[list[str]]:
    """Command lines of this project, as arguments; without those that only show a form."""
    text = page.read_text(encoding="utf-8").replace("\\\n", " ")
    found = []
    for line in COMMAND.findall(text):
        said = line.split("&&")[0].strip()
        if PLACEHOLDER.search(said):
            continue
        words = shlex.split(said, comments=True)
        first = words.index("orchestrate") if "orchestrate" in words else 0
        found.append(words[first + 1 :])
    return found
