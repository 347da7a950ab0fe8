"""Compute the stack bytes of FMU calls from the call graph that gcc writes."""

from __future__ import annotations

import re
import tempfile
from dataclasses import dataclass
from pathlib import Path

from .targets import BITS, CORTEX_M7, c_files, run_command

NODE = re.compile(r'node: \{ title: "([^"]+)" label: "([^"]*)"')
EDGE = re.compile(r'edge: \{ sourcename: "([^"]+)" targetname: "([^"]+)"')
SIZE = re.compile(r"(\d+) bytes \((\w+)")
INDIRECT = "__indirect_call"
# what makes a message; no step that is long enough to change the time and succeeds goes through it
MESSAGES = ("report_values", "refuse", "refuse_step", "warn_short_step", "format_message", "append")
CALLS = {  # FMI 3.0's, by what they are for
    "a step": "fmi3DoStep",
    "outputs": "fmi3GetFloat64",
    "inputs": "fmi3SetFloat64",
    "instantiation": "fmi3InstantiateCoSimulation",
    "initialisation": "fmi3ExitInitializationMode",
}
MACHINES = {"Cortex-M7": ("arm-none-eabi-gcc", *CORTEX_M7), "x86-64": ("gcc",)}


@dataclass(frozen=True)
class CallGraph:
    """Functions of all C files: their own stack bytes, and whom they call."""

    sizes: dict[str, int]
    called: dict[str, set[str]]

    def stack_bytes(self, function: str, path: tuple[str, ...] = ()) -> int:
        """Return the stack bytes of a call, without the C library's; raise if it is in its path."""
        if function in path:
            raise RecursionError(" -> ".join([*path, function]))
        called = self.called.get(function, ())
        inner = (self.stack_bytes(other, (*path, function)) for other in called)
        return self.sizes.get(function, 0) + max(inner, default=0)

    def library_functions(self, function: str, without: tuple[str, ...] = ()) -> set[str]:
        """Return the C library's functions that a call reaches."""
        reached: set[str] = set()
        waiting = [function]
        while waiting:
            name = waiting.pop()
            if name not in reached and plain_name(name) not in without:
                reached.add(name)
                waiting += self.called.get(name, ())
        return {name for name in reached if name not in self.sizes}


def plain_name(title: str) -> str:
    """Return a function's name without its file and gcc's suffixes."""
    return title.rpartition(":")[2].partition(".")[0]


def call_graph(sources: Path, compiler: str, *flags: str) -> CallGraph:
    """Compile an FMU's sources by gcc and return their call graph."""
    sizes: dict[str, int] = {}
    called: dict[str, set[str]] = {}
    for file in c_files(sources):
        with tempfile.TemporaryDirectory() as folder:
            written = Path(folder) / "a.o"
            run_command(compiler, *flags, *BITS, "-fcallgraph-info=su", "-c", file, "-o", written)
            text = written.with_suffix(".ci").read_text("utf-8")
        for title, label in NODE.findall(text):
            size = SIZE.search(label)
            if size and size.group(2) == "dynamic" and "bounded" not in label:
                raise ValueError(f"{title}: expected a stack of a known size")
            if size:
                sizes[title] = int(size.group(1))
        for source, target in EDGE.findall(text):
            called.setdefault(source, set()).add(target)
    return CallGraph(sizes, called)
