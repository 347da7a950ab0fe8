"""Records as files: CSV, universal files, MAT, LabVIEW's, NetCDF, WAV."""

from __future__ import annotations

import os
import stat
import warnings
from collections.abc import Callable
from pathlib import Path

import numpy as np

from ..errors import InputError, printable_line
from ..files import check_path_encoding, format_read_error, write_atomically
from ..lazy import xr
from ..model.arguments import checked_path
from ..reader_process import read_in_process
from ..running.netcdf import check_unpacked_size, unpacked_size
from .analysis.channels import NAMES_IN_RESULTS
from .columns import Column, Columns, convert_to_si
from .conversion import SMALLEST, ByChannel, number_by_channel
from .record import CHANNELS, FORCES, ReadingOptions, make_record, unit_of_channel
from .record_csv import read_csv, write_csv
from .record_labview import read_lvm, read_tdms
from .record_mat import read_mat, write_mat
from .record_uff import read_uff, write_uff
from .stated_channels import Channels, ChannelSetup

MOST_BYTES = 1 << 30  # a file is read into the memory as a whole
MOST_LETTERS = 200  # of a name or a unit
ENDINGS = {
    **dict.fromkeys((".csv", ".txt", ".tsv", ".asc", ".dat"), "csv"),
    **dict.fromkeys((".uff", ".unv", ".uf", ".58"), "uff"),
    **{".mat": "mat", ".nc": "netcdf", ".wav": "wav", ".lvm": "lvm", ".tdms": "tdms"},
}


def read_record(
    path: str | os.PathLike[str],
    channels: Channels = None,
    *,
    unit: ByChannel = None,
    sensitivity: ByChannel = None,
    sample_rate: float | None = None,
    scale: ByChannel = None,
    delay: ByChannel = None,
    resample: bool = False,
) -> xr.Dataset:
    r"""Read a measurement from a file.

    Parameters
    ----------
    path : path-like
        Its ending says what it is: ``.csv``, ``.txt``, ``.tsv``, ``.asc``, ``.dat`` (text),
        ``.uff``, ``.unv`` (universal files, datasets 58 and 58b), ``.mat`` (MATLAB's up to
        version 7.2, structures too), ``.lvm`` and ``.tdms`` (LabVIEW), ``.nc`` (NetCDF), ``.wav``.
    channels : path-like, mapping, sequence or str, optional
        Which column ``time``, ``base``, ``face1``, ``face2``, ``force1`` and ``force2`` are in, by
        name or by number from 0: a mapping, a text such as ``"base=Table,face1=3"``, or a sequence
        in that order without forces. In place of a column a mapping may have ``column``, ``unit``,
        ``sensitivity``, ``scale``, ``delay`` and, kept as attributes of the channel, ``sensor``,
        ``serial_number``, ``calibrated``; besides the channels ``sample_rate`` and ``resample``. Or
        the path of a TOML file with the same, as :func:`orchestrate.channels` writes it. By default
        columns with these names or others that are usual; one or two that are left are proposed as
        faces, in their order, with a warning; where no name is known, the first ones in that order.
        A time that is not named is in the column of that name, else in the first.
    unit : str or mapping of str to str, optional
        Of all channels, or by channel (``{"face1": "mm/s"}``, ``"base=V,face=mm/s"``, of all
        faces): of an acceleration, velocity, displacement or voltage; before that of ``channels``,
        as are the next ones. By default what stands in the file, which must be there. Of
        ``time`` (``"time=us"``) too; without any, s.
    sensitivity : str or mapping of str to str, optional
        Of voltages, such as ``"100 mV/g"`` or ``"base=100 mV/g,face1=50 mV/(mm/s)"``.
    sample_rate : float, optional
        Hz; where there is no column of times, or its times are rounded.
    scale : float or mapping of str to float, optional
        Factor, such as ``{"face1": -1}`` where a sensor is the wrong way up. Of a WAV file, which
        must have it: m/s2 at the full scale.
    delay : float or mapping of str to float, optional
        s by which a channel is late. The record is cut to the samples that all channels have then
        (attribute ``cut``).
    resample : bool
        Whether uneven times become equal, by the cubic spline through the samples.

    Returns
    -------
    xarray.Dataset
        As :func:`orchestrate.record` makes it. Attributes say how it was read: ``columns``, which
        column was taken for what; ``unit``, that of the accelerations; ``unit_in_file``, what the
        file says where ``unit`` was taken in its place.

    Raises
    ------
    InputError
        Where the file is damaged, empty, too large, or its numbers are no record; in one line
        with column and row.

    Notes
    -----
    A velocity or a displacement is differentiated by its spectrum, up to half the sampling rate;
    the attribute ``converted`` says so. Times rounded to ten steps or less are recognised and
    become equal; ``time_base`` says what was done, and the jitter of resampled ones.
    A file is read in a process of its own, with limits of time and memory: one that is damaged, or
    made to do harm, is refused in a line.

    Examples
    --------
    >>> import tempfile, pathlib
    >>> path = pathlib.Path(tempfile.mkdtemp()) / "base.csv"
    >>> _ = path.write_text("t [ms];base [g]\n0;0,1\n1;0,3\n2;-0,2\n3;0,0\n")
    >>> read_record(path).box_acceleration.values.round(4).tolist()
    [0.9807, 2.942, -1.9613, 0.0]
    """
    path, setup = checked_path("path", path), ChannelSetup.from_argument(channels)
    rate = setup.sample_rate if sample_rate is None else sample_rate
    table, kind = read_columns_in_process(path).with_sample_rate(rate), file_kind(path)
    stated = setup.merge_keywords(unit=unit, sensitivity=sensitivity, scale=scale, delay=delay)
    if kind == "wav" and not stated["scale"]:
        raise InputError(f"{path}: no scale=; expected for a WAV file: m/s2 at its full scale")
    units = stated["unit"], stated["sensitivity"]
    time, values, derivatives, read_as = convert_to_si(table, setup.columns, *units, setup.file)
    if time is None and table.sample_rate is None:
        raise InputError(f"{path}: no column of times; expected one, or sample_rate=")
    words = {"title": f"Record {path.name}", "source": path.name, **table.attributes}
    if kind != "netcdf" or stated["unit"] is not None:  # it says how it was read the first time
        words |= read_as
    reading = ReadingOptions(
        table.first_row,
        resample or setup.resample,
        derivatives,
        number_by_channel("scale", stated["scale"], list(values), SMALLEST),
        number_by_channel("delay", stated["delay"], list(values)),
    )
    try:
        made = make_record(time, values, table.sample_rate, words, reading)
    except InputError as error:
        raise InputError(f"{path}: {error}") from None
    for name in values:
        made[name].attrs |= setup.sensor_attributes(name)
    return made


