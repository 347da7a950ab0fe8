"""Records: what is refused and where, and files of all kinds there and back."""

from __future__ import annotations

import logging
import sys
import time

import numpy as np
import pytest
import scipy.io
import xarray as xr
from scipy.io import wavfile

from orchestrate import InputError, Sampled, read_record, reader_process, record, write_record
from orchestrate.laboratory import record_files
from orchestrate.laboratory.record_checks import clipped_share
from orchestrate.laboratory.record_labview import read_lvm
from orchestrate.laboratory.record_uff import read_uff

from ...sparing import ordinary

G = 9.80665
RATE = 5120.0
CHANNELS = ("box_acceleration", "acceleration1", "acceleration2")


def drawn(count=300, start=0.0, rate=RATE):
    values = np.random.default_rng(3).normal(0.0, 20.0, (3, count))
    time = start + np.arange(count) / rate
    return record(time=time, **dict(zip(CHANNELS, values, strict=True)))


def same(one, other):
    assert one.sizes == other.sizes and set(one.data_vars) == set(other.data_vars)
    for name in one.variables:
        assert (one[name].values == other[name].values).all(), name
    assert one.attrs["sample_rate"] == other.attrs["sample_rate"]


def test_a_record_has_units_names_and_its_rate():
    data = drawn()
    assert set(data.data_vars) == set(CHANNELS) and data.acceleration2.dims == ("time",)
    assert data.attrs["sample_rate"] == RATE and data.attrs["source"] == "measured"
    assert all(data[name].attrs["units"] == "m/s2" for name in CHANNELS)
    assert all(data[name].attrs["long_name"] for name in data.variables)
    assert data.time.attrs["units"] == "s"


def five_digits(count=12_000, rate=1024.0):
    time = np.arange(count) / rate
    return np.array([float(f"{one:.5g}") for one in time]), np.sin(300.0 * time)


def test_rounded_times_say_so_and_a_sampling_rate_corrects_them():
    time, values = five_digits()
    alone = record(time=time, acceleration1=values)
    assert alone.attrs["time_base"] == "rounded to 0.001 s, taken as 1024 Hz"
    assert (alone.time.values == np.arange(len(time)) / 1024.0).all()
    data = record(time=time, acceleration1=values, sample_rate=1024.0)
    assert (data.time.values == np.arange(len(time)) / 1024.0).all()
    with pytest.raises(InputError, match=r"sample_rate = 1000.0 Hz: expected 102\d.*, as the"):
        record(time=time, acceleration1=values, sample_rate=1000.0)
    kept = np.delete(np.arange(len(time)), [5000, 7000, 9000])
    for rate in (1024.0, None):
        with pytest.raises(InputError, match="time, row"):
            record(time=time[kept], acceleration1=values[kept], sample_rate=rate)


def changed(column, row, value):
    data = drawn(50)
    columns = {name: data[name].values.copy() for name in ("time", *CHANNELS)}
    columns[column][row] = value
    return columns


@pytest.mark.parametrize(
    ("given", "words"),
    [
        (changed("acceleration1", 17, np.nan), "acceleration1, row 17: nan; expected finite"),
        (changed("box_acceleration", 3, np.inf), "box_acceleration, row 3: inf; expected finite"),
        (changed("time", 20, 19.5 / RATE), "time, row 20: a step of 9.7656"),
        (changed("time", 20, 0.0), "time, row 20: 0 s after 0.00371093"),
        ({"time": [0.0, 1.0]}, "record: no channel given; expected one of box_acceleration"),
        ({"acceleration1": [1.0] * 5}, "record: neither time nor sample_rate given"),
        ({"acceleration1": [], "sample_rate": 9.0}, "acceleration1: 0 values; expected a list of"),
        ({"acceleration1": "abc", "sample_rate": 9.0}, "acceleration1: expected a list of numbers"),
        ({"time": [0.0, 1.0, 2.0, 3.0, 4.0], "acceleration1": [1.0] * 4}, "4 values; expected 5"),
        ({"time": [0.0, 1.0, 2.0, 4.0], "acceleration1": [1.0] * 4}, "time, row 3: a step of 2 s"),
        ({"time": [0.0] * 4, "acceleration1": [1.0] * 4}, "time, row 1: 0 s after 0 s; expected"),
        (
            {"time": np.arange(99) / 2.05, "acceleration1": [1.0] * 99, "sample_rate": 2.0},
            "sample_rate = 2.0 Hz: expected 2.05, as the times have",
        ),
    ],
)
def test_what_is_no_record_is_refused_in_one_line(given, words):
    with pytest.raises(InputError) as error:
        record(**given)
    assert words in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("values", "words"),
    [
        (0.01 * np.sin(np.arange(99.0)), "in g, or in V"),
        (1e6 * np.sin(np.arange(99.0)), "mV, or counts"),
        (1.0 + 0.1 * np.sin(np.arange(99.0)), "as gravity has in g"),
    ],
)
def test_implausible_units_warn(values, words):
    with pytest.warns(UserWarning, match=words):
        record(acceleration1=values, sample_rate=100.0)


SWEPT = 4.0 * np.sin(2.0 * np.pi * (30.0 + 2.0 * np.arange(4000) / 1000.0) * np.arange(4000) / 1e3)


@pytest.mark.parametrize(
    ("face", "words"),
    [
        (3.0 * SWEPT[::-1].clip(-2.0, 2.0), "saturated: 67 % of its samples repeat"),
        (np.where(np.arange(4000) < 3000, SWEPT[::-1], 0.0), "keeps the value 0 from 3 to 3.999 s"),
        (SWEPT.copy(), "the same values as box_acceleration"),
    ],
)
def test_a_saturated_dead_or_doubled_channel_warns(face, words):
    with pytest.warns(UserWarning, match=words) as caught:
        record(box_acceleration=SWEPT, acceleration1=face, sample_rate=1000.0)
    assert len(caught) == 1 and "acceleration1" in str(caught[0].message)


def test_silence_of_a_whole_record_does_not_warn(recwarn):
    swept = np.concatenate([SWEPT, np.zeros(2000), SWEPT])
    record(box_acceleration=swept, acceleration1=np.roll(swept, 7), sample_rate=1000.0)
    record(box_acceleration=SWEPT, acceleration1=SWEPT, sample_rate=1000.0, source="simulated")
    assert not recwarn


