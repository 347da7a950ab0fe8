"""Write files of measurements of every format: good ones, and hostile ones by a seed."""

import random
import re
import struct
from collections.abc import Callable
from pathlib import Path

import numpy as np
import scipy.io
import xarray as xr
from scipy.io import wavfile

import orchestrate
from orchestrate.running.store import write_netcdf
from tests.faults import FILE_DAMAGE, flip_a_bit

COUNT, RATE = 400, 1000.0
TIME = np.arange(COUNT) / RATE
BASE, FACE = np.sin(300.0 * TIME), 3.0 * np.sin(300.0 * TIME - 1.0) + 0.1 * np.cos(7e3 * TIME)
TOKENS = (  # put into texts
    *("7" * 3000 + " mV/(", "9" * 400, "1e999", "-1e-999", "nan", "inf", "0x1p3", "1_000", "+"),
    *(".", '"', "'" * 3, "\x1b[2J\x1b]0;x\x07", "\r", "\n", "\n\n", "\t", ";", ",", " ", "\0"),
    *("\ufeff", "\u202e\u2028\x85", "[g]", "(", "[" * 500, " _" * 2000, "x" * 140_000, "12:00:00"),
    *("1.1.2026", "</script><script>alert(1)</script>", "=cmd|' /C calc'!A0", "../../escaped"),
    *("%s%n{0}", "g/Hz", "    -1\n", "    58\n", "   58b", "***End_of_Header***\t\n"),
    *("Channels\t9\n", "Delta_X\t0\t0\n"),
)
NUMBERS = ("0", "-0", "1e300", "-1e308", "5e-324", "1e16", "0.1234567", "nan", "3", "-7.5")
WORDS = (0, 1, 2, 7, 8, 14, 15, 255, 65_535, 2**31 - 1, 2**31, 2**32 - 1, 2**32 - 8)
LVM = """LabVIEW Measurement\t
Writer_Version\t2
Separator\tTab
Decimal_Separator\t.
Multi_Headings\tNo
X_Columns\tOne
***End_of_Header***\t
\t
Channels\t2\t\t
Samples\t{count}\t{count}\t
Y_Unit_Label\tg\tg\t
X0\t0.0\t0.0\t
Delta_X\t0.001\t0.001\t
***End_of_Header***\t\t
X_Value\tbase\tface1\tComment
"""


def rows(separator: str, heading: str, *columns: np.ndarray) -> str:
    lines = (separator.join(f"{one:.6g}" for one in row) for row in zip(*columns, strict=True))
    return heading + "\n".join(lines) + "\n"


def record() -> xr.Dataset:
    channels = {"box_acceleration": 9.81 * BASE, "acceleration1": 9.81 * FACE}
    return orchestrate.record(**channels, sample_rate=RATE)


def write_tdms(path: Path) -> None:
    """A binary stream of LabVIEW."""
    from nptdms import ChannelObject, TdmsWriter

    properties = {"wf_increment": 1.0 / RATE, "wf_start_offset": 0.0, "unit_string": "g"}
    columns = {"base": BASE, "face1": FACE}
    with TdmsWriter(path) as file:
        file.write_segment([ChannelObject("a", n, one, properties) for n, one in columns.items()])


def write_nested_mat(path: Path) -> None:
    """Structures in a compressed MAT file, as Simcenter exports them."""

    def signal(name: str, values: np.ndarray) -> dict[str, object]:
        axis = {"start_value": 0.0, "increment": 1.0 / RATE}
        quantity = {"quantity": {"label": "g"}, "values": values}
        return {"x_values": axis, "y_values": quantity, "function_record": {"name": name}}

    signals = {"Signal_0": signal("base", BASE), "Signal_1": signal("face1", FACE)}
    scipy.io.savemat(path, signals, do_compression=True)


