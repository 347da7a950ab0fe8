"""Write hostile TOML, CSV and NetCDF, each from a seeded random generator."""

import json
import math
import random
from pathlib import Path

import numpy as np
import xarray as xr

from tests.faults import FILE_DAMAGE

CANARY = "window.canary = 1; document.title = 'canary'; alert(1)"
MARKUP = "</script><script>alert(1)</script><img src=x onerror=alert(1)>"
LINES = "one\ntwo\r\nTraceback (most recent call last):\x1b[2J"
KEPT = ("start", "direction", "over")  # texts that have to be what they are, or there is no page
PAYLOADS = (  # run a script or request ADDRESS if taken for markup
    f"</script><script>{CANARY}</script>",
    f"<script>{CANARY}</script>",
    f'<img src=x onerror="{CANARY}">',
    f'<svg onload="{CANARY}"></svg>',
    f"--></style></title></textarea><script>{CANARY}</script>",
    f'" autofocus onfocus="{CANARY}',
    f"' onmouseover='{CANARY}' '",
    f'<iframe srcdoc="<script>parent.{CANARY}</script>"></iframe>',
    f'<iframe src="javascript:parent.{CANARY}"></iframe>',
    "<script src='ADDRESS'></script>",
    "<script>fetch('ADDRESS')</script>",
    '<img src="ADDRESS">',
    "<style>@import 'ADDRESS';</style>",
    '<link rel=stylesheet href="ADDRESS">',
    '<meta http-equiv=refresh content="0;url=ADDRESS">',
    '<base href="ADDRESS">',
    '<object data="ADDRESS"></object>',
    f"<!--<script>{CANARY}",
    f"&lt;/script&gt;&lt;script&gt;{CANARY}&lt;/script&gt;",
    f"\\u003c/script\\u003e\\u003cscript\\u003e{CANARY}\\u003c/script\\u003e",
    f"{{{{ ''.__class__ }}}}{{% print 7 %}}<script>{CANARY}</script>",
    f"`${{{CANARY}}}`",
    f"\u2028{CANARY}\u2029<script>{CANARY}</script>",
    f"<scr<script>ipt>{CANARY}</scr</script>ipt>",
)


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


def pick_text(chance: random.Random, address: str) -> str:
    """Return one of the hostile texts, alone or inside another text."""
    text, other = (chance.choice(PAYLOADS).replace("ADDRESS", address) for _ in "ab")
    return chance.choice((text, f"vibroimpact 0.2.0{text}", f"{text}{other[:80]}"))


def write_forged_sweep(
    place: Path, chance: random.Random, good: xr.Dataset, address: str, wrong: bool
) -> None:
    """Write a sweep's result whose texts are markup; `wrong`: one number makes no sense too."""
    data = good.copy()
    texts = [str(name) for name, value in data.attrs.items() if isinstance(value, str)]
    texts = [name for name in texts if name not in KEPT]
    chosen = texts if chance.random() < 0.3 else chance.sample(texts, chance.randint(1, 4))
    data.attrs |= {name: pick_text(chance, address) for name in chosen}
    if "identity" in chosen:
        data.attrs["identity"] = json.dumps({"question": pick_text(chance, address)})
    for array in data.variables.values():
        array.attrs = {name: pick_text(chance, address) for name in array.attrs}
    if chance.random() < 0.5:
        letters = [letter for letter in pick_text(chance, address) if letter.isprintable()]
        name = "x" + "".join(letters).replace("/", "|").strip()[:200]
        data.attrs[name] = "a name that is markup"
    senseless = (math.nan, math.inf, -1.0, 0.0, 1e308, 5e-324, "heavy")
    if wrong and chance.random() < 0.6:
        names = ("m1", "m2", "k1", "d2", "e", "gamma", "bonded", "transient", "samples")
        name = chance.choice((*names, "tolerance", "start", "direction"))
        data.attrs[name] = chance.choice((*senseless, [1.0, 2.0], "[nan, 0, 0, 0]"))
    elif wrong:
        name = chance.choice(("eta", "frequency", "amplitude", "end_state"))
        value = np.full(data[name].shape, chance.choice(senseless))
        data = data.assign({name: (data[name].dims, value)})
    write_netcdf(place, data)


def write_forged_branch(place: Path, chance: random.Random, good: xr.Dataset, address: str) -> None:
    """Write a branch's result whose kinds of bifurcation are markup."""
    data = good.copy()
    kinds = data.bifurcation_kind
    words = [pick_text(chance, address) for _ in np.atleast_1d(kinds.flag_values)]
    kinds.attrs["flag_meanings"] = " ".join("\xa0".join(word.split()) for word in words)
    data.attrs |= {name: pick_text(chance, address) for name in ("call", "source", "history")}
    write_netcdf(place, data)


def write_netcdf(place: Path, data: xr.Dataset) -> None:
    """Write a dataset as it stands."""
    data.to_netcdf(place, engine="netcdf4", encoding={name: {} for name in data.variables})


def hostile_fragment(chance: random.Random, address: str) -> str:
    """Return a hostile text for the part of a link after its #."""
    from urllib.parse import quote

    text = quote(pick_text(chance, address))
    name = chance.choice(("direction", "e", "eta", "from", "start", "m1"))
    return chance.choice(("", f"#{text}", f"#eta=1.05&{name}={text}"))