def test_plausible_units_do_not_warn(recwarn):
    for peak in (0.2, 9.8, 5000.0):
        record(acceleration1=peak * np.sin(np.arange(99.0)), sample_rate=100.0)
    record(acceleration1=np.zeros(9), sample_rate=100.0)
    record(acceleration1=G + 0.2 * np.sin(np.arange(99.0)), sample_rate=100.0)
    assert not recwarn


@pytest.mark.parametrize("ending", [".csv", ".txt", ".uff", ".unv", ".mat", ".nc"])
@pytest.mark.parametrize("start", ordinary([1.25, 0.0]))
def test_there_and_back_to_the_last_digit(tmp_path, ending, start):
    data = drawn(start=start)
    path = write_record(data, tmp_path / f"test{ending}")
    assert path == tmp_path / f"test{ending}" and list(tmp_path.iterdir()) == [path]
    same(read_record(path), data)
    if ending == ".nc":
        named = data.assign_attrs(sensors="of a kind", title="test 1")
        assert read_record(write_record(named, path)).identical(named)
    alone = data[["acceleration2"]].assign_attrs(data.attrs)
    same(read_record(write_record(alone, path)), alone)


@pytest.mark.parametrize("rate", [25_600.0, 44_100.0, 3160.497, 1000.0 / 3.0])
def test_rates_of_universal_files_are_exact(tmp_path, rate):
    data = drawn(1000, rate=rate)
    path = write_record(data, tmp_path / "test.uff")
    back = read_record(path)
    assert back.attrs["sample_rate"] == data.attrs["sample_rate"]
    assert np.abs(back.time.values - data.time.values).max() <= 1e-6 / rate


def test_universal_files_as_text_have_twelve_digits(tmp_path):
    data = drawn()
    path = write_record(data, tmp_path / "test.uff", binary=False)
    back = read_record(path)
    for name in CHANNELS:
        assert np.allclose(back[name], data[name], rtol=1e-11, atol=0.0)
    assert (back.time.values == data.time.values).all()


def test_other_datasets_of_universal_files_are_skipped_with_a_line(tmp_path, caplog):
    import pyuff

    data, path = drawn(), tmp_path / "test.uff"
    units = pyuff.prepare_164(
        units_code=1, units_description="SI", temp_mode=1, length=1.0, force=1.0, temp=1.0,
        temp_offset=273.15,
    )  # fmt: skip
    common = {"rsp_node": 1, "rsp_dir": 1, "ref_node": 1, "ref_dir": 1, "abscissa_spacing": 1}
    frf = pyuff.prepare_58(
        binary=0, func_type=4, id1="frf", x=np.arange(9.0), data=np.ones(9) * (1 + 2j),
        abscissa_min=0.0, abscissa_inc=1.0, abscissa_spec_data_type=18,
        ordinate_spec_data_type=12, orddenom_spec_data_type=13, **common,
    )  # fmt: skip
    base = pyuff.prepare_58(
        binary=1, func_type=1, id1="Base", x=data.time.values, data=data.acceleration1.values,
        abscissa_min=0.0, abscissa_inc=1.0 / RATE, abscissa_spec_data_type=17,
        ordinate_spec_data_type=12, ordinate_axis_units_lab="g",
        orddenom_spec_data_type=0, **common,
    )  # fmt: skip
    pyuff.UFF(str(path)).write_sets([units, frf, base], mode="add")
    alone = tmp_path / "frf.uff"
    pyuff.UFF(str(alone)).write_sets([units, frf], mode="add")
    with pytest.raises(InputError, match=r"datasets 164, 58 \(frequency response\); expected a"):
        read_record(alone)
    with caplog.at_level(logging.INFO):
        back = read_record(path)
    assert (back.box_acceleration.values == G * data.acceleration1.values).all()
    assert back.attrs["sample_rate"] == RATE
    assert "dataset 164, number 0 of the file, is skipped" in caplog.text
    assert "dataset 58, number 1 of the file, is no function of time" in caplog.text


def test_without_pyuff_a_line_says_what_to_install(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "pyuff", None)
    (tmp_path / "a.uff").write_text("    -1\n    58\n    -1\n")
    with pytest.raises(InputError, match="pip install pyuff"):
        read_uff(tmp_path / "a.uff")


TEXTS = {
    "german": "Zeit [ms];Base [g];Mass 1 [g]\n0,0;0,1;-1e-1\n0,5;0,2;2\n1,0;-0,3;3,5\n1,5;0;4\n",
    "tabs and a line of units": "t\tbox\ta1\ns\tg\tg\n0\t0.1\t-0.1\n5e-4\t0.2\t2\n0.001\t-.3\t3.5\n"
    "0.0015\t0\t4.\n",
    "heading of an analyser": 'Analyser 5\nDate;1.1.2026\n\n"Time [s]";"Base (g)";"a1 (g)";\n'
    "0,0000;0,1;-0,1;\n0,0005;0,2;2,0;\n0,0010;-0,3;3,5;\n0,0015;0,0;4,0;\n",
    "no heading, blanks": " 0.0  0.1 -0.1\n 5e-4 0.2  2\n 1e-3 -0.3 3.5\n 1.5e-3 0 4\n\n",
    "comment, Windows": "# time [s], base [g], mass 1 [g]\r\n0,0.1,-0.1\r\n5e-4,0.2,2\r\n"
    "1e-3,-0.3,3.5\r\n1.5e-3,0,4\r\n",
    "whole numbers first": "t [ms];base [g];a1 [g]\n0;1e-1;-1e-1\n0,5;0,2;2\n1;-0,3;3,5\n1,5;0;4\n",
    "other order": "a1 [g],base [g],time [s]\n-0.1,0.1,0\n2,0.2,5e-4\n3.5,-0.3,1e-3\n4,0,1.5e-3\n",
}


