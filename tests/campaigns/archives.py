"""Write hostile FMU archives, each from a seeded random generator."""

from __future__ import annotations

import functools
import io
import random
import re
import struct
import warnings
import zipfile
from collections.abc import Callable
from pathlib import Path

Files = dict[str, bytes]
XML = "modelDescription.xml"
LINK = 0o120777 << 16
BOMB = 5 << 28  # bytes that come out of one
CROWD = 70_000  # files
ESCAPES = (  # behind some "../"
    *("{}escaped", "binaries/{}escaped", "resources/x/../../{}escaped", "/tmp/escaped"),
    *(
        "//escaped",
        "..\\escaped",
        "C:\\escaped",
        "C:escaped",
        "{}" + "x" * 200 + "/escaped",
        "./../escaped",
    ),
)
NAMES = (
    *("../../../../../../tmp/escaped", "/tmp/escaped", "a&#10;b&#10;Traceback", "x" * 100_000),
    *("&lt;script&gt;alert(1)&lt;/script&gt;", "&#27;[2J", "", "%s%n%s%n"),
)
ATTRIBUTES = ("modelIdentifier", "modelName", "instantiationToken", "fmiVersion")


def read_archive(fmu: Path) -> Files:
    with zipfile.ZipFile(fmu) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def write_archive(place: Path, files: Files, links: tuple[str, ...] = ()) -> None:
    with zipfile.ZipFile(place, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in files.items():
            entry = zipfile.ZipInfo(name)
            entry.filename = name  # as it stands, NUL and all
            entry.external_attr = LINK if name in links else 0o644 << 16
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, data)


def add_path_traversal(files: Files, chance: random.Random) -> None:
    files[chance.choice(ESCAPES).format("../" * chance.randint(1, 12))] = b"escaped"


def add_crowd(files: Files, chance: random.Random) -> None:
    files.update({f"resources/{i:x}": b"" for i in range(CROWD)})


def add_entities(files: Files, chance: random.Random) -> None:
    """Let the XML grow as it is parsed, or include other files."""
    depth = chance.randint(7, 11)
    more = (f'<!ENTITY e{i} "{10 * f"&e{i - 1};"}">' for i in range(1, depth + 1))
    levels = "".join(['<!ENTITY e0 "lol">', *more])
    secret = '<!ENTITY e SYSTEM "file:///etc/hostname">'
    remote = '<!ENTITY % d SYSTEM "http://127.0.0.1:9/d.dtd"> %d; <!ENTITY e "">'
    document, name = chance.choice(((levels, f"&e{depth};"), (secret, "&e;"), (remote, "&e;")))
    text = files[XML].decode()
    text = re.sub(r"(<\?xml[^>]*>)", rf"\1<!DOCTYPE f [{document}]>", text, count=1)
    files[XML] = re.sub(r'description="[^"]*"', f'description="{name}"', text, count=1).encode()


def set_bad_name(files: Files, chance: random.Random) -> None:
    """Let a name in the description be a path, have a line break, or be markup."""
    attribute, value = chance.choice(ATTRIBUTES), chance.choice(NAMES)
    pattern, text = rf'(\b{attribute}=")[^"]*', files[XML].decode()
    files[XML] = re.sub(pattern, lambda match: match[1] + value, text, count=1).encode()


def nest(files: Files, chance: random.Random) -> None:
    """Nest elements deeply, or add an attribute that is huge."""
    depth = chance.choice((1000, 100_000))
    nested = b"<a>" * depth + b"</a>" * depth
    body = chance.choice((nested, b'<a b="' + b"x" * (depth * 1000) + b'"/>'))
    files[XML] = files[XML].replace(b"<ModelVariables>", b"<ModelVariables>" + body)


def take_parts(files: Files, chance: random.Random) -> None:
    """Leave out the description or the binaries, or fill them with noise."""
    kind = chance.randrange(4)
    noise = chance.choice((b"", b"<", b"\xff\xfe<a/>", b"<html/>", b"\0" * 1000))
    for name in list(files):
        if kind == 0 and name == XML or kind == 1 and name.startswith("binaries/"):
            del files[name]
        elif kind == 2 and "binaries" in name:
            files[name] = chance.randbytes(99)
    if kind == 3:
        files.clear()
        files[XML] = noise


def write_link(fmu: Path, place: Path, chance: random.Random) -> None:
    """Write an FMU with a symbolic link out of the archive, and perhaps a file behind it."""
    name = chance.choice(("resources", "binaries/out", "link"))
    files = read_archive(fmu) | {name: chance.choice((b"/tmp", b"../..", b"/etc/passwd", b"."))}
    if chance.random() < 0.5:
        files[f"{name}/escaped"] = b"escaped"
    write_archive(place, files, (name,))


def write_bomb(fmu: Path, place: Path, chance: random.Random) -> None:
    """Write an FMU of a megabyte that unpacks to over one gigabyte, in one file or many."""
    place.write_bytes(make_bomb(fmu, chance.randrange(3), BOMB >> 24))


@functools.cache
def make_bomb(fmu: Path, kind: int, count: int) -> bytes:
    """Return one large file, many of them, or a large one that claims to be small."""
    zeros, stream = bytes(1 << 24), io.BytesIO()
    files, parts = (count, 1) if kind == 1 else (1, count)
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
        for name, data in read_archive(fmu).items():
            archive.writestr(name, data)
        for i in range(files):
            with archive.open(f"resources/{i}", "w") as file:
                for _ in range(parts):
                    file.write(zeros)
    stated, small = (struct.pack("<I", size) for size in (parts << 24, 16))
    return stream.getvalue().replace(stated, small) if kind == 2 else stream.getvalue()


def write_damaged(fmu: Path, place: Path, chance: random.Random) -> None:
    """Write a copy of an FMU that is cut short or has bytes changed, or noise in its place."""
    data = bytearray(fmu.read_bytes())
    kind = chance.randrange(3)
    if kind == 0:
        del data[chance.randrange(len(data)) :]
    elif kind == 1:
        data = bytearray(chance.randbytes(chance.randrange(10_000)))
    else:
        with zipfile.ZipFile(fmu) as archive:  # not in a text that nobody reads
            first = archive.getinfo(XML).header_offset
        for _ in range(chance.randint(1, 50)):
            place_of = chance.choice((first + chance.randrange(2000), -1 - chance.randrange(2000)))
            data[place_of] ^= 0xFF
    place.write_bytes(data)


def write_name_twice(fmu: Path, place: Path, chance: random.Random) -> None:
    files = read_archive(fmu)
    other = files[XML].replace(b'modelName="', b'modelName="Another')
    write_archive(place, files)
    with zipfile.ZipFile(place, "a") as archive, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        archive.writestr(XML, chance.choice((other, files[XML])))


ALTER: dict[str, Callable[[Files, random.Random], None]] = {
    "path traversal": add_path_traversal,
    "crowd of files": add_crowd,
    "entities": add_entities,
    "name in the description": set_bad_name,
    "nesting": nest,
    "no FMU": take_parts,
}
WRITE: dict[str, Callable[[Path, Path, random.Random], None]] = {
    "link": write_link,
    "bomb": write_bomb,
    "damaged archive": write_damaged,
    "a name twice": write_name_twice,
}
KINDS = (*ALTER, *WRITE)


def write(kind: str, fmu: Path, place: Path, chance: random.Random) -> None:
    if kind in WRITE:
        WRITE[kind](fmu, place, chance)
        return
    files = read_archive(fmu)
    ALTER[kind](files, chance)
    write_archive(place, files)
