"""Start and stop of an experiment."""

from driver import Refused, open_fmu


def begun(path, start, stop):
    f = open_fmu(path)
    f.enter(start, stopTime=stop)
    f.leave()
    return f


def past_the_stop_time(path):
    f = begun(path, 0.0, 1.0).step(0.75)
    try:
        f.step(1.25)
    except Refused as refused:
        f.step(1.0)
        try:
            f.step(1.5)
        except Refused:
            return [f.time, refused.messages[0]]
    return [f.time, "nothing was refused"]


def stop_before_start(path):
    try:
        begun(path, 2.0, 1.0)
    except Refused as refused:
        return refused.messages[0]
    return "nothing was refused"


def sum_of_steps(path, count):
    f, h = begun(path, 0.0, 3.0), 3.0 / count
    for _ in range(count):
        f.step(f.time + h)
    return f.time