def write_record(data: xr.Dataset, path: str | os.PathLike[str], *, binary: bool = True) -> Path:
    """Write a record to a file, which appears whole or not at all.

    Parameters
    ----------
    data : xarray.Dataset
        As :func:`orchestrate.record` makes it.
    path : path-like
        Its ending says what it is to be, as for :func:`read_record`; WAV and LabVIEW's are not
        written. CSV, MAT, NetCDF and universal files with ``binary`` have all digits; without, 13.
    binary : bool
        Of universal files: datasets 58b.

    Returns
    -------
    Path

    Raises
    ------
    InputError, StoreError

    Examples
    --------
    >>> import tempfile, pathlib
    >>> from orchestrate import record
    >>> data = record(box_acceleration=[0.0, 1.0, 0.1, -1.0], sample_rate=1000.0)
    >>> path = write_record(data, pathlib.Path(tempfile.mkdtemp()) / "base.csv")
    >>> read_record(path).box_acceleration.equals(data.box_acceleration)
    True
    """
    path = checked_path("path", path)
    kind = file_kind(path)
    check_path_encoding(path)
    channels = [name for name in CHANNELS if name in getattr(data, "variables", {})]
    if not channels or "sample_rate" not in data.attrs:
        raise InputError("data: expected a record, with a channel and the attribute sample_rate")
    columns = [Column("time", "s", data.time.values)]
    columns += [Column(name, unit_of_channel(name), data[name].values) for name in channels]
    rate = float(data.attrs["sample_rate"])
    if kind in ("wav", "lvm", "tdms"):
        raise InputError(f"{path}: {kind.upper()} is only read; expected .csv, .uff, .mat or .nc")
    if kind == "csv":
        return write_atomically(path, lambda temporary: write_csv(temporary, columns))
    if kind == "uff":
        return write_atomically(path, lambda temporary: write_uff(temporary, columns, rate, binary))
    if kind == "mat":
        return write_atomically(path, lambda temporary: write_mat(temporary, columns, rate))
    return write_atomically(path, lambda temporary: data.to_netcdf(temporary, engine="netcdf4"))


def file_kind(path: Path) -> str:
    if path.suffix.lower() not in ENDINGS:
        text = f"expected a file that ends in {', '.join(ENDINGS)}"
        text += "; a structure= or channels= file is given so" * (path.suffix == ".toml")
        raise InputError(f"{path}: {text}")
    return ENDINGS[path.suffix.lower()]


