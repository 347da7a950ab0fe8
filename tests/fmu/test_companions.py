"""What lies beside FMI's core in the files: terminals, licences, the manifest of references."""

import zipfile
from xml.etree import ElementTree as ET

import fmpy
import pytest


@pytest.mark.parametrize("drive", ["MotorShaker", "ElectrodynamicShaker"])
def test_terminals_of_both_models_fit_together(exported, drive):
    """Members of the same name: an output here, an input of the same unit there. The structure has
    more, which FMI's matching rule "bus" allows: what another drive may have.
    """
    sides = []
    for name in ("TwoMassImpactOscillator", drive):
        path = exported / "fmi3" / f"{name}.fmu"
        found = {v.name: v for v in fmpy.read_model_description(str(path)).modelVariables}
        with zipfile.ZipFile(path) as opened:
            root = ET.fromstring(opened.read("terminalsAndIcons/terminalsAndIcons.xml"))
            assert opened.read("terminalsAndIcons/icon.png").startswith(b"\x89PNG")
        (terminal,) = root.findall("Terminals/Terminal")
        members = terminal.findall("TerminalMemberVariable")
        sides.append({m.get("memberName"): found[m.get("variableName")] for m in members})
    one, other = sides
    assert set(other) == {"force", "acceleration", "jerk"} < set(one)
    more = ("snap", "crackle", "impulse", "impulse_moment")
    assert {m: one[m].name for m in set(one) - set(other)} == {m: f"box_{m}" for m in more}
    for member, variable in ((m, one[m]) for m in other):
        assert {variable.causality, other[member].causality} == {"input", "output"}
        assert variable.unit == other[member].unit
