"""Files of all kinds there and back, and what is refused, in one line that names it."""

from __future__ import annotations

import logging
import time

import numpy as np
import pytest
import scipy.io
import xarray as xr
from scipy.io import wavfile

import orchestrate
from orchestrate import InputError, Sampled, read_record, reader_process, write_record
from orchestrate.laboratory import record_files
from orchestrate.laboratory.columns import assign_columns
from orchestrate.laboratory.record_mat import read_mat

from ...sparing import ordinary
from .files import CHANNELS, LVM, RATE, G, drawn, same, swept, write_tdms


def refused(path, words, **options):
    """Reading is refused in one short line with the file's name, soon."""
    begun = time.monotonic()
    with pytest.raises(InputError) as error:
        read_record(path, **options)
    line = str(error.value)
    assert words in line and str(path) in line, line
    assert line.isprintable() and len(line) < 1100 and time.monotonic() - begun < 8.0


@pytest.mark.parametrize("ending", [".csv", ".txt", ".uff", ".unv", ".mat", ".nc"])
@pytest.mark.parametrize("start", ordinary([1.25, 0.0]))
def test_there_and_back_to_the_last_digit(tmp_path, ending, start):
    words = {"sensors": "of a kind", "title": "test 1"}
    data = drawn(start=start, force1=np.sqrt(np.arange(300.0)), **words)
    path = write_record(data, tmp_path / f"test{ending}")
    assert path == tmp_path / f"test{ending}" and list(tmp_path.iterdir()) == [path]
    assert data.attrs["source"] == "measured"
    again = read_record(path)
    same(again, data)
    assert {again[name].attrs["units"] for name in CHANNELS} == {"m/s2"}
    assert again.force1.attrs["units"] == "N" and again.time.attrs["units"] == "s"
    assert all(again[name].attrs["long_name"] for name in again.variables)
    assert ending != ".nc" or again.identical(data)
    alone = data[["acceleration2"]].assign_attrs(data.attrs)
    same(read_record(write_record(alone, path)), alone)


@pytest.mark.parametrize("rate", [25_600.0, 44_100.0, 3160.497, 1000.0 / 3.0])
def test_rates_of_universal_files_are_exact_and_their_texts_have_twelve_digits(tmp_path, rate):
    data = drawn(1000, rate=rate)
    path = tmp_path / "test.uff"
    for binary in (True, False):
        back = read_record(write_record(data, path, binary=binary))
        assert back.attrs["sample_rate"] == data.attrs["sample_rate"]
        assert np.abs(back.time.values - data.time.values).max() <= 1e-6 / rate
        assert np.allclose(back.acceleration2, data.acceleration2, rtol=1e-11, atol=0.0)


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
    pyuff.UFF(str(path)).write_sets([units, frf], mode="add")
    refused(path, "datasets 164, 58 (frequency response)")
    pyuff.UFF(str(path)).write_sets([base], mode="add")
    with caplog.at_level(logging.INFO):
        back = read_record(path)
    assert (back.box_acceleration.values == G * data.acceleration1.values).all()
    assert back.attrs["sample_rate"] == RATE
    assert "dataset 164, number 0" in caplog.text and "dataset 58, number 1" in caplog.text


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
    "quoted decimal commas": 'Zeit [ms],Base [g],Mass 1 [g]\n"0,0","0,1","-0,1"\n"0,5","0,2",2\n'
    '1,"-0,3","3,5"\n"1,5",0,4\n',
    "units after a slash": "Zeit / ms;Acc Tisch / g;Acc 1 / g\n0,0;0,1;-0,1\n0,5;0,2;2\n"
    "1,0;-0,3;3,5\n1,5;0;4\n",
    "a column of texts": "Nr;Uhrzeit;Zeit [ms];Shaker acc [g];Mass 1 z [g];Alarm\n1;12:00:00;0,0;"
    "0,1;-0,1;none\n2;12:00:00;0,5;0,2;2;none\n3;12:00:00;1,0;-0,3;3,5;high\n4;12:00:00;1,5;0;4;none\n",
    "units of other columns": "t,table,a1,temp\ns,g,g,\u00b0C\n0,0.1,-0.1,20\n5e-4,0.2,2,20\n"
    "1e-3,-0.3,3.5,21\n1.5e-3,0,4,20\n",
}


