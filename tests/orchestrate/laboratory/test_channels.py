"""Which columns of a file are its channels: by name, by order, by a caller, by a setup file."""

from contextlib import nullcontext

import numpy as np
import pytest

from orchestrate import InputError, channels, read_record

from .files import G, table_file

TIME = np.arange(400) / 1000.0
WAVES = [np.sin(250.0 * TIME + i) * (i + 1.0) for i in range(4)]
BASE, FACE1, FACE2 = "box_acceleration", "acceleration1", "acceleration2"


def written(tmp_path, headings, unit="m/s2"):
    time, *names = headings.split(";")
    heads = (f"{name} [{'N' if name == 'Force' else unit}]" for name in names)
    heading, waves = ";".join([f"{time} [s]", *heads]), WAVES[: len(names)]
    return table_file(tmp_path / "a.csv", heading, TIME, *waves, separator=";")


@pytest.mark.parametrize(
    ("headings", "expected", "proposed"),
    [
        ("Zeit;Tisch;oben;unten", (BASE, FACE1, FACE2), 2),
        ("Zeit;Tisch;Aufnehmer 1;Aufnehmer 2", (BASE, FACE1, FACE2), 2),
        ("Time;Base;Ch2;Ch3", (BASE, FACE1, FACE2), 2),
        ("Zeit;Referenz;Antwort 1;Antwort 2", (BASE, FACE1, FACE2), 2),
        ("Zeit;Kanal 1;Kanal 2;Kanal 3", (BASE, FACE1, FACE2), 0),  # no name is known
        ("Time;left;Base;right", (FACE1, BASE, FACE2), 2),
        ("Time;Force;left;right", ("force1", FACE1, FACE2), 2),
        ("Time;Control;Response", (BASE, FACE1), 0),  # the one that is left
        ("Time;Base;Face 1;right", (BASE, FACE1, None), 0),  # a known face: no guess beside it
        ("Time;Base;a;b;c", (BASE, None, None, None), 0),
    ],
)
@pytest.mark.filterwarnings("ignore:.*(by its order|not read)")
def test_what_is_left_beside_known_columns_is_proposed_and_said(
    tmp_path, headings, expected, proposed
):
    path = written(tmp_path, headings)
    with pytest.warns(UserWarning) if proposed or None in expected else nullcontext():
        record = read_record(path)
    wanted = {name: wave for name, wave in zip(expected, WAVES, strict=False) if name}
    assert set(record.data_vars) == set(wanted)
    assert all(np.array_equal(record[name].values, wave) for name, wave in wanted.items())
    assert record.attrs["columns"].count("by its order") in (proposed, len(expected) + 1)


@pytest.mark.parametrize("rate", [0, -1.0, float("nan"), "x"])
def test_a_rate_that_is_none_is_refused_by_all_that_read_a_file(tmp_path, rate):
    path, messages = written(tmp_path, "Zeit;Tisch;oben"), []
    for reader in (read_record, channels):
        with pytest.raises(InputError, match=r"a\.csv: sample_rate = .* expected") as error:
            reader(path, sample_rate=rate)
        messages.append(str(error.value))
    assert messages[0] == messages[1]


def test_a_setup_file_reads_as_it_says_and_again_the_same(tmp_path):
    path = written(tmp_path, "Zeit;Tisch;oben;Strom", "V")
    toml = tmp_path / "setup.toml"
    found = channels(path, "time=0,base=Strom,face1=1", output=toml)
    assert found.role.values.tolist() == ["time", "face 1", "", "base"]
    assert found.quantity.values.tolist() == ["time", "voltage", "voltage", "voltage"]
    assert found.attrs["sample_rate"] == pytest.approx(1000.0)
    assert found.rms.values[1:] == pytest.approx([wave.std() for wave in WAVES[:3]])
    with pytest.raises(InputError, match="sensitivity"):
        read_record(path, toml)
    text = toml.read_text().replace('sensitivity = ""', 'sensitivity = "1 V/(m/s2)"')
    toml.write_text(text.replace('serial_number = ""', 'serial_number = "A7"\nscale = -2', 1))
    record = read_record(path, toml)
    assert np.array_equal(record[FACE1].values, -2.0 * WAVES[0])
    assert np.array_equal(record[BASE].values, WAVES[2])
    assert record[FACE1].attrs["serial_number"] == "A7"
    assert "serial_number" not in record[BASE].attrs
    stated = {"base": {"column": 3, "sensitivity": "1 V/(m/s2)"}, "face1": 1, "time": "Zeit"}
    other = read_record(path, stated, sensitivity="face1=1 V/(m/s2)", scale={"face1": -2.0})
    assert other.drop_attrs().identical(record.drop_attrs())
    again = tmp_path / "again.toml"
    channels(path, toml, output=again)
    assert read_record(path, again).identical(record)