TEXTS |= {
    "quoted decimal commas": 'Zeit [ms],Base [g],Mass 1 [g]\n"0,0","0,1","-0,1"\n"0,5","0,2",2\n'
    '1,"-0,3","3,5"\n"1,5",0,4\n',
    "units after a slash": "Zeit / ms;Acc Tisch / g;Acc 1 / g\n0,0;0,1;-0,1\n0,5;0,2;2\n"
    "1,0;-0,3;3,5\n1,5;0;4\n",
    "a column of texts": "Nr;Uhrzeit;Zeit [ms];Shaker acc [g];Mass 1 z [g];Alarm\n1;12:00:00;0,0;"
    "0,1;-0,1;none\n2;12:00:00;0,5;0,2;2;none\n3;12:00:00;1,0;-0,3;3,5;high\n4;12:00:00;1,5;0;4;none\n",
    "units of other columns": "t,table,a1,temp\ns,g,g,\u00b0C\n0,0.1,-0.1,20\n5e-4,0.2,2,20\n"
    "1e-3,-0.3,3.5,21\n1.5e-3,0,4,20\n",
}


@pytest.mark.parametrize("encoding", ["utf-8-sig", "cp1252", "utf-16"])
@pytest.mark.parametrize("name", TEXTS)
def test_text_as_analysers_write_it(tmp_path, name, encoding):
    path = tmp_path / "test.csv"
    path.write_bytes(TEXTS[name].encode(encoding))
    data = read_record(path, unit="g")
    assert np.allclose(data.time, [0.0, 5e-4, 1e-3, 1.5e-3], rtol=1e-15)
    assert np.allclose(data.box_acceleration, G * np.array([0.1, 0.2, -0.3, 0.0]), rtol=1e-15)
    assert np.allclose(data.acceleration1, G * np.array([-0.1, 2.0, 3.5, 4.0]), rtol=1e-15)
    assert data.attrs["sample_rate"] == 2000.0 and data.attrs["source"] == "test.csv"
    if any(unit in TEXTS[name] for unit in ("[g]", "(g)", "/ g", ",g,")):
        same(read_record(path), data)


@pytest.mark.parametrize(
    ("heading", "columns", "said"),
    [
        ("t,Table,Beam", None, 'base "Table", face 1 "Beam", time "t"'),
        (
            "t,one,two",
            None,
            'time "t" (by its order), base "one" (by its order), face 1 "two" (by its order)',
        ),
        ("t,tip,foot", [0, 2, 1], 'time "t", base "foot", face 1 "tip"'),
        ("t,tip / g,foot / g", [0, "foot / g", "tip"], 'time "t", base "foot", face 1 "tip"'),
    ],
)
def test_a_record_says_which_columns_were_taken(tmp_path, heading, columns, said):
    """Columns without usual names are taken by their order; a wrong order made a wrong verdict."""
    path = tmp_path / "a.csv"
    path.write_text(f"{heading}\n0,1,2\n1,3,4\n2,5,6\n3,7,8\n")
    found = read_record(path, columns, unit="g").attrs["columns"]
    head, _, end = said.partition(", by")
    assert sorted(found.partition(", by")[0].split(", ")) == sorted(head.split(", "))
    assert found.endswith(end)


@pytest.mark.parametrize(
    ("unit", "factor"),
    [("g", G), ("m/s\u00b2", 1.0), ("m/s^2", 1.0), ("mm/s2", 1e-3), ("mg", 1e-3 * G)],
)
def test_units_in_headings(tmp_path, unit, factor):
    path = tmp_path / "a.csv"
    path.write_bytes(f"t [s];base [{unit}]\n0;10\n1;20\n2;70\n3;90\n".encode("cp1252"))
    data = read_record(path)
    assert np.allclose(data.box_acceleration, factor * np.array([10.0, 20.0, 70.0, 90.0]), 1e-15)


def test_columns_are_named_or_numbered(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text("t [s],n,left [g],right [g],top [g]\n" + "".join(
        f"{0.1 * i},{i},{i + 1},{i + 2},{i + 3}\n" for i in range(5)
    ))  # fmt: skip
    with pytest.raises(InputError, match="5 columns t, n, left, right, top; expected channels="):
        read_record(path)
    one = read_record(path, channels={"time": "t", "box_acceleration": "top", "acceleration1": 2})
    assert np.allclose(one.box_acceleration, G * np.arange(3, 8))
    assert np.allclose(one.acceleration1, G * np.arange(1, 6))
    other = read_record(path, channels=["t", 4, "left"])
    same(one, other)
    without_time = {"box_acceleration": "top", "acceleration1": 2}
    same(read_record(path, channels=without_time), one)
    without = read_record(path, channels={"acceleration1": 2}, sample_rate=10.0)
    assert without.attrs["sample_rate"] == 10.0 and set(without.data_vars) == {"acceleration1"}


def counted(*lost):
    rows = [f"{i},{i / 100},{i % 7}" for i in range(40) if i + 1 not in lost]
    return "n,time [s],base [m/s2]\n" + "\n".join(rows)


def clocks(name):
    return f"{name},base [g]\n" + "".join(f"12:00:0{i},{i % 3}\n" for i in range(6))


def wide(count):
    head = ",".join(f"c{i}" for i in range(count))
    return "\n".join([head, *(",".join(str(i * j % 7) for i in range(count)) for j in range(5))])


def lines(**changes):
    rows = [f"{i / 1000.0},{i % 7},{i % 5}" for i in range(40)]
    for row, text in changes.items():
        rows[int(row[1:])] = text
    return "time [s],base [m/s2],mass 1 [m/s2]\n" + "\n".join(rows) + "\n"


def test_a_record_says_which_unit_was_taken_in_place_of_the_file_s(tmp_path):
    path = tmp_path / "bench.csv"
    path.write_text(lines())
    assert read_record(path).attrs["unit"] == "m/s2"
    same_unit, other = (read_record(path, unit=unit).attrs for unit in ("M/S^2", "g"))
    assert "unit_in_file" not in same_unit
    assert (other["unit"], other["unit_in_file"]) == ("g", "m/s2")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "0 bytes; expected 1 to"),
        ("\n\n", "empty; expected columns of numbers"),
        ("words alone\nand more\n", "no line of numbers in the first"),
        (lines(r10="0.010,abc,3"), "column \"base\", row 12: 'abc'; expected a number"),
        (lines(r10="0.010,,3"), 'column "base", row 12: nothing; expected a number'),
        (lines(r10="0.010,nan,3"), 'column "base", row 12: nan; expected numbers'),
        (lines(r10="0.010,1,inf"), 'column "mass 1", row 12: inf; expected numbers'),
        (lines(r10="0.010,-1e101,3"), 'column "base", row 12: -1e+101; expected numbers of sizes'),
        (lines(r10="0.010,1"), "row 12: 2 columns; expected 3"),
        (lines(r10="0.010,1,2,3"), "row 12: 4 columns; expected 3"),
        (lines(r10="0.0105,1,2"), "time, row 12: a step of 0.0015 s where others are 0.001 s"),
        (lines(r10="0.005,1,2"), "time, row 12: 0.005 s after 0.009 s; expected ascending"),
        ("t [s],base [V]\n0,1\n1,2\n2,3\n3,1\n", 'column "base" (base): in V, without a'),
        ("t,base\n0,1\n1,2\n2,3\n3,1\n", 'column "base" (base): no unit; expected one such'),
        ("t [s],base [g]\n0,1\n1,2\n", "base_acceleration"),
        ("\0\1\2", "no text; expected columns of numbers"),
        (counted(9, 17), 'column "n", row 10: 9 after 7; expected equal steps: samples are lost'),
        (clocks("Zeit"), "column \"Zeit\", row 2: '12:00:00', a clock time; expected numbers in s"),
        (
            clocks("left").replace("base", "top"),
            "column \"left\", row 2: '12:00:00', a clock time; expected numbers in s",
        ),
        ("t;base [g]\n1;1.234,5\n2;1.0,2\n", "row 2: '1.234,5', a number with thousands sep"),
        ("t;base\n2026-01-01;1.234,5\n", "row 2: '2026-01-01', a date; expected columns of num"),
        ("frequency,H1,phase\n1,2,3\n2,3,4\n3,4,5\n", "an FRF, a spectrum or a resonance curve"),
        ("f [Hz],base [g\u00b2/Hz]\n1,2\n2,3\n3,4\n", "a spectral density over the frequency in"),
        ("time,acc_x,acc_y,acc_z\n0,1,2,3\n1,2,3,4\n", "directions of one sensor among the"),
        ("time,base x,base y\n0,1,2\n1,2,3\n", 'columns "base x", "base y" may each be base; ex'),
        (wide(14), "14 columns c0, c1, c2, c3, c4, c5, c6, c7, c8, c9, c10, c11 and 2 more"),
    ],
)
def test_damaged_text_is_refused_in_one_line(tmp_path, text, words):
    path = tmp_path / "test.csv"
    path.write_text(text)
    with pytest.raises(InputError) as error:
        read_record(path)
    expected = "box_acceleration: 2 values" if words == "base_acceleration" else words
    assert expected in str(error.value) and str(path) in str(error.value)
    assert "\n" not in str(error.value)


