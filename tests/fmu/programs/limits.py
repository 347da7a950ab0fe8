"""What an importer can still do wrong."""

import ctypes
import math
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
    given = (b"{00000000-0000-0000-0000-000000000000}", resources, ctypes.byref(callbacks), 0, 1)
    made = f.slave.fmi2Instantiate(b"x", 1, *given)
    return [made is None, messages]


def value_reference_above_two_to_the_31(path):
    try:
        open_fmu(path).call("setReal", [4000000000], [1.0])
    except Refused as refused:
        return "\n".join(refused.messages)


def serialised_state_with_a_spoilt_number(path):
    data, time = open_fmu(path).start(x2_start=0.5).step(3.0).save()
    f, silent = open_fmu(path), []
    for place in range(64, len(data), 8):
        if place > 64 + 8 * 46 and place < len(data) - 8 * 120:
            continue  # kept samples
        f.reset()
        try:
            f.restore(data[:place] + b"\xff" * 8 + data[place + 8 :], time)
            values = [*f.outputs().values(), *f.step(4.0).outputs().values()]
            if not all(math.isfinite(value) for value in values):
                silent.append(place)
        except Refused:
            pass
    return silent


def wrong_point_of_time_where_time_is_the_date(path):
    f = open_fmu(path).start(1.7e9).step(1.7e9 + 1.0)
    f.time += 0.5
    try:
        f.step(f.time + 1.0)
        return "accepted"
    except Refused as refused:
        return "\n".join(refused.messages)


def absurd_time_in_source_and_compiled(path):
    try:
        return open_fmu(path).start(bonded=True).step(1e20).outputs()
    except Refused:
        return "refused"


def endless_step_in_the_source_ends(path):
    try:
        open_fmu(path).start().step(1e10)
    except Refused as refused:
        return refused.messages


def message_names_what_leaves_the_range(path, values):
    try:
        open_fmu(path).start(**values).step(1e80)
    except Refused as refused:
        return "\n".join(refused.messages)