def half_known(tmp_path):
    path = written(tmp_path, "Zeit;Tisch;CH3;CH4;PT")
    text = path.read_text(encoding="utf-8")
    path.write_text(text.replace("CH3 [m/s2]", "CH3 (tip)").replace("CH4 [m/s2]", "CH4"))
    return path


def test_what_is_left_is_said_with_the_arguments_that_read_it(tmp_path):
    path = half_known(tmp_path)
    columns = "base=Tisch,face1=CH3 (tip),face2=CH4"
    with pytest.warns(UserWarning) as warned:
        read_record(path)
    said = str(warned[0].message)
    assert said.endswith(f'such as channels="{columns}" with unit="face1=...,face2=..."')
    wanted = r'"CH3 \(tip\)" \(face 1\), .*"CH4" \(face 2\): no unit; .*"face1=...,face2=..."$'
    with pytest.raises(InputError, match=wanted):
        read_record(path, columns)
    record = read_record(path, columns, unit="face=g")  # of both
    assert np.array_equal(record[FACE2].values, G * WAVES[2])
    assert np.array_equal(read_record(path, columns, unit="face=g,face2=m/s2")[FACE2], WAVES[2])


def test_a_list_of_columns_says_what_is_missing_and_writes_what_completes_it(tmp_path):
    path, setup = half_known(tmp_path), tmp_path / "setup.toml"
    columns = "base=Tisch,face1=CH3 (tip),face2=CH4"
    assert "no unit" in channels(path, columns).attrs["refused"]
    assert "sensitivity" in channels(path, columns, unit="face=mV").attrs["refused"]
    given = {"unit": "face=mV", "sensitivity": "face=100 mV/g", "scale": "face2=-1"}
    found = channels(path, columns, **given, resample=True, output=setup)
    assert found.attrs["refused"] == "" and "resample = true" in setup.read_text()
    once = read_record(path, columns, **given, resample=True)
    assert read_record(path, setup).drop_attrs().identical(once.drop_attrs())


@pytest.mark.parametrize(
    ("wrong", "names"),
    [
        ({"fase1": 2}, "fase1"),
        ({"face1": {"colum": 2}}, "colum"),
        ("base=9", "9"),
        ("no such.toml", "no such.toml"),
        (5, "5"),
        ({"base": {"column": 1, "unit": 3}}, "3"),
    ],
)
def test_a_wrong_setup_is_refused_by_name(tmp_path, wrong, names):
    with pytest.raises(InputError, match=names):
        read_record(written(tmp_path, "t;a;b;c"), wrong)


def test_the_first_wrong_keyword_is_the_one_that_is_named(tmp_path):
    setup = {"base": {"column": 1, "unit": "g", "sensitivity": "1 V/g", "scale": 2, "delay": 0}}
    wrong = dict.fromkeys(("unit", "sensitivity", "scale", "delay"), {"fase": 1})
    with pytest.raises(InputError, match="^unit"):
        read_record(written(tmp_path, "t;a"), setup, **wrong)


def test_a_setup_without_a_unit_says_where_to_write_it(tmp_path):
    path, setup = tmp_path / "a.csv", tmp_path / "setup.toml"
    path.write_text("Zeit;Tisch;oben\n0;0,1;0\n1;0,3;2\n2;-0,2;0\n3;0;-1\n")
    channels(path, output=setup)
    assert 'unit = ""  # write it: g, m/s2' in setup.read_text()
    with pytest.raises(InputError, match=r'or in .*setup.toml write unit = "..." below \[base\]'):
        read_record(path, channels=setup)
    setup.write_text(setup.read_text().replace('unit = ""', 'unit = "g"').replace('"g"', '"s"', 1))
    assert float(read_record(path, channels=setup).box_acceleration[0]) == pytest.approx(0.980665)
