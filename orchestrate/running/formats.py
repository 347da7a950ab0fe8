"""Write any dataset as CSV, MATLAB or Excel file; columns are the variables it happens to have.

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
from ..files import write_atomically
from ..flags import flag_words
from ..lazy import xr
from ..units import in_display_units, with_units

if TYPE_CHECKING:
    import pandas as pd

MAX_SHEET_ROWS = 1_048_575  # Excel's limit, less the header
MAX_SHEET_NAME = 31  # letters, Excel's limit


def write(data: xr.Dataset, path: Path) -> list[Path]:
    """Export a dataset as .csv, .mat or .xlsx, by the path's suffix; return the paths written."""
    ending = path.suffix.lstrip(".")
    if ending not in WRITERS:
        raise InputError(f"{path}: format {ending!r}; expected one of {', '.join(WRITERS)}")
    return WRITERS[ending](data, path)


def tables_by_dimensions(data: xr.Dataset) -> dict[str, pd.DataFrame]:
    data = prepare_for_tables(data)
    groups: dict[tuple[str, ...], list[str]] = {}
    for name, array in data.data_vars.items():
        groups.setdefault(tuple(map(str, array.dims)), []).append(str(name))
    frames = {}
    for dims, names in groups.items():
        part = data[names]
        scalars = [name for name, array in part.coords.items() if dims and not array.dims]
        frames["_".join(dims) or "numbers"] = make_table(part.drop_vars(scalars))
    return frames


def to_dataframe(data: xr.Dataset, units: str = "") -> pd.DataFrame:
    """Return a result as a pandas table, such as the files have it: a row a response.

    Parameters
    ----------
    data : xarray.Dataset
        Any result. What has other rows, as the samples of a sweep, is selected by its names:
        ``to_dataframe(data[["xi_rel"]])``. (xarray's own method of this name repeats each response
        for each sample.)
    units : str
        Such as ``"Hz,mm,g"``; SI by default.

    Returns
    -------
    pandas.DataFrame
        The variables over the same dimensions that are most, with units in the headings, words in
        place of flags (``multiplicity_decided`` says which multiplicities are undecided), and
        converted coordinates of 13 digits.

    Examples
    --------
    >>> from orchestrate import Structure, sweep
    >>> found = sweep(Structure.from_file("beam"), frequency=[95.0, 96.0], amplitude=1e-5)
    >>> table = to_dataframe(found, units="Hz,mm")
    >>> table.shape[0], table.columns[0], table.multiplicity_decided.tolist()
    (2, 'frequency [Hz]', ['repeated', 'repeated'])
    """
    if not getattr(data, "data_vars", None):
        raise InputError(f"data = {data!r}: expected a result, an xarray.Dataset with variables")
    made = tables_by_dimensions(with_units(data, units))
    return max(made.values(), key=lambda table: table.shape[1])


def prepare_for_tables(data: xr.Dataset) -> xr.Dataset:
    """Convert to display units, coordinates to 13 digits; drop a second frequency in Hz."""
    shown = in_display_units(data)
    twice = [
        name
        for name in map(str, shown.variables)
        if name.endswith("hertz")
        and getattr(shown.get(name[:-5] + "frequency"), "attrs", {}).get("units") == "Hz"
    ]
    converted = {
        name: (array.dims, [float(f"{value:.13g}") for value in array.values], array.attrs)
        for name, array in shown.coords.items()
        if array.ndim == 1 and array.attrs.get("units") != data[name].attrs.get("units")
    }
    return shown.assign_coords(converted).drop_vars(twice)


def make_table(data: xr.Dataset) -> pd.DataFrame:
    import pandas as pd

    decoded = {name: decode_flags(array) for name, array in data.variables.items()}
    plain = data.assign({n: (data[n].dims, values) for n, values in decoded.items()})
    if data.sizes:
        frame = plain.to_dataframe(dim_order=list(next(iter(data.values())).dims)).reset_index()
    else:
        items = {str(name): [array.values.item()] for name, array in plain.variables.items()}
        frame = pd.DataFrame(items)
    units = {name: array.attrs.get("units", "1") for name, array in data.variables.items()}
    headings = {name: f"{name} [{unit}]" for name, unit in units.items() if unit != "1"}
    return frame.rename(columns=headings)


def decode_flags(array: xr.Variable) -> NDArray[Any]:
    """Return a variable's values; those of CF flags are replaced by words, yes/no stay numbers."""
    meanings = str(array.attrs.get("flag_meanings", "no yes"))
    if meanings == "no yes":
        return np.asarray(array.values)
    words = flag_words(array.attrs)
    decoded = [words.get(int(value), "") for value in np.ravel(array.values)]
    return np.array(decoded, dtype=object).reshape(array.shape)


def write_csv(data: xr.Dataset, path: Path) -> list[Path]:
    frames = tables_by_dimensions(data)
    written = []
    for name, frame in frames.items():
        file = path if len(frames) == 1 else path.with_name(f"{path.stem}.{name}.csv")
        written.append(write_atomically(file, partial(frame.to_csv, index=False)))
    return written


def write_xlsx(data: xr.Dataset, path: Path) -> list[Path]:
    import pandas as pd

    frames = tables_by_dimensions(data)
    for name, frame in frames.items():
        if len(frame) > MAX_SHEET_ROWS:
            text = f"the table over {name} has {len(frame)} rows, a sheet at most {MAX_SHEET_ROWS}"
            raise InputError(f"{path}: {text}; expected csv, mat or nc")

    def write_sheets(path_to_write: Path) -> None:
        with path_to_write.open("wb") as file, pd.ExcelWriter(file, engine="openpyxl") as book:
            for name, frame in frames.items():
                frame.to_excel(book, sheet_name=name[:MAX_SHEET_NAME], index=False, inf_rep="inf")
            metadata_table(data).to_excel(book, sheet_name="about", index=False)
            for cell in (c for sheet in book.sheets.values() for row in sheet for c in row):
                if isinstance(cell.value, str):  # openpyxl takes =1+1 and #REF! for formulas
                    cell.data_type = "s"

    return [write_atomically(path, write_sheets)]


def metadata_table(data: xr.Dataset) -> pd.DataFrame:
    import pandas as pd

    data = in_display_units(data)
    rows = [
        (str(name), array.attrs.get("units", ""), array.attrs.get("long_name", ""))
        for name, array in data.variables.items()
    ]
    rows += [(name, "", str(value)) for name, value in data.attrs.items() if name != "identity"]
    return pd.DataFrame(rows, columns=["name", "unit", "what it is"])


def write_mat(data: xr.Dataset, path: Path) -> list[Path]:
    from scipy.io import savemat

    variables = data.variables.items()
    content: dict[str, Any] = {  # MATLAB's cell arrays of texts are arrays of objects
        str(name): array.values.astype(object) if array.dtype.kind in "USO" else array.values
        for name, array in variables
    }
    content["units"] = {str(n): str(a.attrs.get("units", "")) for n, a in variables}
    content["long_names"] = {str(n): str(a.attrs.get("long_name", "")) for n, a in variables}
    content["dimensions"] = {str(n): ", ".join(map(str, a.dims)) for n, a in variables}
    content["attributes"] = {name: str(value) for name, value in data.attrs.items()}

    def write_variables(path_to_write: Path) -> None:
        with path_to_write.open("wb") as file:
            savemat(file, content, long_field_names=True, oned_as="column", do_compression=True)

    return [write_atomically(path, write_variables)]


WRITERS: dict[str, Callable[[xr.Dataset, Path], list[Path]]] = {
    "csv": write_csv,
    "xlsx": write_xlsx,
    "mat": write_mat,
}
