"""``documentation/`` and ``model.png`` of an FMU: the model's page, its variable table filled in,
its pictures and reference results.
"""

from pathlib import Path

import jinja2

from .archive import read_folder


def documentation_files(model, folder, digest):
    """Files of the FMU that people read.

    Parameters
    ----------
    model : Model
    folder : Path
        The model's folder: ``documentation/index.html.in`` and its pictures, ``model.png``,
        ``reference/``.
    digest : str
        Fingerprint of the sources.

    Returns
    -------
    dict of str to bytes
    """
    folder = Path(folder)
    files = read_folder(folder / "documentation", "documentation/")
    template = files.pop("documentation/index.html.in").decode()
    environment = jinja2.Environment(
        autoescape=True, undefined=jinja2.StrictUndefined, keep_trailing_newline=True
    )
    page = environment.from_string(template).render(model=model, digest=digest)
    files["documentation/index.html"] = page.encode()
    files.update(read_folder(folder / "reference", "documentation/reference/"))
    files["model.png"] = (folder / "model.png").read_bytes()
    return files
