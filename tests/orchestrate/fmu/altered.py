"""FMUs that differ from ours in their description."""

import zipfile
from pathlib import Path


def altered_fmu(source: Path, target: Path, **changes: tuple[str, str]) -> Path:
    with zipfile.ZipFile(source) as old, zipfile.ZipFile(target, "w") as new:
        for name in old.namelist():
            content = old.read(name)
            if name == "modelDescription.xml":
                for attribute, (before, after) in changes.items():
                    replaced = f'{attribute}="{before}"'.encode()
                    assert replaced in content
                    content = content.replace(replaced, f'{attribute}="{after}"'.encode())
            new.writestr(name, content)
    return target
