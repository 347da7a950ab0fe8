"""What the README and the manual show: blocks of Python, TOML files, command lines."""

import re
import shlex
from dataclasses import dataclass
from pathlib import Path

from tests import ROOT

DOCS = ROOT / "docs"
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted(DOCS.glob("*.md"))]
FENCE = re.compile(
    r"^(?P<fence>```+|~~~+) *(?P<kind>[^\n`]*)\n(?P<body>.*?)^(?P=fence) *$", re.M | re.S
)
SPAN = re.compile(r"`([^`\n]+)`")
COMMAND = re.compile(r"(?:[\w./]*/)?python3? -m orchestrate(?:\s.*)?$")
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


def files(page: Path) -> dict[str, str]:
    """Blocks of TOML and of numbers, by the name of the file that they show."""
    found = {}
    for block in blocks(page):
        if block.kind in ("toml", "{code-block} toml", "{code-block} text"):
            name = block.options.get("caption") or re.match(r"# ([\w.]+\.toml)", block.text)
            if name:
                found[name if isinstance(name, str) else name[1]] = block.text
    return found


def commands(page: Path) -> list[list[str]]:
    """Command lines of this project, as arguments; without those that only show a form."""
    text = page.read_text(encoding="utf-8")
    shown = [block.text for block in blocks(page) if block.kind in ("", "sh", "text")]
    said = [line for part in shown for line in part.replace("\\\n", " ").splitlines()]
    said += SPAN.findall(FENCE.sub("", text))
    found = []
    for line in said:
        command = COMMAND.search(line)
        if command and not PLACEHOLDER.search(command[0]):
            words = shlex.split(command[0].partition("&&")[0], comments=True)
            found.append(words[words.index("orchestrate") + 1 :])
    return found