def test_a_sampling_rate_stands_for_clock_times_and_finds_a_counter(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text(clocks("Zeit"))
    assert read_record(path, sample_rate=10.0).box_acceleration.values.tolist() == [
        G * (i % 3) for i in range(6)
    ]
    path.write_text(counted(9).replace("time [s]", "left [g]").replace("base", "top"))
    with pytest.raises(InputError, match='"n", row 10: 9 after 7; expected equal steps'):
        read_record(path, sample_rate=10.0, channels={"box_acceleration": "top"})
    path.write_text(counted().replace("n,time [s],base", "a,b,c"))
    data = read_record(path, sample_rate=100.0)
    assert data.attrs["columns"] == 'base "c" (by its order)'


def test_columns_that_may_be_accelerations_are_not_dropped_silently(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text(
        "t,base,v1,temp\ns,g,,\u00b0C\n" + "".join(f"{i},{i % 3},{i % 2},20\n" for i in range(9))
    )
    with pytest.warns(UserWarning, match='not read: "v1"; channels= says which'):
        read_record(path)


def test_a_stored_result_of_shake_is_a_record_if_it_has_no_impacts(tmp_path):
    shaken, path = drawn(300).rename(acceleration1="a1_abs"), tmp_path / "a.nc"
    shaken.to_netcdf(path)
    assert read_record(path).acceleration1.equals(drawn(300).acceleration1)
    shaken.assign(impulse=("impact", [1.0])).to_netcdf(path)
    with pytest.raises(InputError, match=r"leave out the impacts; expected .*measure"):
        read_record(path)


@pytest.mark.parametrize("ending", [".uff", ".mat", ".nc", ".wav"])
@pytest.mark.parametrize("damage", ["cut", "noise"])
def test_damaged_files_are_refused_in_one_line(tmp_path, ending, damage):
    path = tmp_path / f"test{ending}"
    if ending == ".wav":
        wavfile.write(path, 1000, np.zeros(3000, np.int16))
    else:
        write_record(drawn(3000), path)
    data = path.read_bytes()
    noise = np.random.default_rng(0).bytes(len(data))
    path.write_bytes(data[: len(data) // 2 - 1] if damage == "cut" else noise)
    with pytest.raises(InputError) as error:
        read_record(path, scale=1.0 if ending == ".wav" else None)
    assert str(path) in str(error.value) and "\n" not in str(error.value)


def test_huge_files_and_unknown_ones_are_refused(tmp_path, monkeypatch):
    path = write_record(drawn(), tmp_path / "a.csv")
    monkeypatch.setattr(record_files, "MOST_BYTES", 1000)
    with pytest.raises(InputError, match="bytes; expected 1 to 1000"):
        read_record(path)
    with pytest.raises(InputError, match="expected a file that ends in .csv"):
        read_record(tmp_path / "a.xyz")
    with pytest.raises(InputError, match="no such file; expected a record"):
        read_record(tmp_path / "b.csv")
    with pytest.raises(InputError, match="no ordinary file"):
        (tmp_path / "folder.csv").mkdir()
        read_record(tmp_path / "folder.csv")
    with pytest.raises(InputError, match="WAV is only read"):
        write_record(drawn(), tmp_path / "a.wav")
    with pytest.raises(InputError, match="data: expected a record"):
        write_record(xr.Dataset(), tmp_path / "a.csv")


@pytest.mark.parametrize("seed", ordinary([51, 156, 258]))
def test_a_mat_file_that_ends_its_reader_is_one_line(tmp_path, seed):
    """Bytes that SciPy 1.17 reads out of bounds: this process lives on."""
    path, time = tmp_path / "a.mat", np.arange(50) / 1000.0
    known = {"time": time, "box_acceleration": np.sin(time)}
    scipy.io.savemat(path, {**known, "sample_rate": 1000.0, "units": "m/s2"})
    damaged, draw = bytearray(path.read_bytes()), np.random.default_rng(seed)
    for _ in range(draw.integers(1, 4)):
        damaged[int(draw.integers(0, len(damaged)))] = int(draw.integers(256))
    path.write_bytes(damaged)
    with pytest.raises(InputError, match="expected a MAT file that is whole") as error:
        read_record(path)
    assert "\n" not in str(error.value)


def test_matlabs_matrices_and_rates(tmp_path):
    path, data = tmp_path / "a.mat", drawn()
    matrix = np.stack([data[name].values for name in CHANNELS], axis=1)
    scipy.io.savemat(path, {"data": matrix, "Fs": RATE, "remark": "x"})
    with pytest.raises(InputError, match=r'column "data\[0\]" .base., .*: no unit'):
        read_record(path)
    same(read_record(path, unit="m/s2"), data)
    named = read_record(path, unit="m/s2", channels={"acceleration1": "data[1]"})
    assert (named.acceleration1.values == data.acceleration1.values).all()


@pytest.mark.parametrize("kind", ["int16", "int32", "uint8", "float32"])
def test_wav_needs_its_scale(tmp_path, kind):
    parts = np.array([[0.0, 0.5], [0.25, -1.0], [-0.5, 0.75], [0.5, 0.0]])
    stored = {
        "int16": parts * 2**15, "int32": parts * 2**31, "uint8": parts * 128 + 128, "float32": parts
    }[kind]  # fmt: skip
    path = tmp_path / "a.wav"
    wavfile.write(path, 8000, stored.astype(kind))
    data = read_record(path, scale=40.0)
    assert np.array_equal(np.stack([data.box_acceleration, data.acceleration1], 1), 40.0 * parts)
    assert data.attrs["sample_rate"] == 8000.0
    with pytest.raises(InputError, match="no scale=; expected for a WAV file"):
        read_record(path)


def test_a_record_is_played_again():
    data = drawn()
    again = Sampled.from_record(data)
    assert again.sample_rate == RATE
    assert (np.array(again.acceleration) == data.box_acceleration.values).all()
    with pytest.raises(InputError, match="record: expected one with box_acceleration"):
        Sampled.from_record(data[["acceleration1"]])


def test_repeated_extreme_values_are_those_of_a_saturated_channel():
    """Digits, tones of few samples a period, pulses from rest and noise are no saturation."""
    time, rng = np.arange(20_000) / 1000.0, np.random.default_rng(2)
    sweep = 4.0 * np.sin(2.0 * np.pi * (30.0 * time + 0.2 * time**2))
    passed = sweep * (0.1 + np.exp(-(((time - 9.0) / 1.5) ** 2)))
    pulse = np.where(time < 0.011, np.sin(np.pi * time / 0.011), 0.0)
    tones = [np.sin(2.0 * np.pi * hertz * time) for hertz in (50.0, 5.0)]
    sound = [rng.normal(size=20_000), pulse, *tones, *(np.round(sweep, n) for n in (0, 1, 2, 3))]
    assert [clipped_share(values) for values in sound] == [0.0] * len(sound)
    spiked = sweep + 9.0 * (rng.random(20_000) < 1e-3) * rng.random(20_000)
    cut = spiked.clip(-5.0, 7.0)
    assert clipped_share(spiked, 1) == clipped_share(cut) == 0.0 < clipped_share(cut, 1)
    for noise in (0.0, 0.05):
        values = passed + rng.normal(0.0, noise, len(passed))
        peak = np.abs(values).max()
        limited = [np.clip(values, -share * peak, share * peak) for share in (0.8, 0.5)]
        assert clipped_share(values) == 0.0 and clipped_share(limited[0]) > 0.01
        at = np.mean(np.abs(limited[1]) == 0.5 * peak)
        assert clipped_share(limited[1]) == pytest.approx(at, rel=0.02)


def swept(count=4000, rate=1000.0):
    """Acceleration, velocity and displacement of a sine swept from 20 to 60 Hz, in SI."""
    time = np.arange(count) / rate
    phase = np.pi * 2.0 * (20.0 * time + 5.0 * time**2)
    speed = 2.0 * np.pi * (20.0 + 10.0 * time)  # of the phase; it grows by 20 pi rad/s2
    velocity = 0.1 * np.cos(phase) * speed
    acceleration = -0.1 * np.sin(phase) * speed**2 + 0.1 * np.cos(phase) * 20.0 * np.pi
    return time, acceleration, velocity, 0.1 * np.sin(phase)


def table_file(path, heading, *columns):
    rows = "".join(
        ",".join(f"{one:.12g}" for one in row) + "\n" for row in zip(*columns, strict=True)
    )
    path.write_text(f"{heading}\n{rows}")
    return path


@pytest.mark.filterwarnings("ignore::UserWarning")
def test_velocities_displacements_and_voltages_become_accelerations(tmp_path):
    time, acceleration, velocity, displacement = swept()
    heading = "t [s],Tisch [mV],Aufnehmer 1 [mm/s],mass 2 [um]"
    columns = (time, 100.0 * acceleration / G, 1e3 * velocity, 1e6 * displacement)
    path = table_file(tmp_path / "a.csv", heading, *columns)
    for sensitivity in ("base=100 mV/g", {"base": "0.1 V/g"}, "base=10,197162 mV/(m/s²)"):
        data = read_record(path, sensitivity=sensitivity)
        for name in CHANNELS:
            error = np.abs(data[name].values - acceleration)[20:-20]
            assert error.max() < 2e-3 * np.abs(acceleration).max(), name
    assert "face 2: displacement, differentiated" in data.attrs["converted"]
    assert "base" not in data.attrs["converted"]
    turned = read_record(path, sensitivity="base=-100 mV/g", scale={"face2": 2.0}, delay="face1=0")
    assert np.allclose(turned.box_acceleration, -data.box_acceleration, rtol=1e-6)
    assert (turned.acceleration2.values == 2.0 * data.acceleration2.values).all()
    stated = path.read_text().replace("\n", "\n,100 mV/g,,\n", 1)
    path.write_text(stated)
    assert np.allclose(read_record(path).box_acceleration, -turned.box_acceleration)


def test_a_sensitivity_of_all_columns_asks_for_the_units_that_are_missing(tmp_path):
    path = table_file(tmp_path / "a.csv", "t [s],base,tip", *swept(50)[:3])
    with pytest.raises(InputError, match='column "tip" .face 1.: no unit.* unit="base=V,face1=...'):
        read_record(path, unit="base=V", sensitivity="100 mV/g")
    read_record(path, unit="base=V,face1=V", sensitivity="100 mV/g")
    read_record(path, unit="time=ms", sensitivity="100 mV/g")


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({}, 'column "base" (base): in mV, without a sensitivity; expected one such as 100 mV/g'),
        ({"sensitivity": "100 g/V"}, "sensitivity '100 g/V'; expected one such as 100 mV/g"),
        ({"sensitivity": "tip=1 V/g"}, "sensitivity: no channel 'tip'; expected base, box"),
        ({"unit": "base=g", "sensitivity": "base=1 V/g"}, "expected volts: a sensitivity does not"),
        ({"unit": "g,time=us"}, "'g' of which channel? expected base="),
        ({"unit": "base=N"}, "unit = 'N'; expected one such as m/s2, g, mm/s, um, V"),
        ({"unit": "g", "scale": "base=x"}, "scale = 'base=x': expected numbers of sizes from"),
    ],
)
def test_mistaken_units_and_sensitivities_are_one_line(tmp_path, options, words):
    path = table_file(tmp_path / "a.csv", "t [s],base [mV]", *swept(50)[:2])
    with pytest.raises(InputError) as error:
        read_record(path, **options)
    assert words in str(error.value) and "\n" not in str(error.value)


def test_uneven_times_are_resampled_on_request_but_not_over_gaps():
    time, acceleration, *_ = swept()
    uneven = time + np.random.default_rng(4).uniform(-2e-4, 2e-4, len(time))
    true = np.interp(uneven, time, acceleration)
    from orchestrate.laboratory.record import Reading, checked_record

    with pytest.raises(InputError, match="expected equal steps: resample= makes them"):
        record(time=uneven, box_acceleration=true)
    resampled = Reading(resample=True)
    even = checked_record(uneven, {"box_acceleration": true}, None, {}, resampled)
    assert np.ptp(np.diff(even.time)) < 1e-12
    assert "jitter 0.00012 s, 0.12 step" in even.attrs["time_base"]
    expected = np.interp(even.time, time, acceleration)
    assert np.abs(even.box_acceleration.values - expected)[5:-5].max() < 0.02 * acceleration.max()
    gap = np.delete(np.arange(len(time)), slice(1000, 1009))
    with pytest.raises(InputError, match="row 1000: .*samples are lost, cut the record there"):
        checked_record(uneven[gap], {"box_acceleration": true[gap]}, None, {}, resampled)


NAMES = [
    ("Zeit / s;Aufnehmer Spitze / g;Tisch / g", (2, 1)),
    ("time [s];Acc shaker [g];beam [g]", (1, 2)),
    ("temps [s];poutre [g];socle [g]", (2, 1)),
    ("t [s];left [g];table [g]", (2, 1)),
    ("tiempo [s];mesa [g];viga [g]", (1, 2)),
]


@pytest.mark.parametrize(("heading", "places"), NAMES)
def test_names_of_columns_in_several_languages(tmp_path, heading, places):
    path = tmp_path / "a.csv"
    path.write_bytes((heading + "\n0;1;5\n1;2;3\n2;9;7\n3;4;8\n").encode("cp1252"))
    columns = np.array([[0, 1, 5], [1, 2, 3], [2, 9, 7], [3, 4, 8]]).T
    data = read_record(path)
    assert np.allclose(data.box_acceleration, G * columns[places[0]])
    assert np.allclose(data.acceleration1, G * columns[places[1]])


def test_labviews_streams_have_rates_and_units(tmp_path):
    from nptdms import ChannelObject, TdmsWriter

    _, acceleration, velocity, _ = swept(500)
    path = tmp_path / "a.tdms"
    common = {"wf_increment": 1e-3, "wf_start_offset": 0.0}
    units = {"unit_string": "V", "sensitivity": "100 mV/g"}, {"unit_string": "mm/s"}
    with TdmsWriter(path) as file:
        file.write_segment(
            [
                ChannelObject("run", "Table", 0.1 * acceleration / G, common | units[0]),
                ChannelObject("run", "Tip", 1e3 * velocity, common | units[1]),
            ]
        )
    data = read_record(path)
    assert np.allclose(data.box_acceleration, acceleration)
    assert np.allclose(data.acceleration1[20:-20], acceleration[20:-20], atol=15.0)
    assert data.attrs["sample_rate"] == 1000.0 and 'face 1 "Tip"' in data.attrs["columns"]
    path.write_bytes(path.read_bytes()[:90])
    with pytest.raises(InputError, match=r"a\.tdms: .*"):
        read_record(path)


LVM = """LabVIEW Measurement\t
Writer_Version\t2
Reader_Version\t2
Separator\tTab
Decimal_Separator\t,
Multi_Headings\tNo
X_Columns\tOne
***End_of_Header***\t

Channels\t2\t\t
Samples\t5\t5\t
Y_Unit_Label\tg\tg\t
X0\t0,0\t0,0\t
Delta_X\t0,0005\t0,0005\t
***End_of_Header***\t\t
X_Value\tTisch\tSpitze\tComment
0,0000\t0,1\t-0,1
0,0005\t0,2\t2,0
0,0010\t-0,3\t3,5
0,0015\t0,0\t4,0
0,0020\t0,5\t1,0
"""


def test_labviews_text_is_read_and_no_pickle_beside_it(tmp_path, monkeypatch):
    path = tmp_path / "a.lvm"
    path.write_text(LVM)
    (tmp_path / "a.lvm.pkl").write_bytes(b"cos\nsystem\n(S'touch forged'\ntR.")
    monkeypatch.chdir(tmp_path)
    data = read_record(path)
    assert not (tmp_path / "forged").exists() and data.attrs["sample_rate"] == 2000.0
    assert np.allclose(data.box_acceleration, G * np.array([0.1, 0.2, -0.3, 0.0, 0.5]))
    assert np.allclose(data.acceleration1, G * np.array([-0.1, 2.0, 3.5, 4.0, 1.0]))
    monkeypatch.setitem(sys.modules, "lvm_read", None)
    with pytest.raises(InputError, match="expected the package lvm_read: pip install lvm_read"):
        read_lvm(path)


def test_nested_structures_of_matlab(tmp_path):
    """As Simcenter exports signals, and a structure with units beside its vectors."""
    _, acceleration, velocity, _ = swept(300)

    def signal(name, values, unit):
        axis = {"start_value": 0.0, "increment": 1e-3, "number_of_values": 300.0}
        quantity = {"quantity": {"label": unit}, "values": values}
        return {"x_values": axis, "y_values": quantity, "function_record": {"name": name}}

    path = tmp_path / "a.mat"
    two = {
        "Signal_0": signal("Table", acceleration / G, "g"),
        "Signal_1": signal("Tip", velocity, "m/s"),
    }
    scipy.io.savemat(path, two)
    data = read_record(path)
    assert np.allclose(data.box_acceleration, acceleration)
    assert np.allclose(data.acceleration1[20:-20], acceleration[20:-20], atol=15.0)
    flat = {"run": {"fs": 1000.0, "unit": "g", "base": acceleration / G, "face1": acceleration / G}}
    scipy.io.savemat(path, flat)
    with pytest.warns(UserWarning, match="the same values"):
        assert np.allclose(read_record(path).acceleration1, acceleration)
    frf = {"run": {"frequency": np.arange(9.0), "H1": np.arange(9.0) * 1j}}
    scipy.io.savemat(path, frf)
    with pytest.raises(InputError, match=r"a frequency response or a spectrum \(run.H1\)"):
        read_record(path)


def timed(tmp_path, heading, step, count=9):
    rows = "".join(f"{step * i:.12g},{i % 3},{i % 4}\n" for i in range(count))
    path = tmp_path / "times.csv"
    path.write_text(f"{heading},base [g],face [g]\n{rows}")
    return path


@pytest.mark.parametrize(
    ("step", "count", "unit", "rate"), [(2500, 9, "us", 400.0), (0.5, 8000, "ms", 2000.0)]
)
def test_times_without_a_unit_that_are_hardly_seconds_are_doubted(
    tmp_path, recwarn, step, count, unit, rate
):
    path = timed(tmp_path, "t", step, count)
    with pytest.warns(UserWarning, match=rf'column "t": no unit, taken as s: {step} s a sample'):
        assert read_record(path).attrs["sample_rate"] == 1.0 / step
    recwarn.clear()
    data = read_record(path, unit=f"time={unit}")
    assert data.attrs["sample_rate"] == rate and data.attrs["time_unit"] == unit
    assert data.attrs["unit"] == "g" and "unit_in_file" not in data.attrs
    assert read_record(path, unit={"time": unit, "base": "m/s2"}).attrs["unit"] == "m/s2, g"
    assert read_record(path, unit={"time": unit}).equals(data)
    assert not recwarn


@pytest.mark.parametrize(
    ("heading", "step", "rate"), [("t [s]", 4.0, 0.25), ("t [h]", 1, 1 / 3600)]
)
def test_slow_and_long_records_with_a_unit_of_time_are_not_doubted(
    tmp_path, recwarn, heading, step, rate
):
    data = read_record(timed(tmp_path, heading, step, 2000))
    assert data.attrs["sample_rate"] == pytest.approx(rate) and not recwarn


def test_a_unit_of_time_is_kept_in_advice_and_a_wrong_one_is_one_line(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text("t,base,tip [g]\n" + "".join(f"{i},{i % 3},{i % 4}\n" for i in range(9)))
    with pytest.raises(InputError, match=r'give it by unit="time=us,base=\.\.\."$'):
        read_record(path, unit="time=us")
    with pytest.raises(InputError, match="unit = 'g'; expected one such as s, ms: .*time=...\"$"):
        read_record(path, unit="time=g")
    with pytest.raises(InputError, match="scale: no channel 'time'; expected base"):
        read_record(path, unit="g", scale="time=2")


@pytest.mark.parametrize("separator", [",", " ", ";"])
def test_a_last_line_of_words_is_left_out_with_a_warning(tmp_path, separator):
    path = tmp_path / "a.csv"
    rows = lines().replace(",", separator)
    path.write_text(rows)
    whole = read_record(path, unit="m/s2", channels=[0, 1, 2])
    path.write_text(f"{rows}\nRate 1344, overflows 0\nend\n")
    with pytest.warns(UserWarning, match="row 43: 'Rate 1344, overflows 0' after the numbers is"):
        data = read_record(path, unit="m/s2", channels=[0, 1, 2])
    assert data.equals(whole) and "Rate 1344" in data.attrs["left_out"]
    path.write_text(rows + separator.join(["0.04", "x", "1"]))
    with pytest.raises(InputError, match="row 42: .*expected"):
        read_record(path, unit="m/s2", channels=[0, 1, 2])


def test_one_column_alone_asks_for_its_sampling_rate(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text("0.1\n0.3\n-0.2\n0.1\n0.2\n")
    with pytest.raises(InputError, match="no channel; .* or sample_rate= if there are no times$"):
        read_record(path)
    assert read_record(path, sample_rate=100.0, unit="g").box_acceleration[1] == G * 0.3


@pytest.mark.parametrize("late", [0.0155, -0.0155, 3.9])
def test_a_delay_cuts_what_a_channel_does_not_have(tmp_path, late):
    time, acceleration, *_ = swept(4000)
    path = table_file(tmp_path / "a.csv", "t [s],base [m/s2],tip [m/s2]", time, acceleration, time)
    whole, data = read_record(path), read_record(path, delay={"face1": late})
    size = 4000 - (16 if abs(late) < 1.0 else 3900)
    assert data.sizes["time"] == size and data.attrs["cut"].startswith(f"{4000 - size} samples of")
    assert data.box_acceleration.equals(whole.box_acceleration.sel(time=data.time))
    assert np.allclose(data.acceleration1, data.time + late, atol=1e-9)
    assert read_record(path, delay="base=0.0155,face1=0.001").sizes["time"] == 3984


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"delay": "face1=3.998"}, "delay: face 1 3.998 s; expected delays that leave 4 of 4000 s"),
        ({"delay": {"base": 2.5, "tip": 0.0}}, "no channel 'tip'"),
        ({"delay": {"base": 2.5, "face1": -2.5}}, "delay: base 2.5 s, face 1 -2.5 s; expected del"),
        ({"delay": 1e300}, "delay = 1e+300: expected numbers of sizes from 0 to 1e+12"),
        ({"scale": 0}, "scale = 0: expected numbers of sizes from 1e-12 to 1e+12, such as face1="),
        ({"scale": "face1=nan"}, "scale = 'face1=nan': expected numbers of sizes from 1e-12"),
    ],
)
def test_delays_beyond_the_record_and_scales_of_nothing_are_one_line(tmp_path, options, words):
    time, acceleration, *_ = swept(4000)
    path = table_file(tmp_path / "a.csv", "t [s],base [m/s2],tip [m/s2]", time, acceleration, time)
    with pytest.raises(InputError) as error:
        read_record(path, **options)
    assert words in str(error.value) and "\n" not in str(error.value)


