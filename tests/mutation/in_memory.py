"""A loaded module made another one, as its source would be: functions, constants and settings."""

import dataclasses
import gc
import sys
import types

import numpy as np

VALUES = (int, float, str, tuple, dict, set, frozenset, slice, range, np.ndarray)


def codes(source):
    waiting, found = [compile(source, "source", "exec")], {}
    while waiting:
        inner = [one for one in waiting.pop().co_consts if isinstance(one, types.CodeType)]
        found |= {one.co_qualname: one for one in inner}
        waiting += inner
    return found


def signature(code):
    """What a code does, without its lines."""
    inner = (signature(one) if isinstance(one, types.CodeType) else one for one in code.co_consts)
    return repr((code.co_code, code.co_names, *inner))


def become(module, before, after):
    """Change a module from its source to another one, wherever others hold parts of it; return
    whether anything has changed.
    """
    old, new, name = codes(before), codes(after), module.__name__
    codes_changed = {q for q in new if q in old and signature(new[q]) != signature(old[q])}
    held = gc.get_objects()
    functions = [
        one
        for one in held
        if isinstance(one, types.FunctionType)
        and one.__module__ == name
        and one.__qualname__ in codes_changed
        and len(one.__code__.co_freevars) == len(new[one.__qualname__].co_freevars)
    ]
    for one in functions:
        one.__code__ = new[one.__qualname__]
    fresh = types.ModuleType(name)
    fresh.__dict__.update(__package__=module.__package__, __file__=module.__file__)
    exec(compile(after, "source", "exec"), fresh.__dict__)
    pairs = [(key, vars(module).get(key), value) for key, value in vars(fresh).items()]
    changed = [exchange(*each) for each in pairs if isinstance(each[2], VALUES)]
    changed += [set_defaults(mine, its, held) for _, mine, its in pairs if is_record(its)]
    return bool(functions) or any(changed)


def is_record(value):
    return isinstance(value, type) and dataclasses.is_dataclass(value)


def exchange(key, old, new):
    """Set a constant in all modules that have it by this name."""
    if key.startswith("__") or type(old) is not type(new) or repr(old) == repr(new):
        return False
    for module in list(sys.modules.values()):
        if repr(getattr(module, "__dict__", {}).get(key)) == repr(old):
            vars(module)[key] = new
    return True


def set_defaults(mine, its, held):
    """Give a dataclass the defaults of another one, and those derived from it; instances too."""
    if not is_record(mine):
        return False
    pairs = zip(dataclasses.fields(mine), dataclasses.fields(its), strict=True)
    values = {a.name: b.default for a, b in pairs if repr(a.default) != repr(b.default)}
    for init in [one.__init__ for one in (mine, *mine.__subclasses__())] if values else ():
        count, code = len(init.__defaults__ or ()), init.__code__
        names = code.co_varnames[code.co_argcount - count : code.co_argcount]
        named = zip(names, init.__defaults__ or (), strict=True)
        init.__defaults__ = tuple(values.get(name, value) for name, value in named)
        known = init.__kwdefaults__ or {}
        init.__kwdefaults__ = known | {name: values[name] for name in known.keys() & values.keys()}
    for one in held if values else ():
        if isinstance(one, mine):
            for name, value in values.items():
                object.__setattr__(one, name, value)
    return bool(values)