def write_hdf5(path: Path) -> None:
    """HDF5 behind the heading of a MAT file of version 7.3."""
    other = path.with_suffix(".nc")
    orchestrate.write_record(record(), other)
    heading = b"MATLAB 7.3 MAT-file".ljust(124) + b"\0\2IM"
    path.write_bytes(heading.ljust(512, b"\0") + other.read_bytes())
    other.unlink()


def write_stored(path: Path) -> None:
    """A result with a checksum."""
    write_netcdf(record().assign_attrs(identity='{"question": "x"}', call="sweep()"), path)


FREQUENCIES = np.linspace(10.0, 60.0, 40)
AMPLITUDES = 1.0 / np.hypot(1.0 - (FREQUENCIES / 35.0) ** 2, 0.03)
Write = Callable[[Path], object]


def text(separator: str, heading: str, *columns: np.ndarray) -> Write:
    """Who writes columns as text."""
    return lambda path: path.write_text(rows(separator, heading, *columns))


HISTORY = TIME, BASE, FACE
SOUND = (9000.0 * np.stack([BASE, FACE], 1)).astype("i2")
FORMATS: dict[str, tuple[str, Write]] = {  # kind -> ending, who writes a good one
    "csv": (".csv", text(",", "t [s],base [g],face1 [g]\n", *HISTORY)),
    "tsv": (".tsv", text("\t", "t\tbase\ttip\ns\tg\tg\n", *HISTORY)),
    "txt": (".txt", text(" ", "", *HISTORY)),
    "lvm": (".lvm", text("\t", LVM.format(count=COUNT), *HISTORY)),
    "tdms": (".tdms", write_tdms),
    "uff": (".uff", lambda path: orchestrate.write_record(record(), path, binary=False)),
    "58b": (".unv", lambda path: orchestrate.write_record(record(), path)),
    "mat": (".mat", lambda path: orchestrate.write_record(record(), path)),
    "nested mat": (".mat", write_nested_mat),
    "mat 7.3": (".mat", write_hdf5),
    "netcdf": (".nc", lambda path: orchestrate.write_record(record(), path)),
    "wav": (".wav", lambda path: wavfile.write(path, 1000, SOUND)),
    "curve": (".csv", text(";", "f [Hz];face 1 [g]\n", FREQUENCIES, AMPLITUDES)),
    "stored": (".nc", write_stored),
}
TEXTS = ("csv", "tsv", "txt", "lvm", "uff", "curve")


def insert_tokens(path: Path, draw: random.Random) -> None:
    """Hostile texts in a text, or in place of a piece of it; most often in its heading."""
    data = bytearray(path.read_bytes())
    for _ in range(draw.randint(1, 4)):
        begin = draw.randrange(min(len(data), draw.choice((60, 400, len(data)))))
        token = draw.choice(TOKENS).encode(draw.choice(("utf-8", "utf-16-le")))
        data[begin : begin + draw.choice((0, 1, len(token)))] = token
    path.write_bytes(data)


def change_numbers(path: Path, draw: random.Random) -> None:
    """Some numbers of a text become extreme ones, or a column's scale changes."""
    lines = path.read_text(errors="replace").split("\n")
    for _ in range(draw.choice((1, 2, 300))):
        row = draw.randrange(len(lines))
        places = [m.span() for m in re.finditer(r"-?\d+(\.\d+)?(e[+-]?\d+)?", lines[row])]
        if places:
            begin, end = draw.choice(places)
            scaled = lines[row][begin:end] + draw.choice(("e9", "e-9", "5"))
            number = draw.choice((*NUMBERS, scaled))
            lines[row] = lines[row][:begin] + number + lines[row][end:]
    path.write_text("\n".join(lines))


def change_words(path: Path, draw: random.Random) -> None:
    """Words of a binary file that may be sizes and types; most often in its heading."""
    data = bytearray(path.read_bytes())
    for _ in range(draw.randint(1, 4)):
        begin = draw.randrange(min(len(data), draw.choice((200, 1000, len(data))))) // 4 * 4
        form, word = draw.choice(("<I", ">I", "<Q", "<H", "B")), draw.choice(WORDS)
        word = min(word, 2 ** (8 * struct.calcsize(form)) - 1)
        data[begin : begin + struct.calcsize(form)] = struct.pack(form, word)
    path.write_bytes(data)


