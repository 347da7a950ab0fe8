"""Pictures on disk, whole or not at all."""

from pathlib import Path


def write(figure, path, **options):
    """Write a figure.

    Parameters
    ----------
    figure : matplotlib.figure.Figure
    path : Path
    **options
        Of matplotlib's ``savefig``.
    """
    temporary = Path(path).with_name(Path(path).name + ".tmp")
    try:
        figure.savefig(temporary, **options)
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)