def check_readable_file(path: Path) -> None:
    """Raise unless a path is an ordinary file, not empty and not too large to read."""
    try:
        status = path.stat()
    except OSError as error:
        raise InputError(f"{path}: {format_read_error(error)}; expected a record") from None
    if not stat.S_ISREG(status.st_mode):
        raise InputError(f"{path}: no ordinary file; expected one")
    if not 0 < status.st_size <= MOST_BYTES:
        text = f"expected 1 to {MOST_BYTES}: cut it, or write it as .nc"
        raise InputError(f"{path}: {status.st_size} bytes; {text}")


def read_netcdf(path: Path) -> Columns:
    """Read the variables over ``time`` of a NetCDF file, with their units."""
    import netCDF4

    with netCDF4.Dataset(path) as file:
        check_unpacked_size(path, unpacked_size(file))
        over_time = {n: one for n, one in file.variables.items() if one.dimensions == ("time",)}
        if "time" not in over_time:
            kind = getattr(file, "question", "")
            what = f"a result of {kind}" if kind else "no variable time over itself"
            raise InputError(f"{path}: {what}; expected a record")
        names = dict(zip(over_time, over_time, strict=True))
        if "a1_abs" in file.variables:  # a result of shake
            if "impact" in file.dimensions and file.dimensions["impact"].size:
                text = "simulated accelerations leave out the impacts"
                expected = "what sensors read of it: shake --sensor HZ, or measure, writes that"
                raise InputError(f"{path}: {text}; expected {expected}")
            names = {"time": "time", **{stored: name for name, stored in NAMES_IN_RESULTS.items()}}
            names |= {name: name for name in FORCES}
        columns = []
        for stored, name in names.items():
            if (one := over_time.get(stored)) is not None and one.dtype.kind in "iuf":
                values = np.ma.filled(one[...].astype(float), np.nan)
                columns.append(Column(name, str(getattr(one, "units", "")), values))
        attributes = {name: file.getncattr(name) for name in file.ncattrs()}
    rate = attributes.get("sample_rate")
    rate = None if rate is None else float(rate)
    is_own = {"sensors", "source"} <= set(attributes)
    return Columns(str(path), columns, rate, attributes=attributes if is_own else {})


def read_wav(path: Path) -> Columns:
    """Read the channels of a WAV file; whole numbers become parts of the full scale."""
    from scipy.io import wavfile

    with warnings.catch_warnings():
        warnings.filterwarnings("error", message="Reached EOF prematurely")
        rate, data = wavfile.read(path)
    values = np.asarray(data, float)
    if not values.size:
        raise InputError(f"{path}: no samples; expected some")
    if data.dtype.kind == "u":  # of 8 bits: 128 is zero
        values = (values - 128.0) / 128.0
    elif data.dtype.kind == "i":
        values = values / -float(np.iinfo(data.dtype).min)
    channels = values.reshape(len(values), -1).T
    made = [Column(f"channel {i}", "m/s2", one) for i, one in enumerate(channels)]
    return Columns(str(path), made, float(rate))


READERS: dict[str, tuple[Callable[..., Columns], str]] = {  # and what they expect
    "csv": (read_csv, "columns of numbers"),
    "uff": (read_uff, "a universal file that is whole"),
    "mat": (read_mat, "a MAT file that is whole"),
    "netcdf": (read_netcdf, "a NetCDF file that is whole"),
    "wav": (read_wav, "a WAV file that is whole"),
    "lvm": (read_lvm, "a .lvm file that is whole"),
    "tdms": (read_tdms, "a .tdms file that is whole"),
}
# readers that a damaged file may harm so that they misread the next one
COMPILED = ("mat", "netcdf")


def read_columns_in_process(path: Path, *arguments: object) -> Columns:
    """Read the columns of a file in a process of its own; make names and texts printable."""
    kind = file_kind(path)
    check_readable_file(path)
    (reader, expected), keep = READERS[kind], kind not in COMPILED
    expected = f"expected {expected}"
    content = read_in_process(reader, path, *arguments, expected=expected, keep_process=keep)
    columns = []
    for column in content["columns"]:
        texts = {key: one for key, one in column.items() if isinstance(one, str)}
        printable = {key: printable_line(text, MOST_LETTERS) for key, text in texts.items()}
        columns.append(Column(**column | printable))
    return Columns(**content | {"path": str(path), "columns": columns})