def cut_and_repeat(path: Path, draw: random.Random) -> None:
    """A piece of a file is lost, doubled or stands somewhere else."""
    data = path.read_bytes()
    a, b, c = sorted(draw.randrange(len(data)) for _ in "abc")
    pieces = data[:a], data[a:b], data[b:c], data[c:]
    order = draw.choice(((0, 2, 3), (0, 1, 1, 2, 3), (0, 2, 1, 3), (1, 2, 3), (0, 3)))
    path.write_bytes(b"".join(pieces[i] for i in order))


def append_another(path: Path, draw: random.Random) -> None:
    """A file of another format behind this one, or in its place."""
    own, ending = path.read_bytes(), path.suffix
    other = path.with_name(f"other{draw.choice(list(FORMATS.values()))[0]}")
    draw.choice([write for end, write in FORMATS.values() if end == other.suffix])(other)
    data = other.read_bytes()
    other.unlink()
    assert path.suffix == ending
    path.write_bytes(draw.choice((own + data, data + own, data)))


def inflate(path: Path, draw: random.Random) -> None:
    """Much in little: what is compressed, or a piece that is repeated up to some MB."""
    count = draw.choice((30, 200, 400)) << 20
    if path.suffix == ".mat" and count < 100 << 20:
        scipy.io.savemat(path, {"base": np.zeros(count >> 1)}, do_compression=True)
    elif path.suffix == ".nc":
        import netCDF4

        with netCDF4.Dataset(path, "w") as file:
            file.createDimension("time", count)
            for name in ("time", "box_acceleration"):
                file.createVariable(name, "f8", ("time",), zlib=True, chunksizes=(1 << 20,))
    else:
        data = path.read_bytes()
        begin = draw.randrange(len(data))
        piece = data[begin : begin + draw.choice((1, 2, 40, 4000))]
        times = draw.choice((10_000, 4_000_000)) // len(piece)
        path.write_bytes(data[:begin] + piece * times + data[begin:])


HARMS = (insert_tokens, change_words, cut_and_repeat, append_another, inflate)


def write_hostile(kind: str, folder: Path, draw: random.Random) -> tuple[Path, str]:
    """Write a hostile file of a kind; return its path and what was done."""
    ending, write = FORMATS[kind]
    path = folder / f"a{ending}"
    write(path)
    own = [insert_tokens, change_numbers] if kind in TEXTS else [change_words, flip_a_bit]
    harms = [*own, *own, *HARMS[:4], *FILE_DAMAGE.values(), *[inflate] * (draw.random() < 0.2)]
    done = [draw.choice(harms) for _ in range(draw.choice((1, 1, 1, 2)))]
    for harm in done:
        if path.stat().st_size:
            harm(path, draw)
    return path, ", ".join(harm.__name__ for harm in done)


def reading(kind: str, draw: random.Random) -> dict[str, object]:
    choices: dict[str, tuple[object, ...]] = {
        "unit": (None, "g", "m/s2", "base=V,face1=V", "mm/s", "um"),
        "sample_rate": (None, None, 1000.0),
        "sensitivity": (None, None, "100 mV/g"),
        "channels": (None, None, [0, 1], {"acceleration1": 1}, {"box_acceleration": "base"}),
        "resample": (False, True),
        "delay": (None, None, "base=1e-4"),
        "scale": (None, None, "base=-1"),
    }
    if kind == "curve":
        return {"unit": draw.choice((None, "g", "mm/s")), "level": draw.choice((None, 2.0, 2.0))}
    chosen: dict[str, object] = {"unit": "g"} if kind == "txt" else {}
    if draw.random() < 0.4:
        chosen = {name: draw.choice(some) for name, some in choices.items()}
    return chosen | ({"scale": 1.0} if kind == "wav" else {})
