"""Write ``model.h``: the variable table, sizes and messages of a model, for the C shim."""

from __future__ import annotations

import math

from ..runtime.table import Model, Variable
from . import self_test
from .description_common import TAKEN_CATEGORIES
from .description_fmi3 import ARRAY_BASE, CLOCK_REFERENCE

TYPES = """\
typedef enum { REAL, INTEGER, BOOLEAN } Type;
typedef struct {
    const char *name, *unit, *range;
    Type type;
    int calculated, fixed;
    double start, minimum, maximum;
    int input_derivatives, set_flag, rate, element;
} Variable;
typedef struct { unsigned first, size; } Array;
typedef struct { unsigned first, size; double lowest, highest; } SlotRange;"""


def c_string(text: str) -> str:
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n") + '"'


def c_number(value: float) -> str:
    if math.isinf(value):
        return "INFINITY" if value > 0 else "-INFINITY"
    return float(value).hex()


def c_variable_row(variable: Variable, model: Model) -> str:
    minimum = -math.inf if variable.minimum is None else variable.minimum
    maximum = math.inf if variable.maximum is None else variable.maximum
    texts = variable.name, variable.unit, variable.range_text()
    set_flag = model.set_flag_by_slot.get(variable.slot, 0)
    numbers = variable.input_derivatives, set_flag, model.rate_slot(variable)
    cells = [
        *map(c_string, texts),
        variable.type.upper(),
        *map(str, map(int, (variable.calculated, variable.fixed))),
        *map(c_number, (variable.start, minimum, maximum)),
        *map(str, (*numbers, int(bool(variable.series)))),
    ]
    return "    {" + ", ".join(cells) + "},"


def shim_macros(model: Model, slots: dict[str, int], real_outputs: bool) -> dict[str, str]:
    smooth = [v for v in model.variables if v.input_derivatives]
    inputs = [f"orders 1 to {v.input_derivatives} of {v.name}" for v in smooth]
    count_slot = slots[model.series_count] if model.arrays else 0
    return {
        "MEMORY_SIZE": str(model.memory_size),
        "SKIP_FIRST": str(model.written_only[0]),
        "SKIP_COUNT": str(model.written_only[1]),
        "FILLS_SERIES(memory)": f"(memory[{count_slot}] > 0)" if model.arrays else "1",
        "LIMITED_CODE": str(model.limited),
        "TIME_SLOT": str(model.time_slot),
        "STOP_SLOT": str(model.stop_slot),
        "VARIABLE_COUNT": f"{len(model.variables)}u",
        "REAL_OUTPUTS": str(int(real_outputs)),
        "REFRESH": str(int(model.refresh is not None)),
        "COAST": str(int(model.coast is not None)),
        "EVENT_CLOCK": str(int(model.clock is not None)),
        "EVENT_COUNT_SLOT": str(slots[model.clock.counter] if model.clock else 0),
        "CLOCK_REFERENCE": f"{CLOCK_REFERENCE}u",
        "ARRAY_BASE": f"{ARRAY_BASE}u",
        "RANGE_COUNT": f"{len(model.ranges)}u",
        "ARRAY_COUNT": f"{len(model.arrays)}u",
        "MESSAGE_COUNT": str(max(model.messages) + 1),
        "CATEGORY_COUNT": str(len(TAKEN_CATEGORIES)),
        "CATEGORY_NAMES": c_string(" or ".join(TAKEN_CATEGORIES)),
        "INPUT_DERIVATIVES": c_string(", ".join(inputs) or "none"),
    }


def model_header(model: Model, token: str, digest: str, real_outputs: bool = False) -> bytes:
    """Return ``model.h``; with ``real_outputs`` all outputs can be read as Real too."""
    slots = {variable.name: variable.slot for variable in model.variables}
    known = {
        "MODEL_TOKEN": c_string(token),
        "STATE_MAGIC": c_string(f"vibroimpact state {digest}"),
        **shim_macros(model, slots, real_outputs),
        **self_test.self_test_macros(model),
    }
    categories = ", ".join(map(c_string, TAKEN_CATEGORIES))
    arrays = [f"    {{{slots[array.first]}, {array.size}}}," for array in model.arrays]
    ranges = [
        f"    {{{row.first}, {row.size}, {c_number(row.lowest)}, {c_number(row.highest)}}},"
        for row in model.ranges
    ]
    lines = [
        "/* Generated from the variable table. */",
        "#include <math.h>",
        *(f"#define {name} {value}" for name, value in known.items()),
        TYPES,
        "extern const Variable VARIABLES[VARIABLE_COUNT];",
        "#if defined(DEFINE_VARIABLES)  /* in one file */",
        "const Variable VARIABLES[VARIABLE_COUNT] = {",
        *(c_variable_row(variable, model) for variable in model.variables),
        "};",
        "#endif",
        "static const Array ARRAYS[] = {",
        *(arrays or ["    {0, 0},"]),
        "};",
        "static const SlotRange RANGES[] = {",
        *ranges,
        "};",
        f"static const char *const CATEGORIES[] = {{{categories}}};",
        "static const char *const MESSAGES[] = {",
        *(f"    [{code}] = {c_string(text)}," for code, text in sorted(model.messages.items())),
        "};",
    ]
    return ("\n".join(lines) + "\n").encode()
