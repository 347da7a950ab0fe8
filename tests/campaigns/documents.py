"""Write hostile results in NetCDF from a seeded random generator."""

import json
import random
from pathlib import Path

from tests.faults import FILE_DAMAGE

MARKUP = "</script><script>alert(1)</script><img src=x onerror=alert(1)>"
LINES = "one\ntwo\r\nTraceback (most recent call last):\x1b[2J"


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
