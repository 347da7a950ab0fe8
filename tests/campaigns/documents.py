"""Write hostile TOML, CSV and result files, each from a seeded random generator."""

from __future__ import annotations

import json
import random
from collections.abc import Callable, Sequence
from pathlib import Path

MARKUP = "</script><script>alert(1)</script><img src=x onerror=alert(1)>"
LINES = "one\ntwo\r\nTraceback (most recent call last):\x1b[2J"


def write_toml(place: Path, chance: random.Random) -> None:
    """Write a hostile file of parameters."""
    depth = chance.choice((100, 1000, 100_000))
    digits = chance.choice((5000, 100_000))
    texts = (
        "[structure]\nm1 = " + "[" * depth + "]" * depth,
        "[structure]\nm1 = " + "{a=" * depth + "1" + "}" * depth,
        "[structure]\nm1 = " + "9" * digits,
        "[structure]\nm1 = 1e" + "9" * digits,
        "[structure]\nm1 = 0x" + "f" * digits,
        "[structure]\nm1 = 1979-05-27T07:32:00Z",
        "[structure]\nm1 = nan",
        "[structure]\nm1 = -inf",
        "[structure]\nm1 = true",
        '[structure]\nm1 = "1"',
        f"[structure]\n{json.dumps(LINES)} = 1",
        f"[{json.dumps(LINES)}]\nm1 = 1",
        f"[structure]\nm1 = {json.dumps(MARKUP)}",
        f"[{json.dumps(MARKUP)}]\nm1 = 1",
        "structure = 5",
        "[[structure]]\nm1 = 1",
        "[structure.m1.m2.m3]\nx = 1",
        "a." * depth + "b = 1",
        "[" + "a." * depth + "b]\nx = 1",
        "[structure]\nm1 = 1\nm1 = 2",
        "[structure]\nm1 = '" + "x" * 10_000_000 + "'",
        "[structure]\n" + "".join(f"k{i} = 1\n" for i in range(100_000)),
        "\ufeff\ufeff[structure]\n",
        "\0" * 1000,
    )
    write_text_or_noise(place, chance, texts)


def write_text_or_noise(place: Path, chance: random.Random, texts: Sequence[str]) -> None:
    """Write one of the texts, or in one of five cases random bytes."""
    data = chance.choice(texts).encode("utf-8", "surrogatepass")
    if chance.random() < 0.2:
        data = chance.randbytes(chance.randrange(1000))
    place.write_bytes(data)


def write_course(place: Path, chance: random.Random) -> None:
    """Write a hostile CSV file of voltages over time."""
    count, digits = chance.choice((1000, 1_000_000)), chance.choice((400, 100_000))
    texts = (
        "0,1\n" * count,
        "0," + "9" * digits + "\n1,1\n",
        "0,1e" + "9" * digits + "\n1,1\n",
        "0,1\n1,nan\n",
        "0,1\n1,inf\n",
        "0,1\n-1,1\n",
        "0,1\n1\n",
        "0,1\n1,2,3\n",
        "," * count,
        f"0,1\n{MARKUP}\n",
        f"0,1\n1,{LINES}\n",
        "0,1\n1,=cmd|' /C calc'!A0\n",
        "time,voltage\n" * count,
        "#" * count,
        "0,1\r1,2\r",
        "\ufeff0,1\n1,2\n",
        "\0" * count,
        "",
    )
    write_text_or_noise(place, chance, texts)


def write_result(place: Path, chance: random.Random, good: Path) -> None:
    """Write a hostile result file: damaged or forged."""
    (write_damaged_result if chance.random() < 0.4 else write_forged_result)(place, chance, good)


def write_damaged_result(place: Path, chance: random.Random, good: Path) -> None:
    """Write a good result file cut short, or with noise."""
    data = good.read_bytes()
    kind = chance.randrange(3)
    if kind == 0:
        place.write_bytes(data[: chance.randrange(len(data))])
    elif kind == 1:
        place.write_bytes(chance.randbytes(chance.randrange(10_000)))
    else:
        place.write_bytes(data[:512] + chance.randbytes(len(data) - 512))


def write_forged_result(place: Path, chance: random.Random, good: Path) -> None:
    """Write a NetCDF file with content that no result has."""
    import netCDF4

    kind = chance.randrange(8)
    with netCDF4.Dataset(place, "w") as file:
        file.createDimension("n", 10**12 if kind == 0 else 3)
        if kind == 0:  # terabytes that are not there
            file.createVariable("xi_rel", "f8", ("n",), chunksizes=(1 << 16,), zlib=True)
        else:
            file.createVariable("xi_rel", "f8", ("n",))[:] = 1.0
        if kind == 1:
            file.setncattr("identity", "[" * 100_000)
        elif kind == 2:
            file.setncattr("identity", LINES)
        elif kind == 3:
            file.setncattr("identity", json.dumps({"question": LINES, "fmu": 5}))
        elif kind == 4:
            file.setncattr("over", LINES)
        elif kind == 5:
            file.setncattr("over", "eta")
        elif kind == 6:
            file.createVariable("x" + MARKUP.replace("/", "|"), "f8", ("n",))
            file.setncattr("call", MARKUP)
        else:
            file["xi_rel"].setncattr("scale_factor", "x")
            file["xi_rel"].setncattr("units", "days since 0000-99-99")


READERS: dict[str, Callable[[Path], list[str]]] = {
    "sweep": lambda path: ["sweep", "--eta", "1", "--store", str(path)],
    "explore": lambda path: ["explore", str(path), "--no-open"],
    "branches": lambda path: ["explore", "--branches", str(path), "--no-open"],
    "branch": lambda path: ["branch", "--start", str(path), "--limits", "0.9:1.1"],
    "border": lambda path: ["border", "--start", str(path), "--limits", "1:2,0.1:0.9"],
}