def test_a_mat_file_with_spectra_beside_named_channels_is_read(tmp_path):
    time, acceleration, velocity, _ = swept(300)
    path = tmp_path / "a.mat"
    spectrum = {"X": np.fft.rfft(acceleration, 1024), "f": np.arange(513.0)}
    scipy.io.savemat(path, {"time": time, "base": acceleration, "tip": velocity, **spectrum})
    data = read_record(path, unit="m/s2")
    assert (data.box_acceleration.values == acceleration).all()
    assert data.attrs["spectra"] == "a frequency response or a spectrum (X)"
    scipy.io.savemat(path, {"clock": time, "one": acceleration, "two": velocity, "X": 1j * time})
    with pytest.raises(InputError, match=r"spectrum \(X\); expected acc.*: channels= names them"):
        read_record(path, unit="m/s2")
    with pytest.raises(InputError, match=r"spectrum \(X\); expected acc"):
        read_record(path, unit="m/s2", channels={"box_acceleration": "one"})
    for options in (
        {"channels": {"time": "clock", "box_acceleration": "one"}},
        {"channels": {"box_acceleration": "one"}, "sample_rate": 1000.0},
    ):
        read = read_record(path, unit="m/s2", **options)
        assert (read.box_acceleration.values == acceleration).all()


def deflated_netcdf(path, count):
    """A NetCDF file of a compressed vector that was never written."""
    import netCDF4

    with netCDF4.Dataset(path, "w") as file:
        file.createDimension("time", count)
        for name in ("time", "box_acceleration"):
            file.createVariable(name, "f8", ("time",), zlib=True, chunksizes=(1 << 20,))


