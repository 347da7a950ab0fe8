"""Translate a kernel, from its subset of Python, function by function to readable C99.

Every function is translated once for each tuple of argument types it is called with, under its own
name and with the first line of its docstring; constants and slots keep their names. Operations keep
their order, so that a compiler that neither contracts nor reorders floating-point operations makes
the bits that Python makes. What lies outside the subset is refused, with file, line and what to
write instead.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from types import FunctionType, ModuleType
from typing import Any

from ..errors import CannotExport
from .expressions import TAKEN
from .functions import STORAGE, Body, wrap_lines
from .values import C_TYPES, MEMORY, REAL, Type, Unit

HEAD = """\
/* Translated from the Python in documentation/kernels, where the reasons are.

   Every number of this model has the same bits on every machine, if the compiler does what the
   lines say: it must not fuse a multiplication and an addition, nor reorder sums. */
#if defined(__clang__)
#pragma STDC FP_CONTRACT OFF
#if defined(__FAST_MATH__)
#error "the kernel needs floating-point numbers by IEEE 754: compile without -ffast-math"
#endif
#elif defined(__GNUC__)
/* its vectoriser of straight lines reorders and fuses in spite of -ffp-contract=off */
#pragma GCC optimize ("fp-contract=off", "no-tree-slp-vectorize", "no-fast-math")
#elif defined(_MSC_VER)
#pragma fp_contract (off)
#pragma float_control (precise, on)
#endif

#include <math.h>

#if defined(FMI2_FUNCTION_PREFIX) || defined(FMI3_FUNCTION_PREFIX) || \\
    defined(FMI3_ACTUAL_FUNCTION_PREFIX)
#include "names.h"
#endif

#if defined(_MSC_VER)
#define RESTRICT __restrict
#else
#define RESTRICT restrict
#endif

/* How often lines run, only for speed; -DINLINE=inline makes smaller code. */
#if defined(__GNUC__)
#define USUALLY(test) __builtin_expect(test, 1)
#define RARELY(test) __builtin_expect(test, 0)
#define COLD __attribute__((cold, noinline))
#else
#define USUALLY(test) (test)
#define RARELY(test) (test)
#define COLD
#endif
#if !defined(INLINE) && defined(__GNUC__)
#define INLINE inline __attribute__((always_inline))
#elif !defined(INLINE)
#define INLINE inline
#endif

#if defined(__GNUC__) && !defined(_WIN32)
#pragma GCC visibility push(hidden)
#endif
"""
SELDOM = ("initialize", "restore")  # entry points
HELPERS = """\
/* The larger and the smaller number, as Python chooses them: the first one of equal ones. */
static inline double larger(double one, double other)
{
    return other > one ? other : one;
}

static inline double smaller(double one, double other)
{
    return other < one ? other : one;
}

