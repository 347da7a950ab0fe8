"""Write hostile FMU archives, each from a seeded random generator."""

from __future__ import annotations

import functools
import io
import random
import re
import struct
import zipfile
from collections.abc import Callable
from pathlib import Path

Make = Callable[[Path, Path, random.Random], None]  # from a good FMU, to a place
XML = "modelDescription.xml"
LINK = 0o120777 << 16
BOMB = 5 << 28  # bytes that come out of one
CROWD = 70_000  # files


def read_archive(fmu: Path) -> dict[str, bytes]:
    """Return a dict from name to bytes of the files in an FMU."""
    with zipfile.ZipFile(fmu) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def write_archive(
    place: Path, files: dict[str, bytes], attributes: dict[str, int] | None = None
) -> None:
    """Write files as an FMU archive; ``attributes`` say which of them are links."""
    with zipfile.ZipFile(place, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in files.items():
            entry = zipfile.ZipInfo(name)
            entry.filename = name  # as it stands, NUL and all
            entry.external_attr = (attributes or {}).get(name, 0o644 << 16)
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, data)


def write_path_traversal(fmu: Path, place: Path, chance: random.Random) -> None:
    """Write an FMU with a file whose path leads out of the archive."""
    ups = "../" * chance.randint(1, 12)
    name = chance.choice(
        (
            f"{ups}escaped",
            f"binaries/{ups}escaped",
            f"resources/x/../../{ups}escaped",
            "/tmp/escaped",
            "//escaped",
            "..\\escaped",
            "C:\\escaped",
            "C:escaped",
            f"{ups}{'x' * 200}/escaped",
            "./../escaped",
        )
    )
    write_archive(place, {**read_archive(fmu), name: b"escaped"})


def write_symlink(fmu: Path, place: Path, chance: random.Random) -> None:
    """Write an FMU with a symbolic link out of the archive, and a file behind it."""
    name = chance.choice(("resources", "binaries/out", "link"))
    target = chance.choice(("/tmp", "../..", "/etc/passwd", ".")).encode()
    files = {**read_archive(fmu), name: target, f"{name}/escaped": b"escaped"}
    if chance.random() < 0.5:
        files.pop(f"{name}/escaped")
    write_archive(place, files, {name: LINK})


def write_zip_bomb(fmu: Path, place: Path, chance: random.Random) -> None:
    """Write an FMU of a megabyte that unpacks to over one gigabyte, in one file or many."""
    place.write_bytes(make_bomb_files(fmu, chance.randrange(3)))


@functools.cache
def make_bomb_files(fmu: Path, kind: int) -> bytes:
    """Return one large file, many of them, or a large one that claims to be small."""
    zeros, stream = bytes(1 << 24), io.BytesIO()
    count = BOMB >> 24
    files, parts = (count, 1) if kind == 1 else (1, count)
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
        for name, data in read_archive(fmu).items():
            archive.writestr(name, data)
        for i in range(files):
            with archive.open(f"resources/{i}", "w") as file:
                for _ in range(parts):
                    file.write(zeros)
    data = stream.getvalue()
    said = struct.pack("<I", parts << 24)
    return data.replace(said, struct.pack("<I", 16)) if kind == 2 else data


def write_many_files(fmu: Path, place: Path, chance: random.Random) -> None:
    """Write an FMU with more files than any model has."""
    extra = {f"resources/{i:x}": b"" for i in range(CROWD)}
    write_archive(place, {**read_archive(fmu), **extra})


def write_xml_entities(fmu: Path, place: Path, chance: random.Random) -> None:
    """Write an FMU whose XML grows as it is parsed, or includes other files."""
    files = read_archive(fmu)
    levels = "".join(
        f'<!ENTITY e{i} "{"&e" + str(i - 1) + ";" if i else "lol"}'
        f'{("&e" + str(i - 1) + ";") * 9 if i else ""}">'
        for i in range(chance.randint(8, 12))
    )
    depth = levels.count("ENTITY") - 1
    kind = chance.randrange(3)
    secret = '<!ENTITY e SYSTEM "file:///etc/hostname">'
    remote = '<!ENTITY % d SYSTEM "http://127.0.0.1:9/d.dtd"> %d; <!ENTITY e "">'
    document = (levels, secret, remote)[kind]
    name = (f"&e{depth};", "&e;", "&e;")[kind]
    text = files[XML].decode()
    text = re.sub(r"(<\?xml[^>]*>)", rf"\1<!DOCTYPE f [{document}]>", text, count=1)
    files[XML] = re.sub(r'description="[^"]*"', f'description="{name}"', text, count=1).encode()
    write_archive(place, files)