ENCODINGS = [(name, "utf-8-sig") for name in TEXTS] + [
    (name, encoding)
    for name in ("comment, Windows", "units of other columns")
    for encoding in ("cp1252", "utf-16")
]


@pytest.mark.parametrize(("name", "encoding"), ENCODINGS)
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


def lines(row=0, text=""):
    """A good record, or one with another text in a row."""
    rows = [f"{i / 1000.0},{i % 7},{i % 5}" for i in range(40)]
    rows[row] = text or rows[row]
    return "time [s],base [m/s2],mass 1 [m/s2]\n" + "\n".join(rows) + "\n"


def counted(*lost):
    rows = [f"{i},{i / 100},{i % 7}" for i in range(40) if i + 1 not in lost]
    return "n,time [s],base [m/s2]\n" + "\n".join(rows)


def clocks(name, base="base"):
    return f"{name},{base} [g]\n" + "".join(f"12:00:0{i},{i % 3}\n" for i in range(6))


def wide(count):
    head = ",".join(f"c{i}" for i in range(count))
    return "\n".join([head, *(",".join(str(i * j % 7) for i in range(count)) for j in range(5))])


FOUR = "\n0,1\n1,2\n2,9\n3,4\n"
DAMAGED = [
    ("", "0 bytes"),
    ("\n\n", "empty"),
    ("words alone\nand more\n", "no line of numbers"),
    (lines(10, "0.010,abc,3"), "column \"base\", row 12: 'abc'"),
    (lines(10, "0.010,,3"), 'column "base", row 12: nothing'),
    (lines(10, "0.010,nan,3"), 'column "base", row 12: nan'),
    (lines(10, "0.010,1,inf"), 'column "mass 1", row 12: inf'),
    (lines(10, "0.010,-1e101,3"), 'column "base", row 12: -1e+101'),
    (lines(10, "0.010,1"), "row 12: 2 columns; expected 3"),
    (lines(10, "0.010,1,2,3"), "row 12: 4 columns; expected 3"),
    (lines(10, "0.0105,1,2"), "time, row 12: a step of 0.0015 s where others are 0.001 s"),
    (lines(10, "0.005,1,2"), "time, row 12: 0.005 s after 0.009 s"),
    ("t [s],base [V]" + FOUR, 'column "base" (base): in V'),
    ("t,base" + FOUR, 'column "base" (base): no unit'),
    ("t [s],base [g]\n0,1\n1,2\n", "box_acceleration: 2 values"),
    ("\0\1\2", "no text"),
    (counted(9, 17), 'column "n", row 10: 9 after 7'),
    (clocks("Zeit"), "column \"Zeit\", row 2: '12:00:00'"),
    (clocks("left", "top"), "column \"left\", row 2: '12:00:00'"),
    ("t;base [g]\n1;1.234,5\n2;1.0,2\n", "row 2: '1.234,5', a number with thousands"),
    ("t;base\n2026-01-01;1.234,5\n", "row 2: '2026-01-01', a date"),
    ("frequency,H1,phase\n1,2,3\n2,3,4\n3,4,5\n", "a resonance curve"),
    ("f [Hz],base [g\u00b2/Hz]\n1,2\n2,3\n3,4\n", "a spectral density"),
    ("time,acc_x,acc_y,acc_z\n0,1,2,3\n1,2,3,4\n", "directions of one sensor"),
    ("time,base x,base y\n0,1,2\n1,2,3\n", 'columns "base x", "base y" may each be base'),
    (wide(14), "14 columns c0"),
    ("0.1\n0.3\n-0.2\n0.1\n0.2\n", "sample_rate="),
    # these once ended in a traceback or took minutes
    ('t,base [g]\n0,1\n1,"' + "x" * 140_000 + '"\n', "field larger"),
    ("t," + "7" * 100_000 + " mV/(" + FOUR, "777 mV/("),
    ("t,a" + " _" * 50_000 + "b" + FOUR, "no unit"),
    ("t,base\x1b[2J\r" + FOUR, r'"base\x1b[2J"'),
]


