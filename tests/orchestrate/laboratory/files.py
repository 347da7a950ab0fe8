"""Records for tests, and files that they are written to."""

import numpy as np

from orchestrate import Structure, record

BEAM = Structure.from_halves(m1=1.5, m2=1.2, f1=42.0, f2=55.0, zeta1=0.007, zeta2=0.007, e=0.6)
G = 9.80665
RATE = 5120.0
CHANNELS = ("box_acceleration", "acceleration1", "acceleration2")
LVM = """LabVIEW Measurement\t
Writer_Version\t2
Reader_Version\t2
Separator\tTab
Decimal_Separator\t,
Multi_Headings\tNo
X_Columns\tOne
***End_of_Header***\t

Channels\t2\t\t
Samples\t5\t5\t
Y_Unit_Label\tg\tg\t
X0\t0,0\t0,0\t
Delta_X\t0,0005\t0,0005\t
***End_of_Header***\t\t
X_Value\tTisch\tSpitze\tComment
0,0000\t0,1\t-0,1
0,0005\t0,2\t2,0
0,0010\t-0,3\t3,5
0,0015\t0,0\t4,0
0,0020\t0,5\t1,0
"""


def random_structure(seed, restitution=(0.5, 0.9), damping=(0.003, 0.02), lowest=30.0, **more):
    draw = np.random.default_rng(seed).uniform
    m1, f1 = draw(0.5, 2.0), draw(lowest, 60.0)
    return Structure.from_halves(
        **{"m1": m1, "m2": m1 * draw(0.4, 2.0), "f1": f1, "f2": f1 * draw(1.1, 1.8)},
        **{"zeta1": draw(*damping), "zeta2": draw(*damping), "e": draw(*restitution), **more},
    )


def drawn(count=300, start=0.0, rate=RATE, **more):
    """A record of noise."""
    values = np.random.default_rng(3).normal(0.0, 20.0, (3, count))
    time = start + np.arange(count) / rate
    return record(time=time, **dict(zip(CHANNELS, values, strict=True)), **more)


def same(one, other):
    """Two records have the same numbers and rate."""
    assert one.sizes == other.sizes and set(one.data_vars) == set(other.data_vars)
    for name in one.variables:
        assert (one[name].values == other[name].values).all(), name
    assert one.attrs["sample_rate"] == other.attrs["sample_rate"]


def swept(count=4000, rate=1000.0):
    """Time, and acceleration, velocity and displacement of a sine swept from 20 to 60 Hz, in SI."""
    time = np.arange(count) / rate
    phase = np.pi * 2.0 * (20.0 * time + 5.0 * time**2)
    speed = 2.0 * np.pi * (20.0 + 10.0 * time)  # of the phase; it grows by 20 pi rad/s2
    velocity = 0.1 * np.cos(phase) * speed
    acceleration = -0.1 * np.sin(phase) * speed**2 + 0.1 * np.cos(phase) * 20.0 * np.pi
    return time, acceleration, velocity, 0.1 * np.sin(phase)


def table_file(path, heading, *columns, separator=",", decimal="."):
    """Write columns of numbers below a heading, with all digits; NaN is an empty field."""
    rows = (separator.join(map(repr, map(float, row))) for row in zip(*columns, strict=True))
    text = "\n".join(rows).replace(".", decimal).replace("nan", "")
    path.write_text(f"{heading}\n{text}\n", encoding="utf-8")
    return path


def write_tdms(path, *channels):
    """Write a stream of LabVIEW with units and numbers of a table, and of a tip."""
    from nptdms import ChannelObject, TdmsWriter

    common = {"wf_increment": 1e-3, "wf_start_offset": 0.0, "sensitivity": "100 mV/g"}
    with TdmsWriter(path) as file:
        parts = zip(("Table", "Tip"), channels, strict=False)
        objects = [
            ChannelObject("run", name, values, common | {"unit_string": unit})
            for name, (unit, values) in parts
        ]
        file.write_segment(objects)
