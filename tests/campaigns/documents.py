"""Write hostile TOML, CSV and NetCDF, each from a seeded random generator."""

import json
import random
from pathlib import Path

from tests.faults import FILE_DAMAGE

MARKUP = "</script><script>alert(1)</script><img src=x onerror=alert(1)>"
LINES = "one\ntwo\r\nTraceback (most recent call last):\x1b[2J"


def write_toml(place: Path, chance: random.Random) -> None:
    """Write a hostile file of parameters."""
    depth, digits = chance.choice((100, 1000, 100_000)), chance.choice((5000, 100_000))
    lines, markup = json.dumps(LINES), json.dumps(MARKUP)
    numbers = ("9" * digits, "1e" + "9" * digits, "0x" + "f" * digits, "nan", "-inf", "true", '"1"')
    values = (
        *("[" * depth + "]" * depth, "{a=" * depth + "1" + "}" * depth, *numbers, markup),
        *("1979-05-27T07:32:00Z", "1\nm1 = 2", "'" + "x" * 10_000_000 + "'"),
    )
    texts = (
        *(f"[structure]\nm1 = {value}" for value in values),
        *(f"[structure]\n{lines} = 1", f"[{lines}]\nm1 = 1", f"[{markup}]\nm1 = 1"),
        *("structure = 5", "[[structure]]\nm1 = 1", "[structure.m1.m2.m3]\nx = 1"),
        *("a." * depth + "b = 1", "[" + "a." * depth + "b]\nx = 1", "\ufeff\ufeff[structure]\n"),
        "[structure]\n" + "".join(f"k{i} = 1\n" for i in range(100_000)),
        "\0" * 1000,
    )
    write_text_or_noise(place, chance, texts)


def write_course(place: Path, chance: random.Random) -> None:
    """Write a hostile CSV file of voltages over time."""
    count, digits = chance.choice((1000, 1_000_000)), chance.choice((400, 100_000))
    cells = ("1,nan", "1,inf", "-1,1", "1", "1,2,3", MARKUP, f"1,{LINES}", "1,=cmd|' /C calc'!A0")
    texts = (
        *(f"0,1\n{cell}\n" for cell in cells),
        *("0," + "9" * digits + "\n1,1\n", "0,1e" + "9" * digits + "\n1,1\n"),
        *("0,1\n" * count, "," * count, "time,voltage\n" * count, "#" * count, "\0" * count),
        *("0,1\r1,2\r", "\ufeff0,1\n1,2\n", ""),
    )
    write_text_or_noise(place, chance, texts)


def write_text_or_noise(place: Path, chance: random.Random, texts: tuple[str, ...]) -> None:
    """Write one of the texts, or in one of five cases random bytes."""
    data = chance.choice(texts).encode("utf-8", "surrogatepass")
    noise = chance.randbytes(chance.randrange(1000))
    place.write_bytes(noise if chance.random() < 0.2 else data)


def write_result(place: Path, chance: random.Random, good: Path) -> None:
    """Write a result file that is damaged, or has content that no result has."""
    if chance.random() < 0.4:
        place.write_bytes(good.read_bytes())
        chance.choice(list(FILE_DAMAGE.values()))(place, chance)
        return
    import netCDF4

    kind = chance.randrange(7)
    identities = ("[" * 100_000, LINES, json.dumps({"question": LINES, "fmu": 5}))
    with netCDF4.Dataset(place, "w") as file:
        file.createDimension("n", 10**12 if kind == 0 else 3)
        if kind == 0:  # terabytes that are not there
            file.createVariable("xi_rel", "f8", ("n",), chunksizes=(1 << 16,), zlib=True)
            return
        file.createVariable("xi_rel", "f8", ("n",))[:] = 1.0
        if kind <= len(identities):
            file.setncattr("identity", identities[kind - 1])
        elif kind == 4:
            file.setncattr("over", chance.choice((LINES, "eta")))
        elif kind == 5:
            file.createVariable("x" + MARKUP.replace("/", "|"), "f8", ("n",))
            file.setncattr("call", MARKUP)
        else:
            file["xi_rel"].setncattr("scale_factor", "x")
            file["xi_rel"].setncattr("units", "days since 0000-99-99")