/* The largest whole number that is not larger. */
static inline double floored(double value)
{
    double shift = 6755399441055744.0, whole = value; /* 1.5 * 2^52: a sum with it is rounded */
    if (RARELY(!(-2251799813685248.0 < value && value < 2251799813685248.0))) {
        if (fabs(value) < 4503599627370496.0) { /* 2^52: from there on every number is whole */
            whole = (double)(long long)value;
        }
    } else {
        whole = (value + shift) - shift;
    }
    return whole > value ? whole - 1.0 : whole;
}
"""


@dataclass
class Translation:
    """Functions, constants, structures and names that have been translated so far."""

    # by function and types of the arguments; those come first that others call
    units: dict[tuple[FunctionType, tuple[Type, ...]], Unit] = field(default_factory=dict)
    # numbers and tables that are used, by their names in C
    constants: dict[str, float | tuple[float, ...]] = field(default_factory=dict)
    structures: dict[Type, str] = field(default_factory=dict)  # names in C of the tuples used
    names: dict[str, object] = field(default_factory=dict)  # what each name in C stands for
    # functions whose bodies are being read: a call of one of them is recursion
    begun: set[FunctionType] = field(default_factory=set)

    def translated_unit(self, function: FunctionType, kinds: tuple[Type, ...]) -> Unit:
        """Return a function for arguments of these types, translated at the first call."""
        key = function, kinds
        if key not in self.units:
            name = self.unique_c_name(function.__name__, key, function.__module__)
            unit = Unit(function, kinds, name)
            self.begun.add(function)
            Body(self, unit).translate()
            self.begun.remove(function)
            self.units[key] = unit
        return self.units[key]

    def unique_c_name(self, name: str, thing: object, module: str) -> str:
        place = module.rpartition(".")[2]
        longer = f"{place.upper() if name.isupper() else place}_{name}"
        for known in (name, longer, *(f"{longer}_{number}" for number in range(2, 100))):
            if known not in TAKEN and self.names.setdefault(known, thing) == thing:
                return known
        raise CannotExport(f"{name}: too many things of this name")

    def constant_name(self, module: ModuleType, name: str) -> str:
        known = self.unique_c_name(name, (module.__name__, name), module.__name__)
        self.constants[known] = getattr(module, name)
        return known

    def c_type_name(self, kind: Type) -> str:
        if isinstance(kind, str):
            return C_TYPES[kind]
        if kind not in self.structures:
            for part in kind:
                self.c_type_name(part)
            reals = all(part == REAL for part in kind)
            name = f"Reals{len(kind)}" if reals else f"Group{len(self.structures)}"
            self.structures[kind] = name
        return self.structures[kind]

    def declarations(self) -> list[str]:
        whole = sorted((n, name) for name, n in self.constants.items() if isinstance(n, int))
        real = [(name, n) for name, n in self.constants.items() if isinstance(n, float)]
        tables = [(name, n) for name, n in self.constants.items() if isinstance(n, tuple)]
        structures = []
        for kind, name in self.structures.items():
            parts = " ".join(f"{self.c_type_name(part)} i{i};" for i, part in enumerate(kind))
            structures += wrap_lines(f"typedef struct {{ {parts} }} {name};", "", "    ")
        numbers = ["enum {", *(f"    {name} = {number}," for number, name in whole), "};\n"]
        return [
            "\n".join(numbers if whole else []),  # C has no empty enum
            "".join(f"static const double {name} = {number_literal(n)};\n" for name, n in real),
            "".join(table_definition(name, numbers) for name, numbers in tables),
            "\n".join(structures) + "\n",
        ]


def table_definition(name: str, numbers: tuple[float, ...]) -> str:
    """Return the definition of a table: of whole numbers where all of them are."""
    whole = all(isinstance(number, int) for number in numbers)
    entries = "".join(f"    {n if whole else number_literal(n)},\n" for n in numbers)
    return f"static const {'int' if whole else 'double'} {name}[] = {{\n{entries}}};\n"


def number_literal(number: float) -> str:
    """Return a constant to the last bit, and how people write it."""
    known = {"inf": "INFINITY", "-inf": "-INFINITY", "nan": "NAN"}
    text = repr(number)
    return known.get(text) or f"{number.hex()} /* {text} */"


def texts_with_storage(units: Iterable[Unit], often: set[str]) -> Iterator[str]:
    """Yield the functions' texts; those that are called in rare cases only are not inlined."""
    known = {unit.name: unit for unit in units}
    reached, ahead = set(often), list(often)
    while ahead:
        new = known[ahead.pop()].often - reached
        reached |= new
        ahead += new
    for name, unit in known.items():
        storage = "static inline" if name in reached else "static COLD"
        yield unit.text if unit.is_inline else unit.text.replace(STORAGE, storage, 1)


def translate(entries: Mapping[str, Callable[[Any, float], int]]) -> str:
    """Translate a kernel's entry points, by name, to a C99 file of ``kernel_NAME`` functions."""
    done = Translation()
    exits, often = [], set()
    for name, function in entries.items():
        assert isinstance(function, FunctionType)
        inner = done.translated_unit(function, (MEMORY, REAL)).name
        head = f"int kernel_{name}(double *memory, double time)"
        if name not in SELDOM:
            often.add(inner)
        exits.append(f"{head};\n{head}\n{{\n    return {inner}(memory, time);\n}}\n")
    bodies = [f"{text}\n" for text in texts_with_storage(done.units.values(), often)]
    return "\n".join([HEAD, *done.declarations(), HELPERS, *bodies, *exits])
