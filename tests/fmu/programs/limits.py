"""What an importer can still do wrong, where it may end the process."""

import ctypes
from pathlib import Path

import fmpy
from driver import Fmu2, Refused, callbacks, messages, open_fmu


def extracted_below_a_folder_with_special_letters(path, folder):
    return open_fmu(path, folder=fmpy.extract(path, folder)).start().step(1.0).get("phase")


def null_pointer_for_a_state(path):
    f, refusals = open_fmu(path).start(), 0
    for _ in range(100):
        try:
            f.call("setFMUState", None)
        except Refused:
            refusals += 1
    f.reset().start().step(1.0)
    return refusals


def guid_of_something_else(path):
    f = open_fmu(path)
    messages.clear()
    resources = Path(Fmu2.folders[path], "resources").as_uri().encode()
    given = (b"{00000000-0000-0000-0000-000000000000}", resources, ctypes.byref(callbacks()), 0, 1)
    made = f.fmu.fmi2Instantiate(b"x", 1, *given)
    return [made is None, messages]


def value_reference_above_two_to_the_31(path):
    try:
        open_fmu(path).call("setReal", [4000000000], [1.0])
    except Refused as refused:
        return "\n".join(refused.messages)


def absurd_time(path):
    try:
        return open_fmu(path).start(bonded=True).step(1e20).outputs()
    except Refused:
        return "refused"


def endless_step(path):
    try:
        open_fmu(path).start().step(1e10)
    except Refused as refused:
        return refused.messages
