"""The same bits again, in another process."""

from driver import harmonic, open_fmu


def resume(path, data, end):
    return open_fmu(path).restore(bytes.fromhex(data), 77.0).step(end).outputs()


def run_and_resume(path, data):
    """Outputs of a run of this process at 77 s, and x1 at 2000 s; those of the resumed state."""
    f = open_fmu(path).start(**harmonic(1.13)).step(77.0)
    return [[f.outputs(), f.step(2000.0).get("x1")[0]], resume(path, data, 2000.0)]
