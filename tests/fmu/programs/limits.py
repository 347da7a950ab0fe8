"""What an importer can still do wrong, where it may end the process."""

import ctypes
from pathlib import Path

import fmpy
from driver import Fmu2, Refused, callbacks, messages, open_fmu


def extracted_below_a_folder_with_special_letters(path):
    folder = fmpy.extract(path, Path.cwd() / "Jörg, 50 % off")
    return open_fmu(path, folder=folder).start().step(1.0).get("phase") == [0.4]


def null_pointer_for_a_state(path):
    f, refusals = open_fmu(path).start(), 0
    for _ in range(100):
        try:
            f.call("setFMUState", None)
        except Refused:
            refusals += 1
    f.reset().start().step(1.0)
    return refusals == 100


def guid_of_something_else(path):
    f = open_fmu(path)
    messages.clear()
    resources = Path(Fmu2.folders[path], "resources").as_uri().encode()
    given = (b"{00000000-0000-0000-0000-000000000000}", resources, ctypes.byref(callbacks()), 0, 1)
    return f.fmu.fmi2Instantiate(b"x", 1, *given) is None and bool(messages)


def value_reference_above_two_to_the_31(path):
    try:
        open_fmu(path).call("setReal", [4000000000], [1.0])
    except Refused as refused:
        return "valueReference = 4000000000" in "\n".join(refused.messages)
