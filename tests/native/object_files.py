"""What objdump says of a shared library: what it exports, what it needs, what of it is written."""

import re
import shutil
import subprocess

import pytest

needs_objdump = pytest.mark.skipif(
    shutil.which("objdump") is None, reason="objdump is not installed"
)
# made read-only by the loader, or the compiler's own frame
FIXED = r"\.(data\.rel\.ro|dynamic|got|relro_padding|init_array|fini_array)"


def objdump(option, path):
    done = subprocess.run(["objdump", option, path], capture_output=True, text=True, check=True)
    return done.stdout


class Elf:
    """A library for Linux: names of dynamic symbols, libraries, bytes that stay writable."""

    def __init__(self, path):
        rows = [
            line for line in objdump("-T", path).splitlines() if re.match("[0-9a-f]{16} ", line)
        ]
        self.imports = {row.split()[-1] for row in rows if "*UND*" in row}
        self.exports = {row.split()[-1] for row in rows if "*UND*" not in row}
        self.needed = set(re.findall(r"NEEDED +(\S+)", objdump("-p", path)))
        sections = re.findall(r"^ +\d+ (\S+) +(\w+) .*\n +(.*)$", objdump("-h", path), re.MULTILINE)
        self.writable = sum(
            int(size, 16)
            for name, size, flags in sections
            if "ALLOC" in flags and "READONLY" not in flags and not re.match(FIXED, name)
        )


class Pe:
    """A DLL for 64-bit Windows: exports, and imported names by library."""

    def __init__(self, path):
        text = objdump("-p", path)
        assert "file format pei-x86-64" in text
        table = text.partition("[Ordinal/Name Pointer] Table")[2].partition("\n\n")[0]
        self.exports = set(re.findall(r"^\s+\[.* (\w+)$", table, re.MULTILINE))
        parts = re.findall(r"DLL Name: (\S+)\n.*\n((?:\t.*\n)*)", text)
        self.imports = {
            name: {row.split()[-1] for row in rows.splitlines()} for name, rows in parts
        }