@pytest.mark.skipif(sys.platform != "linux", reason="limits of Linux")
@pytest.mark.parametrize("ending", ["mat", "nc"])
def test_a_small_file_that_unpacks_to_much_is_one_line(tmp_path, monkeypatch, ending):
    path, count = tmp_path / f"a.{ending}", 20 << 20
    if ending == "mat":
        scipy.io.savemat(path, {"base": np.zeros(count)}, do_compression=True)
    else:
        deflated_netcdf(path, count)
    monkeypatch.setattr(reader_process, "MEMORY", 128 << 20)
    assert path.stat().st_size < 200_000
    with pytest.raises(InputError, match="unpacks to 335544320 bytes|llocate|memory") as error:
        read_record(path, unit="m/s2")
    assert str(error.value).isprintable() and len(str(error.value)) < 300


def test_more_numbers_than_a_file_of_its_size_has_are_one_line(tmp_path, monkeypatch):
    path = tmp_path / "a.csv"
    path.write_text(lines())
    monkeypatch.setattr(reader_process, "NUMBERS", 0)
    monkeypatch.setattr(reader_process, "NUMBERS_PER_BYTE", 1)
    with pytest.raises(InputError, match="its numbers take 960 bytes, from a file of .* most 430"):
        read_record(path, unit="m/s2")


