"""The C sources inside a native FMU: for targets without a binary, and for those who read them."""

from __future__ import annotations

import functools
from xml.etree import ElementTree as ET

from . import description_common
from .sources import Files, load_model
from .translation.kernel import translate

OPTIONS = (
    "-ffp-contract=off -fno-math-errno"  # for the bits, and the square root as one instruction
)
CMAKE = """\
# The FMU's library, for the machine and compiler at hand: cmake -B build && cmake --build build
cmake_minimum_required(VERSION 3.10)
project({name} C)
set(CMAKE_C_STANDARD 99)
if(NOT CMAKE_BUILD_TYPE)
    set(CMAKE_BUILD_TYPE Release)
endif()
add_library({name} SHARED {units})
set_target_properties({name} PROPERTIES PREFIX "")
if(NOT MSVC)
    target_compile_options({name} PRIVATE {options})
endif()
if(UNIX)
    target_link_libraries({name} PRIVATE m)
endif()
"""


@functools.cache
def kernel_c_source(folder: str) -> bytes:
    return translate(load_model(folder).entry_points).encode()


def c_file_names(files: Files) -> list[str]:
    return sorted(name for name in files if name.endswith(".c"))


def sources_folder(name: str, version: str, files: Files) -> Files:
    """Return the files below ``sources/``: C sources, and how to build them."""
    cmake = CMAKE.format(name=name, units=" ".join(c_file_names(files)), options=OPTIONS)
    inside = {**files, "CMakeLists.txt": cmake.encode()}
    if version == "fmi3":
        root = ET.Element("fmiBuildDescription", fmiVersion="3.0")
        configuration = ET.SubElement(root, "BuildConfiguration", modelIdentifier=name)
        attributes = {"language": "C99", "compilerOptions": OPTIONS}
        several = ET.SubElement(configuration, "SourceFileSet", attributes)
        for source in c_file_names(files):
            ET.SubElement(several, "SourceFile", name=source)
        inside["buildDescription.xml"] = description_common.xml_bytes(root)
    return {f"sources/{file}": content for file, content in inside.items()}
