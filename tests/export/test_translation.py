"""The translator: what its C computes against what the Python computes, and what it refuses."""

import ctypes
import shutil
import subprocess
import textwrap
from importlib import util

import pytest

from fmu_src.export.errors import CannotExport
from fmu_src.export.translation.kernel import translate

CC = shutil.which("gcc") or shutil.which("cc") or shutil.which("clang")
EXPORT = """
int outside_{name}(double *memory, double time);
int outside_{name}(double *memory, double time)
{{
    return kernel_{name}(memory, time);
}}
"""
STRICT = ("-std=c99", "-Wall", "-Wextra", "-Wconversion", "-pedantic", "-Werror")


def library(folder, text, *flags):
    (folder / "kernel.c").write_text(text, "utf-8")
    target = folder / f"kernel{'_'.join(flags)}.so"
    command = [CC, *STRICT, *flags, "-shared", "-fPIC", "kernel.c", "-o", target, "-lm"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return ctypes.CDLL(str(target))


def module_of(folder, body):
    text = "import math\nLIMIT = 2.0\n\n\ndef helper(m, x):\n    m[0] += x\n    return m[0]\n\n\n"
    text += "def entry(m, time):\n" + textwrap.indent(textwrap.dedent(body), "    ")
    path = folder / "outside.py"
    path.write_text(text, "utf-8")
    spec = util.spec_from_file_location("outside", path)
    module = util.module_from_spec(spec)
    import sys

    sys.modules["outside"] = module
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize(
    ("body", "line", "text"),
    [
        ("return m[0] ** 2", 11, "expected one of"),
        ("m[0] = math.sin(time)\nreturn 0", 11, "math.sin; expected a function of the kernel"),
        ("try:\n    return 0\nexcept ValueError:\n    return 1", 11, "expected =, if"),
        ("for x in m:\n    m[0] = x\nreturn 0", 11, "expected for NAME in range"),
        ("m[0] = unknown\nreturn 0", 11, "unknown is not known here"),
        ("m[time] = 0.0\nreturn 0", 11, "expected a whole number as the slot"),
        ("if time:\n    return 1\nreturn 0", 11, "time; expected a comparison"),
        ("a, b = time\nreturn 0", 11, "expected a tuple of 2"),
        ("m[0] += helper(m, time)\nreturn 0", 11, "expected the call in a statement of its own"),
        ("m[0] = max(1, 2)\nreturn 0", 11, "expected real numbers"),
        ("m[0] = helper(m, x=time)\nreturn 0", 11, "expected arguments without names"),
        ("m[0] = 'text'\nreturn 0", 11, "'text'; expected a number"),
        ("return entry(m, time)", 11, "entry calls itself; expected a loop, no recursion"),
        # two calls that change the memory, of which a test decides whether they are made
        ("x = helper(m, 1.0) - helper(m, 2.0) if time > 0.0 else 0.0\nm[0] = x", 10, "too early"),
    ],
)
def test_what_is_outside_the_subset_is_refused(tmp_path, body, line, text):
    """In one line, with the file, the line and what to write instead."""
    module = module_of(tmp_path, body)
    with pytest.raises(CannotExport) as caught:
        translate({"entry": module.entry})
    told = str(caught.value)
    assert f"outside.py, line {line}: " in told and text in told and "\n" not in told


def both(folder, body):
    if CC is None:
        pytest.skip("no C compiler on this machine")
    module, outside = module_of(folder, body), EXPORT.format(name="entry")
    text = translate({"entry": module.entry}) + f"#pragma GCC visibility pop\n{outside}"
    entry = library(folder, text, "-O2").outside_entry
    entry.argtypes = [ctypes.c_void_p, ctypes.c_double]
    return module.entry, entry


def test_calls_that_change_the_memory_are_made_in_their_order(tmp_path):
    """Compilers of C like to begin with the last argument."""
    body = "m[1] = helper(m, time) - 3.0 * helper(m, 2.0) + m[0]\n"
    body += "m[2] = math.sqrt(max(helper(m, time) * 0.5, helper(m, 1.0) - time))\n"
    body += "m[3], m[4] = helper(m, 1.5), m[0]\nreturn 0"
    for value in (0.3, 7.0):
        memories = [0.25, *[0.0] * 4], (ctypes.c_double * 5)(0.25)
        for function, memory in zip(both(tmp_path, body), memories, strict=True):
            assert function(memory, value) == 0
        assert list(memories[1]) == memories[0]


def test_floor_is_exact(tmp_path):
    """Beside ties, zeros, and numbers from which on all are whole."""
    body = "m[0] = math.floor(time) * 1.0\n"
    body += "if abs(time) < 9e18:\n    m[1] = (math.floor(time) & 3) * 1.0\nreturn 0"
    own, entry = both(tmp_path, body)
    ends = [0.0, 0.25, 0.5, 1.0, 1.5, 2.5, 3.75, 7.0, 1e-300, 1e9 + 0.5, 2.0**62]
    ends += [2.0**63, 7.5e27, 1e300]  # beyond the longest whole number of C
    ends += [2.0**k + part for k in (50, 51, 52) for part in (-1.25, -0.5, 0.0, 0.5, 1.0)]
    for value in [sign * end for end in ends for sign in (1.0, -1.0)]:
        memory, expected = (ctypes.c_double * 2)(), [0.0, 0.0]
        assert entry(memory, value) == own(expected, value) == 0
        assert [x.hex() for x in memory] == [x.hex() for x in expected], value
