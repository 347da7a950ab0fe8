"""NetCDF results of others: read elsewhere, the same dataset as the library's, or one line."""

import netCDF4
import numpy as np
import pytest
import xarray as xr

from orchestrate.errors import StoreError
from orchestrate.running.store import load_foreign_result, load_result, write_netcdf


def test_a_result_of_others_is_the_library_s_dataset(tmp_path):
    path, time = tmp_path / "a.nc", np.arange(4.0)
    data = xr.Dataset(
        {
            "words": ("time", np.array(["one", "", "\u03b7", "four"], object)),
            "letters": ("time", np.array([b"ab", b"c", b"", b"d"])),
            "flags": ("time", np.array([True, False, True, True]), {"units": "1"}),
            "packed": ("time", [1.0, np.nan, 2.0, 3.0], {"long_name": "packed"}),
            "whole": (("time", "n"), np.arange(8, dtype=np.int16).reshape(4, 2)),
            "moment": ("time", time.astype("datetime64[s]")),
            "number": ((), 2.5),
            "label": ((), "text"),
            "nothing": ("none", np.zeros(0)),
        },
        coords={"time": ("time", time, {"units": "s"}), "other": ("time", time + 1.0)},
        attrs={"text": "a\nb", "one": 1.5, "some": np.array([1, 2]), "texts": ["a", "b"]},
    )
    packing = {"dtype": "i2", "scale_factor": 0.5, "_FillValue": -9}
    data.to_netcdf(path, engine="netcdf4", encoding={"packed": packing})
    own, foreign = load_result(path), load_foreign_result(path)
    xr.testing.assert_identical(own, foreign)
    assert [foreign[n].dtype for n in foreign] == [own[n].dtype for n in own]
    assert list(map(type, foreign.attrs.values())) == list(map(type, own.attrs.values()))
    write_netcdf(data.drop_vars("moment"), path)  # with its checksum
    xr.testing.assert_identical(load_result(path), load_foreign_result(path))
    changed = xr.load_dataset(path)
    changed["number"] = 2.6
    changed.to_netcdf(path)
    with pytest.raises(StoreError, match="do not fit its checksum"):
        load_foreign_result(path)


def forge(path, kind):
    with netCDF4.Dataset(path, "w") as file:
        file.createDimension("n", 400_000_000 if kind == "bomb" else 3)
        if kind == "types":
            point = file.createCompoundType(np.dtype([("a", "f8"), ("b", "i4")]), "point")
            file.createVariable("x", point, ("n",))
        elif kind == "bomb":
            file.createVariable("x", "f8", ("n",), zlib=True, chunksizes=(1 << 20,))
        else:
            file.createVariable("x", "f8", ("n",))
            forged = {"scale": ("scale_factor", "x"), "time": ("units", "days since \x1b[2J")}
            file["x"].setncattr(*forged[kind])


@pytest.mark.parametrize("kind", ["bomb", "scale", "time", "types"])
def test_a_forged_result_is_one_line(tmp_path, kind):
    path = tmp_path / "a.nc"
    forge(path, kind)
    for read in (load_foreign_result, load_result)[: 1 if kind == "types" else 2]:
        with pytest.raises(StoreError, match=r"a\.nc: damaged \(.*\); remove it") as error:
            read(path)
        assert str(error.value).isprintable() and len(str(error.value)) < 1200
        assert kind != "bomb" or "unpacks to 3200000000 bytes; expected at most" in str(error.value)
