"""A result in the formats of other tools: CSV, MATLAB and Excel, each file whole or not at all.

=======  =========================================================================================
ending   what
=======  =========================================================================================
csv      a table for each set of dimensions, a row a point, units in the header; where there are
         several, the dimensions are in the files' names
xlsx     the same tables as sheets, and a sheet ``about`` with long names, units and parameters
mat      every variable and coordinate by its name; ``units``, ``long_names``, ``dimensions`` and
         ``attributes`` as structures
=======  =========================================================================================
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..files import write_whole

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

MOST_ROWS = 1_048_575  # of a sheet in Excel, below its header
LONGEST = 31  # letters of a sheet's name


def write(data: xr.Dataset, path: Path) -> list[Path]:
    """Write a dataset in the format that a path's ending names.

    Parameters
    ----------
    data : xarray.Dataset
    path : Path
        With one of the endings of ``WRITERS``.

    Returns
    -------
    list of Path
        Of CSV several where the dataset has variables over several sets of dimensions.

    Raises
    ------
    InputError
        Where the format has no room for the data, or is unknown.
    StoreError
        Where a file cannot be written; what stood there before still does.
    """
    ending = path.suffix.lstrip(".")
    if ending not in WRITERS:
        raise InputError(f"{path}: format {ending!r}; expected one of {', '.join(WRITERS)}")
    return WRITERS[ending](data, path)


def tables(data: xr.Dataset) -> dict[str, pd.DataFrame]:
    """Tables by the dimensions of their variables, the first variable's first; units in headers."""
    groups: dict[tuple[str, ...], list[str]] = {}
    for name, array in data.data_vars.items():
        groups.setdefault(tuple(map(str, array.dims)), []).append(str(name))
    found = {}
    for dims, names in groups.items():
        part = data[names]
        if not dims:
            found["numbers"] = table_of(part)
        else:
            scalars = [name for name, array in part.coords.items() if not array.dims]
            found["_".join(dims)] = table_of(part.drop_vars(scalars))
    return found


def table_of(data: xr.Dataset) -> pd.DataFrame:
    """Variables over the same dimensions, a row a point."""
    import pandas as pd

    words = {name: in_words(array) for name, array in data.variables.items()}
    plain = data.assign({n: (data[n].dims, values) for n, values in words.items()})
    if data.sizes:
        frame = plain.to_dataframe(dim_order=list(next(iter(data.values())).dims)).reset_index()
    else:
        frame = pd.DataFrame(
            {str(n): [array.values.item()] for n, array in plain.variables.items()}
        )
    return frame.rename(columns={name: heading(str(name), data) for name in frame.columns})


def in_words(array: xr.Variable) -> NDArray[Any]:
    """Values as people read them: of flags that are not yes or no, their words."""
    meanings = str(array.attrs.get("flag_meanings", "no yes"))
    if meanings == "no yes":
        return np.asarray(array.values)
    pairs = zip(array.attrs["flag_values"], meanings.split(), strict=True)
    words = {int(value): word.replace("_", " ") for value, word in pairs}
    found = [words.get(int(value), "") for value in np.ravel(array.values)]
    return np.array(found, dtype=object).reshape(array.shape)


def heading(name: str, data: xr.Dataset) -> str:
    """A column's name with its unit: ``x1 [m]``."""
    units = str(data[name].attrs.get("units", "1")) if name in data.variables else "1"
    return name if units == "1" else f"{name} [{units}]"


def write_csv(data: xr.Dataset, path: Path) -> list[Path]:
    """A file a table."""
    found = tables(data)
    written = []
    for name, frame in found.items():
        place = path if len(found) == 1 else path.with_name(f"{path.stem}.{name}.csv")
        written.append(write_whole(place, partial(frame.to_csv, index=False)))
    return written


def write_xlsx(data: xr.Dataset, path: Path) -> list[Path]:
    """A sheet a table, and one about them."""
    import pandas as pd

    found = tables(data)
    for name, frame in found.items():
        if len(frame) > MOST_ROWS:
            raise InputError(
                f"{path}: the table over {name} has {len(frame)} rows, a sheet at most "
                f"{MOST_ROWS}; expected csv, mat or nc"
            )

    def sheets(place: Path) -> None:
        with place.open("wb") as file, pd.ExcelWriter(file, engine="openpyxl") as book:
            for name, frame in found.items():
                frame.to_excel(book, sheet_name=name[:LONGEST], index=False, inf_rep="inf")
            about(data).to_excel(book, sheet_name="about", index=False)

    return [write_whole(path, sheets)]


def about(data: xr.Dataset) -> pd.DataFrame:
    """What names mean: variables with their units, then parameters with their values."""
    import pandas as pd

    rows = [
        (str(name), array.attrs.get("units", ""), array.attrs.get("long_name", ""))
        for name, array in data.variables.items()
    ]
    rows += [(name, "", str(value)) for name, value in data.attrs.items() if name != "identity"]
    return pd.DataFrame(rows, columns=["name", "unit", "what it is"])


def write_mat(data: xr.Dataset, path: Path) -> list[Path]:
    """Arrays by name, structures with what they are."""
    from scipy.io import savemat

    variables = data.variables.items()
    content: dict[str, Any] = {str(name): for_matlab(array.values) for name, array in variables}
    content["units"] = {str(n): str(a.attrs.get("units", "")) for n, a in variables}
    content["long_names"] = {str(n): str(a.attrs.get("long_name", "")) for n, a in variables}
    content["dimensions"] = {str(n): ", ".join(map(str, a.dims)) for n, a in variables}
    content["attributes"] = {name: str(value) for name, value in data.attrs.items()}

    def save(place: Path) -> None:
        with place.open("wb") as file:
            savemat(file, content, long_field_names=True, oned_as="column", do_compression=True)

    return [write_whole(path, save)]


def for_matlab(values: NDArray[Any]) -> NDArray[Any]:
    """Texts as a cell array, anything else as it is."""
    return values.astype(object) if values.dtype.kind in "USO" else values


WRITERS: dict[str, Callable[[xr.Dataset, Path], list[Path]]] = {
    "csv": write_csv,
    "xlsx": write_xlsx,
    "mat": write_mat,
}
