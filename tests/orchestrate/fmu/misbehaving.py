"""FMUs that hang, abort, crash, exit or answer NaN: the binary of a good one behind another that
hands every call on, but one.
"""

import re
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

BODIES = {  # of the call that goes wrong
    "hangs": "for (;;) pause();",
    "spins": "for (volatile int i = 0;; i++) {}",
    "aborts": "abort();",
    "crashes": "*(volatile int *)0 = 1;",
    "exits": "exit(0);",
    "exits with 3": "exit(3);",
}
HEAD = """\
#define _GNU_SOURCE
#include <dlfcn.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#define COUNT %d
static const char *names[COUNT] = {%s};
void *vibroimpact_table[COUNT];
__attribute__((constructor)) static void open_good(void) {
  Dl_info here;
  dladdr((void *)open_good, &here);
  char place[4096];
  snprintf(place, sizeof place, "%%s", here.dli_fname);
  strcpy(strrchr(place, '/') + 1, "good.so");
  void *good = dlopen(place, RTLD_NOW | RTLD_LOCAL);
  for (int i = 0; i < COUNT; i++) vibroimpact_table[i] = dlsym(good, names[i]);
}
"""
JUMP = """\
__attribute__((naked)) void %s(void) {
  __asm__("movq vibroimpact_table@GOTPCREL(%%rip), %%r11\\n jmpq *%d(%%r11)");
}
"""
WRONG = "int %s(void) { %s return 0; }\n"
NAN = """\
int fmi3GetFloat64(void *c, const unsigned *r, size_t n, double *values, size_t m) {
  typedef int call(void *, const unsigned *, size_t, double *, size_t);
  static int calls;
  int status = ((call *)vibroimpact_table[%d])(c, r, n, values, m);
  for (size_t i = 0; calls >= %d && i < m; i++) values[i] = NAN;
  calls++;
  return status;
}
"""


def misbehaving(source: Path, target: Path, kind: str, first: int = 0) -> Path:
    """Copy an FMI 3.0 FMU for Linux with one call that goes wrong.

    The kind is one of ``BODIES``, or ``"NaN"``: what all but the ``first`` readings are.
    """
    compiler = shutil.which("cc") or shutil.which("gcc")
    command = [compiler] if compiler else [sys.executable, "-m", "ziglang", "cc"]
    folder = target.with_suffix(".folder")
    folder.mkdir(parents=True)
    with zipfile.ZipFile(source) as archive:
        (binary,) = (name for name in archive.namelist() if name.endswith(".so"))
        (folder / "good.so").write_bytes(archive.read(binary))
    names = exported(folder / "good.so")
    (folder / "bad.c").write_text(program(names, kind, first))
    options = ["-shared", "-fPIC", "-O1", "-o", "bad.so", "bad.c", "-ldl"]
    subprocess.run([*command, *options], cwd=folder, check=True)
    with zipfile.ZipFile(source) as old, zipfile.ZipFile(target, "w") as new:
        for name in old.namelist():
            part = (folder / "bad.so").read_bytes() if name == binary else old.read(name)
            new.writestr(name, part)
        new.write(folder / "good.so", f"{Path(binary).parent.as_posix()}/good.so")
    shutil.rmtree(folder)
    return target


def exported(library: Path) -> list[str]:
    found = re.findall(rb"\0(fmi3[A-Z]\w+)(?=\0)", library.read_bytes())
    return sorted({name.decode() for name in found})


def program(names: list[str], kind: str, first: int) -> str:
    wrong = "fmi3GetFloat64" if kind == "NaN" else "fmi3DoStep"
    quoted = ", ".join(f'"{name}"' for name in names)
    parts = [HEAD % (len(names), quoted)]
    parts += [JUMP % (name, 8 * i) for i, name in enumerate(names) if name != wrong]
    last = NAN % (names.index(wrong), first) if kind == "NaN" else WRONG % (wrong, BODIES[kind])
    return "".join([*parts, last])