HOSTILE = {
    "a.csv": (b't,base [g]\n0,1\n1,"' + b"x" * 140_000 + b'"\n', "field larger than field limit"),
    "digits.csv": (
        b"t," + b"7" * 100_000 + b" mV/(\n0,1\n1,2\n2,9\n3,4\n",
        r"sensitivity .7+ \.\.\. 7+ mV/\(",
    ),
    "blanks.csv": (b"t,a" + b" _" * 50_000 + b"b\n0,1\n1,2\n2,9\n3,4\n", "no unit"),
    "escapes.csv": (b"t,base\x1b[2J\r\n0,1\n1,2\n2,9\n3,4\n", r'"base\\x1b\[2J"'),
    "tab.lvm": (LVM.replace("Tisch\tSp", "TischSp").encode(), "names of 1 channels; expected 2"),
}


@pytest.mark.parametrize("name", HOSTILE)
def test_files_that_once_ended_in_a_traceback_or_took_minutes(tmp_path, name):
    path, (data, words) = tmp_path / name, HOSTILE[name]
    path.write_bytes(data)
    begun = time.monotonic()
    with pytest.raises(InputError, match=words) as error:
        read_record(path)
    assert str(error.value).isprintable() and len(str(error.value)) < 1100
    assert time.monotonic() - begun < 8.0


def test_a_damaged_unit_of_a_stream_is_one_line_and_no_log(tmp_path, capfd, caplog):
    from nptdms import ChannelObject, TdmsWriter

    path, common = tmp_path / "a.tdms", {"wf_increment": 1e-3, "unit_string": "WWWW"}
    with TdmsWriter(path) as file:
        file.write_segment([ChannelObject("run", "Table", np.arange(9.0), common)])
    for damaged in (b"W\xff\x1bW", b"W\n\0W"):
        path.write_bytes(path.read_bytes().replace(b"WWWW", damaged))
        with pytest.raises(InputError) as error:
            read_record(path)
        assert str(error.value).isprintable() and len(str(error.value)) < 300
    assert capfd.readouterr() == ("", "") and not caplog.records
