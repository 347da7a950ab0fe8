"""Files in an FMU that people read: the model's page, pictures, an icon, reference results."""

from __future__ import annotations

from ..runtime.table import Variable
from .archive import read_folder
from .companions import companion_files, icon_path
from .sources import ROOT, Files, load_model


def documentation_files(
    folder: str, digest: str, form: str, variables: tuple[Variable, ...]
) -> Files:
    """Return ``documentation/`` (the page tells each form's own truth), icon, and companions."""
    import jinja2

    place = ROOT / "models" / folder
    files = read_folder(place / "documentation", "documentation/")
    template = files.pop("documentation/index.html.in").decode()
    environment = jinja2.Environment(
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        keep_trailing_newline=True,
        loader=jinja2.FileSystemLoader(ROOT / "models"),
    )
    model = load_model(folder)
    known = {"model": model, "digest": digest, "form": form, "variables": variables}
    files["documentation/index.html"] = environment.from_string(template).render(known).encode()
    files.update(read_folder(place / "reference", "documentation/reference/"))
    files[icon_path(form[:4])] = (place / "model.png").read_bytes()
    return {**files, **companion_files(model)}