def write_bad_name(fmu: Path, place: Path, chance: random.Random) -> None:
    """Write an FMU whose model name is a path, has a line break, or is markup."""
    files = read_archive(fmu)
    text = files[XML].decode()
    attribute = chance.choice(("modelIdentifier", "modelName", "instantiationToken", "fmiVersion"))
    value = chance.choice(
        (
            "../../../../../../tmp/escaped",
            "/tmp/escaped",
            "a&#10;b&#10;Traceback",
            "&lt;script&gt;alert(1)&lt;/script&gt;",
            "x" * 100_000,
            "&#27;[2J",
            "",
            "%s%n%s%n",
        )
    )
    changed = re.sub(rf'(\b{attribute}=")[^"]*', lambda m: m[1] + value, text, count=1)
    write_archive(place, {**files, XML: changed.encode()})


def write_deep_xml(fmu: Path, place: Path, chance: random.Random) -> None:
    """Write an FMU with deeply nested elements or huge attributes."""
    files = read_archive(fmu)
    depth = chance.choice((1000, 100_000))
    if chance.random() < 0.5:
        body = b"<a>" * depth + b"</a>" * depth
    else:
        body = b'<a b="' + b"x" * (depth * 1000) + b'"/>'
    files[XML] = files[XML].replace(b"<ModelVariables>", b"<ModelVariables>" + body)
    write_archive(place, files)


def write_damaged(fmu: Path, place: Path, chance: random.Random) -> None:
    """Write a copy of an FMU that is cut short or has bytes changed."""
    data = bytearray(fmu.read_bytes())
    if chance.random() < 0.4:
        place.write_bytes(data[: chance.randrange(len(data))])
        return
    with zipfile.ZipFile(fmu) as archive:  # where a change is not in a text that nobody reads
        first = archive.getinfo(XML).header_offset
    for _ in range(chance.randint(1, 50)):
        data[chance.choice((first + chance.randrange(2000), -1 - chance.randrange(2000)))] ^= 0xFF
    place.write_bytes(data)


def write_not_an_fmu(fmu: Path, place: Path, chance: random.Random) -> None:
    """Write a file that is no archive, or an archive that lacks parts of an FMU."""
    files = read_archive(fmu)
    kind = chance.randrange(5)
    if kind == 0:
        place.write_bytes(chance.randbytes(chance.randrange(10_000)))
    elif kind == 1:
        write_archive(place, {name: data for name, data in files.items() if name != XML})
    elif kind == 2:
        write_archive(
            place, {XML: chance.choice((b"", b"<", b"\xff\xfe<a/>", b"<html/>", b"\0" * 1000))}
        )
    elif kind == 3:
        write_archive(place, {n: d for n, d in files.items() if not n.startswith("binaries/")})
    else:
        write_archive(
            place, {n: chance.randbytes(99) if "binaries" in n else d for n, d in files.items()}
        )


def write_two_descriptions(fmu: Path, place: Path, chance: random.Random) -> None:
    """Write an FMU with two model descriptions of the same name."""
    files = read_archive(fmu)
    other = files[XML].replace(b'modelName="', b'modelName="Another')
    with zipfile.ZipFile(place, "w") as archive:
        for name, data in files.items():
            archive.writestr(name, data)
        import warnings

        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            archive.writestr(XML, other if chance.random() < 0.5 else files[XML])


KINDS: dict[str, Make] = {
    "path traversal": write_path_traversal,
    "link": write_symlink,
    "bomb": write_zip_bomb,
    "crowd of files": write_many_files,
    "entities": write_xml_entities,
    "name in the description": write_bad_name,
    "nesting": write_deep_xml,
    "damaged archive": write_damaged,
    "no FMU": write_not_an_fmu,
    "a name twice": write_two_descriptions,
}
