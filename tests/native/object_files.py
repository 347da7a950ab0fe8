"""Small readers of ELF and PE files: what a shared library exports, what it needs, what of it can
be written.
"""

import struct


class Elf:
    """A 64-bit little-endian ELF file.

    Attributes
    ----------
    exports, imports : set of str
        Names of dynamic symbols.
    needed : set of str
        Libraries.
    writable : dict of str to int
        Size of the sections that stay writable once loaded.
    """

    def __init__(self, data):
        assert data[:6] == b"\x7fELF\x02\x01"
        self.data = data
        (offset,) = struct.unpack_from("<Q", data, 0x28)
        size, count, names = struct.unpack_from("<HHH", data, 0x3A)
        rows = [struct.unpack_from("<IIQQQQIIQQ", data, offset + i * size) for i in range(count)]
        texts = rows[names][4]
        self.sections = {self.text(texts + row[0]): row for row in rows}
        self.exports, self.imports, self.needed = set(), set(), set()
        self.read_dynamic()
        self.writable = {
            name: row[5]
            for name, row in self.sections.items()
            if row[2] & 1 and not self.fixed(name)
        }

    @staticmethod
    def fixed(name):
        """Whether the loader makes the section read-only, or it is the compiler's own frame."""
        return name.startswith(
            (".data.rel.ro", ".dynamic", ".got", ".relro_padding", ".init_array", ".fini_array")
        )

    def text(self, offset):
        return self.data[offset : self.data.index(b"\0", offset)].decode()

    def read_dynamic(self):
        if ".dynsym" not in self.sections:
            return
        strings = self.sections[".dynstr"][4]
        start, size = self.sections[".dynsym"][4:6]
        for place in range(start + 24, start + size, 24):
            name, _, _, section = struct.unpack_from("<IBBH", self.data, place)
            (self.exports if section else self.imports).add(self.text(strings + name))
        start, size = self.sections[".dynamic"][4:6]
        for place in range(start, start + size, 16):
            tag, value = struct.unpack_from("<qQ", self.data, place)
            if tag == 1:
                self.needed.add(self.text(strings + value))


class Pe:
    """A 64-bit Windows DLL.

    Attributes
    ----------
    exports : set of str
    imports : dict of str to set of str
        Functions by library.
    """

    def __init__(self, data):
        (header,) = struct.unpack_from("<I", data, 0x3C)
        assert data[header : header + 4] == b"PE\0\0"
        self.machine, count = struct.unpack_from("<HH", data, header + 4)
        (optional,) = struct.unpack_from("<H", data, header + 20)
        assert struct.unpack_from("<H", data, header + 24)[0] == 0x20B
        self.data = data
        sections = header + 24 + optional
        self.rows = [struct.unpack_from("<IIII", data, sections + 40 * i + 8) for i in range(count)]
        directory = header + 24 + 112
        self.exports = self.read_exports(struct.unpack_from("<I", data, directory)[0])
        self.imports = self.read_imports(struct.unpack_from("<I", data, directory + 8)[0])

    def at(self, address):
        """File offset of an address."""
        for size, start, _, place in self.rows:
            if start <= address < start + size:
                return address - start + place
        raise ValueError(address)

    def text(self, address):
        place = self.at(address)
        return self.data[place : self.data.index(b"\0", place)].decode()

    def read_exports(self, address):
        count, _, names = struct.unpack_from("<III", self.data, self.at(address) + 24)
        return {
            self.text(struct.unpack_from("<I", self.data, self.at(names) + 4 * i)[0])
            for i in range(count)
        }

    def read_imports(self, address):
        found, place = {}, self.at(address)
        while True:
            lookup, _, _, name, _ = struct.unpack_from("<IIIII", self.data, place)
            if not name:
                return found
            functions, row = found.setdefault(self.text(name), set()), self.at(lookup)
            while (entry := struct.unpack_from("<Q", self.data, row)[0]) != 0:
                functions.add(
                    self.text((entry & 0x7FFFFFFF) + 2) if not entry >> 63 else f"#{entry & 0xFFFF}"
                )
                row += 8
            place += 20
