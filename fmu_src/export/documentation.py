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
    place = ROOT / "models" / folder
    files = read_folder(place / "documentation", "documentation/")
    template = files.pop("documentation/index.html.in").decode()
    files["documentation/index.html"] = model_page(template, folder, digest, form, variables)
    files.update(read_folder(place / "reference", "documentation/reference/"))
    files[icon_path(form[:4])] = (place / "model.png").read_bytes()
    return {**files, **companion_files(load_model(folder))}


def model_page(
    template: str, folder: str, digest: str, form: str, variables: tuple[Variable, ...]
) -> bytes:
    import jinja2

    environment = jinja2.Environment(
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        keep_trailing_newline=True,
        loader=jinja2.FileSystemLoader(ROOT / "models"),
    )
    known = {"digest": digest, "form": form, "variables": variables}
    page = environment.from_string(template).render(model=load_model(folder), **known)
    return page.encode()
