"""The build backend: hatchling, and a wheel that carries the FMUs and runs without compilers.

For a wheel, not for an editable installation, ``build/FORM/NAME.fmu`` of the source tree becomes
``orchestrate/fmu/fmus/FORM/NAME.fmu``, and ``build/wasm/models.wasm``, models and loops for web
pages, ``orchestrate/fmu/fmus/wasm/models.wasm``; so do ``build/libraries/PLATFORM/``, compiled from
the package's own C sources. What is not there, or was made of other sources, is made first; what
cannot be made is left out, and said to be.
"""

from __future__ import annotations

import re
import sys
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

from hatchling import build as hatchling_build
from hatchling.build import *  # noqa: F403  the backend, but for what is defined here
from hatchling.builders.hooks.plugin.interface import BuildHookInterface

ROOT = Path(__file__).resolve().parent
PLACE = "orchestrate/fmu/fmus"
IMPORTED = ("fmpy", "jinja2")  # by the exporters, beside the extra "build"


def get_requires_for_build_wheel(config_settings: dict[str, Any] | None = None) -> list[str]:
    """Return what making the FMUs of a wheel needs; an editable installation needs none of it."""
    import tomllib

    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    imported = [line for line in project["dependencies"] if line.startswith(IMPORTED)]
    extra = project["optional-dependencies"]["build"]
    return [*hatchling_build.get_requires_for_build_wheel(config_settings), *imported, *extra]


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
        root, self.included = Path(self.root), build_data["force_include"]
        sys.path.insert(0, str(root))
        from fmu_src.export import c_library, forms, platforms, webassembly

        build = root / "build"
        for form in forms.FORMS:
            for name in forms.MODELS:
                path, token = build / form / f"{name}.fmu", forms.fmu_guid(name, form)
                self.include(
                    {path: f"{PLACE}/{form}/{name}.fmu"},
                    lambda path=path, token=token: guid_inside(path) == token,
                    lambda form=form, name=name: forms.export(name, form, build),
                )
        module = build / "wasm" / "models.wasm"
        self.include(
            {module: f"{PLACE}/wasm/{module.name}"},
            lambda: (
                module.is_file()
                and webassembly.guid_inside_module(module.read_bytes()) == webassembly.module_guid()
            ),
            lambda: write(module, webassembly.compile_module()),
        )
        for source in sorted(c_library.LOOPS.glob("*.c")):
            token = c_library.library_guid(source)
            for platform in platforms.PLATFORMS:
                path = build / "libraries" / c_library.library_name(source, platform)
                if platform in platforms.default_platforms() or path.exists():
                    files = path, c_library.digest_path(path)
                    self.include(
                        {one: f"{PLACE}/libraries/{platform}/{one.name}" for one in files},
                        lambda path=path, token=token: c_library.is_current_and_undamaged(
                            path, token
                        ),
                        lambda source=source, platform=platform, path=path: write_library(
                            path, c_library.compile_loop(source, platform)
                        ),
                    )

    def include(
        self, files: dict[Path, str], is_current: Callable[[], bool], make: Callable[[], object]
    ) -> None:
        """Include files at their places in the wheel; make those that are not of these sources."""
        from fmu_src.export.errors import CannotExport

        try:
            if not is_current():
                make()
        except CannotExport as reason:
            self.app.display_warning(f"{next(iter(files))}: left out: {reason}")
        else:
            self.included |= {str(path): place for path, place in files.items()}


def write_library(path: Path, library: bytes) -> None:
    """Write a compiled library with its digest."""
    from fmu_src.export import c_library

    write(path, library)
    write(c_library.digest_path(path), c_library.library_digest(library).encode())


def write(path: Path, content: bytes) -> None:
    """Write a file, and its folder if it is missing."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(content)