@pytest.mark.parametrize(("text", "words"), DAMAGED, ids=range(len(DAMAGED)))
def test_damaged_text_is_refused(tmp_path, text, words):
    path = tmp_path / "test.csv"
    path.write_text(text)
    refused(path, words)


ENDINGS = (".uff", ".mat", ".nc", ".wav", ".tdms")
DAMAGES = [(ending, damage) for ending in ENDINGS for damage in ("cut", "noise")]
NOT_SLOW = [one for one in DAMAGES if one[1] == "cut" or one[0] in (".mat", ".nc")]


@pytest.mark.parametrize(("ending", "damage"), ordinary(DAMAGES, NOT_SLOW, several_names=True))
def test_damaged_files_are_refused(tmp_path, ending, damage):
    path = tmp_path / f"test{ending}"
    if ending == ".wav":
        wavfile.write(path, 1000, np.zeros(3000, np.int16))
    elif ending == ".tdms":
        write_tdms(path, ("V", np.arange(9.0)))
    else:
        write_record(drawn(3000), path)
    data = path.read_bytes()
    noise = np.random.default_rng(0).bytes(len(data))
    path.write_bytes(data[: len(data) // 2 - 1] if damage == "cut" else noise)
    refused(path, "", scale=1.0 if ending == ".wav" else None)


@pytest.mark.parametrize("damaged", [b"W\xff\x1bW", b"W\n\0W"])
def test_a_damaged_unit_of_a_stream_is_one_line_and_no_log(tmp_path, capfd, caplog, damaged):
    path = tmp_path / "a.tdms"
    write_tdms(path, ("WWWW", np.arange(9.0)))
    path.write_bytes(path.read_bytes().replace(b"WWWW", damaged))
    refused(path, "")
    assert capfd.readouterr() == ("", "") and not caplog.records


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
    refused(path, "expected a MAT file that is whole")


def test_what_is_no_file_of_a_record_is_refused(tmp_path, monkeypatch):
    path = tmp_path / "a.csv"
    path.write_text(lines())
    with monkeypatch.context() as limits:
        limits.setattr(reader_process, "NUMBERS", 0)
        limits.setattr(reader_process, "NUMBERS_PER_BYTE", 1)
        refused(path, "its numbers take 960 bytes", unit="m/s2")
    monkeypatch.setattr(record_files, "MOST_BYTES", 400)
    refused(path, "bytes; expected 1 to 400")
    refused(tmp_path / "a.xyz", "expected a file that ends in .csv")
    refused(tmp_path / "b.csv", "no such file")
    (tmp_path / "folder.csv").mkdir()
    refused(tmp_path / "folder.csv", "no ordinary file")
    with pytest.raises(InputError, match="WAV is only read"):
        write_record(drawn(), tmp_path / "a.wav")
    with pytest.raises(InputError, match="data: expected a record"):
        write_record(xr.Dataset(), tmp_path / "a.csv")


def test_a_stored_result_of_shake_is_a_record_if_it_has_no_impacts(tmp_path):
    shaken, path = drawn(300).rename(acceleration1="a1_abs"), tmp_path / "a.nc"
    shaken.to_netcdf(path)
    assert read_record(path).acceleration1.equals(drawn(300).acceleration1)
    shaken.assign(impulse=("impact", [1.0])).to_netcdf(path)
    with pytest.raises(InputError, match="leave out the impacts"):
        record_files.read_netcdf(path)


def test_matlabs_matrices_and_rates(tmp_path):
    path, data = tmp_path / "a.mat", drawn()
    matrix = np.stack([data[name].values for name in CHANNELS], axis=1)
    scipy.io.savemat(path, {"data": matrix, "Fs": RATE, "remark": "x"})
    again = read_record(path, unit="m/s2")
    same(again, data)
    assert again.attrs["columns"].startswith('base "data[0]"')


def test_nested_structures_of_matlab(tmp_path):
    """As Simcenter exports signals, and a structure with units beside its vectors."""
    _, acceleration, velocity, _ = swept(300)

    def signal(name, values, unit):
        axis = {"start_value": 0.0, "increment": 1e-3, "number_of_values": 300.0}
        quantity = {"quantity": {"label": unit}, "values": values}
        return {"x_values": axis, "y_values": quantity, "function_record": {"name": name}}

    path = tmp_path / "a.mat"
    two = {"Signal_0": signal("Table", acceleration / G, "g")}
    scipy.io.savemat(path, {**two, "Signal_1": signal("Tip", velocity, "m/s")})
    data = read_record(path)
    assert np.allclose(data.box_acceleration, acceleration)
    assert np.allclose(data.acceleration1[20:-20], acceleration[20:-20], atol=15.0)
    run = {"fs": 1000.0, "unit": "g", "base": velocity, "face1": velocity}
    scipy.io.savemat(path, {"run": run})
    table = read_mat(path)
    assert [(one.name, one.unit) for one in table.columns] == [("base", "g"), ("face1", "g")]
    assert table.sample_rate == 1000.0 and (table.columns[1].values == velocity).all()
    scipy.io.savemat(path, {"run": {"frequency": np.arange(9.0), "H1": np.arange(9.0) * 1j}})
    with pytest.raises(InputError, match=r"a frequency response or a spectrum \(run.H1\)"):
        assign_columns(read_mat(path), None)


def test_a_mat_file_with_spectra_beside_named_channels_is_read(tmp_path):
    time, acceleration, velocity, _ = swept(300)
    path = tmp_path / "a.mat"
    spectrum = {"X": np.fft.rfft(acceleration, 1024), "f": np.arange(513.0)}
    scipy.io.savemat(path, {"time": time, "base": acceleration, "tip": velocity, **spectrum})
    data = read_record(path, unit="m/s2")
    assert (data.box_acceleration.values == acceleration).all() and "(X)" in data.attrs["spectra"]
    scipy.io.savemat(path, {"clock": time, "one": acceleration, "two": velocity, "X": 1j * time})
    table, base = read_mat(path), {"box_acceleration": "one"}
    for columns in (None, base):
        with pytest.raises(InputError, match=r"spectrum \(X\)"):
            assign_columns(table, columns)
    named = assign_columns(table, {"time": "clock", **base}).indices
    assert named == {"time": 0, "box_acceleration": 1}
    assert assign_columns(table.with_sample_rate(1000.0), base).indices == {"box_acceleration": 1}


@pytest.mark.parametrize("kind", ["int16", "int32", "uint8", "float32"])
def test_wav_needs_its_scale(tmp_path, kind):
    parts = np.array([[0.0, 0.5], [0.25, -1.0], [-0.5, 0.75], [0.5, 0.0]])
    sizes = {"int16": (2**15, 0), "int32": (2**31, 0), "uint8": (128, 128), "float32": (1, 0)}
    path, (size, zero) = tmp_path / "a.wav", sizes[kind]
    wavfile.write(path, 8000, (parts * size + zero).astype(kind))
    data = read_record(path, scale=40.0)
    assert np.array_equal(np.stack([data.box_acceleration, data.acceleration1], 1), 40.0 * parts)
    assert data.attrs["sample_rate"] == 8000.0
    refused(path, "no scale=")


def test_labviews_streams_have_rates_and_units(tmp_path):
    _, acceleration, velocity, _ = swept(500)
    path = tmp_path / "a.tdms"
    write_tdms(path, ("V", 0.1 * acceleration / G), ("mm/s", 1e3 * velocity))
    data = read_record(path)
    assert np.allclose(data.box_acceleration, acceleration)
    assert np.allclose(data.acceleration1[20:-20], acceleration[20:-20], atol=15.0)
    assert data.attrs["sample_rate"] == 1000.0 and 'face 1 "Tip"' in data.attrs["columns"]


def test_labviews_text_is_read_and_no_pickle_beside_it(tmp_path, monkeypatch):
    path = tmp_path / "a.lvm"
    path.write_text(LVM)
    (tmp_path / "a.lvm.pkl").write_bytes(b"cos\nsystem\n(S'touch forged'\ntR.")
    monkeypatch.chdir(tmp_path)
    data = read_record(path)
    assert not (tmp_path / "forged").exists() and data.attrs["sample_rate"] == 2000.0
    assert np.allclose(data.box_acceleration, G * np.array([0.1, 0.2, -0.3, 0.0, 0.5]))
    assert np.allclose(data.acceleration1, G * np.array([-0.1, 2.0, 3.5, 4.0, 1.0]))
    path.write_text(LVM.replace("Tisch\tSp", "TischSp"))
    refused(path, "names of 1 channels; expected 2")
    rows = LVM.replace("\tComment", "").splitlines()
    path.write_text("\n".join(row + "\t7,0" * row.startswith("0,00") for row in rows))
    refused(path, "4 columns below 3 names")


def test_a_sampling_rate_stands_for_clock_times_and_finds_a_counter(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text(clocks("Zeit"))
    read = read_record(path, sample_rate=10.0).box_acceleration.values
    assert read.tolist() == [G * (i % 3) for i in range(6)]
    path.write_text(counted(9).replace("time [s]", "left [g]").replace("base", "top"))
    refused(path, '"n", row 10: 9', sample_rate=10.0, channels={"box_acceleration": "top"})
    path.write_text(counted().replace("n,time [s],base", "a,b,c"))
    data = read_record(path, sample_rate=100.0)
    assert data.attrs["columns"] == 'base "c" (by its order)'
    path.write_text("0.1\n0.3\n-0.2\n0.1\n0.2\n")
    assert read_record(path, sample_rate=100.0, unit="g").box_acceleration[1] == G * 0.3


@pytest.mark.parametrize("separator", [",", " ", ";"])
def test_a_last_line_of_words_is_left_out_with_a_warning(tmp_path, separator):
    path, columns = tmp_path / "a.csv", {"unit": "m/s2", "channels": [0, 1, 2]}
    rows = lines().replace(",", separator)
    path.write_text(rows)
    whole = read_record(path, **columns)
    path.write_text(f"{rows}\nRate 1344, overflows 0\nend\n")
    with pytest.warns(UserWarning, match="row 43: 'Rate 1344, overflows 0'"):
        data = read_record(path, **columns)
    assert data.equals(whole) and "Rate 1344" in data.attrs["left_out"]
    path.write_text(rows + separator.join(["0.04", "x", "1"]))
    refused(path, "row 42: ", **columns)


def test_a_record_is_played_again():
    data = drawn()
    again = Sampled.from_record(data)
    assert again.sample_rate == RATE
    assert (np.array(again.acceleration) == data.box_acceleration.values).all()
    with pytest.raises(InputError, match="record: expected one with box_acceleration"):
        Sampled.from_record(data[["acceleration1"]])


@pytest.mark.parametrize("value", [3, None, b"a.csv"])
@pytest.mark.parametrize(
    "read", [orchestrate.read_record, orchestrate.read_curve, orchestrate.channels]
)
def test_what_is_no_path_is_refused_in_one_line(read, value):
    """It was Python's TypeError."""
    with pytest.raises(InputError, match=f"^path = {value!r}: expected a path"):
        read(value)
