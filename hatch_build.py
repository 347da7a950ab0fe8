"""A wheel carries the FMUs that were built from its own sources, so that it runs without compilers.

For a wheel, not for an editable installation, ``build/FORM/NAME.fmu`` of the source tree becomes
``orchestrate/fmu/fmus/FORM/NAME.fmu``, and ``build/wasm/NAME.wasm``, the kernel for web pages,
``orchestrate/fmu/fmus/wasm/NAME.wasm``; so do ``build/libraries/PLATFORM/``, compiled from the
package's own C sources, for all platforms that are there. What is not there, or was made of other
sources, is left out, and said to be.
"""

from __future__ import annotations

import re
import sys
import zipfile
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

PLACE = "orchestrate/fmu/fmus"


def guid_inside(path: Path) -> str:
    """The GUID that an FMU bears; an empty string where there is none that can be read."""
    try:
        with zipfile.ZipFile(path) as archive:
            text = archive.read("modelDescription.xml").decode()
    except (OSError, KeyError, zipfile.BadZipFile):
        return ""
    found = re.search(r'\b(?:guid|instantiationToken)="([^"]*)"', text)
    return found[1] if found else ""


class CustomBuildHook(BuildHookInterface):
    """Adds the FMUs to a wheel."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Name the files to be included; ``version`` is ``"editable"`` or ``"standard"``."""
        if version == "editable":
            return
        root = Path(self.root)
        sys.path.insert(0, str(root))
        from fmu_src.export import c_library, forms, platforms, webassembly

        for form in forms.FORMS:
            for name in forms.MODELS:
                path = root / "build" / form / f"{name}.fmu"
                if guid_inside(path) == forms.guid(name, form):
                    build_data["force_include"][str(path)] = f"{PLACE}/{form}/{name}.fmu"
                else:
                    self.app.display_warning(f"{path}: none of these sources, left out")
        for name, folder in forms.MODELS.items():
            path = root / "build" / "wasm" / f"{name}.wasm"
            module = path.read_bytes() if path.is_file() else b""
            if webassembly.guid_inside(module) == webassembly.guid(folder):
                build_data["force_include"][str(path)] = f"{PLACE}/wasm/{name}.wasm"
            else:
                self.app.display_warning(f"{path}: none of these sources, left out")
        for source in sorted(c_library.LOOPS.glob("*.c")):
            token = c_library.guid(source)
            for platform in platforms.PLATFORMS:
                path = root / "build" / "libraries" / c_library.file_name(source, platform)
                if c_library.is_current(path, token):
                    for file in (path, c_library.digest_file(path)):
                        place = f"{PLACE}/libraries/{platform}/{file.name}"
                        build_data["force_include"][str(file)] = place
                elif path.exists():
                    self.app.display_warning(f"{path}: none of these sources, left out")
