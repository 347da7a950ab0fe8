"""Linear drives of somebody else: random ones, their FMUs, and the truth about them."""

import atexit
import functools
import math
import random
import re
import shutil
import subprocess
import tempfile
import zipfile
from dataclasses import dataclass
from pathlib import Path

import fmpy
import numpy as np
from fmpy import platform, platform_tuple, sharedLibraryExtension
from scipy.integrate import solve_ivp

SOURCE = Path(__file__).with_suffix(".c")
SIZE = 4
KINDS = re.search("enum { (NOTHING.*) };", SOURCE.read_text())[1].split(", ")  # what it may do


@dataclass(frozen=True)
class LinearDrive:
    """``x' = A x + B u``, u: force, command; acceleration ``C x + D u``; x: position, velocity."""

    a: np.ndarray
    b: np.ndarray
    c: np.ndarray
    d: np.ndarray
    names: tuple[str, ...] = ("force", "command", "acceleration", "position", "velocity")
    signs: tuple[int, int] = (1, 1)  # of the force that it takes, and of its acceleration
    has_states: bool = False
    fmi: int = 3
    does: str = "NOTHING"  # of KINDS
    unit: str = ""  # of its acceleration by FMI 3.0, a name without a base unit

    @property
    def parameters(self):
        """Start values by the names in the FMU, with the signs of what it takes and gives."""
        force, acceleration = self.signs
        b, d = self.b * (force, 1), self.d * (force, 1) * acceleration
        values = (self.a, b, self.c * acceleration, d)
        numbers = np.concatenate([np.ravel(part) for part in values])
        own = {"does": float(KINDS.index(self.does)), "has_states": float(self.has_states)}
        return {f"p{i}": float(value) for i, value in enumerate(numbers)} | own

    @property
    def connect(self):
        """Names of theirs by ours."""
        return self.connected("a")

    def connected(self, letters):
        """The same of some of acceleration, position and velocity, by their first letters."""
        force, acceleration = ("-" if sign < 0 else "" for sign in self.signs)
        theirs = {"acceleration": acceleration + self.names[2]}
        theirs |= dict(zip(("position", "velocity"), self.names[3:], strict=True))
        motions = {f"box_{name}": own for name, own in theirs.items() if name[0] in letters}
        return {"box_force": force + self.names[0], **motions}

    def write(self, folder, name="Linear"):
        places = {f"p{i}": i for i in range(30)} | {"does": 32, "has_states": 33}
        rows = [(one, i, "parameter", 'start="0"') for one, i in places.items()]
        rows += [(one, 30 + i, "input", 'start="0"') for i, one in enumerate(self.names[:2])]
        units = (f'unit="{self.unit}"' * bool(self.unit), "", "")
        rows += [(one, 40 + i, "output", units[i]) for i, one in enumerate(self.names[2:])]
        path, third = Path(folder) / f"{name}.fmu", self.fmi == 3
        with zipfile.ZipFile(path, "w") as archive:
            text = (self.description3 if third else self.description2)(rows)
            archive.writestr("modelDescription.xml", f'<?xml version="1.0"?>{text}')
            system = platform_tuple if third else platform
            archive.write(library(self.fmi), f"binaries/{system}/linear{sharedLibraryExtension}")
        return path

    def ability(self, state):
        flag = str(self.has_states).lower()
        return (
            'modelIdentifier="linear" canHandleVariableCommunicationStepSize="true" '
            f'canGetAndSet{state}="{flag}" canSerialize{state}="{flag}"'
        )

    def description3(self, rows):
        variables = "".join(f"<Float64 {attributes(*row)} {more}/>" for *row, more in rows)
        time = 'name="time" valueReference="99" causality="independent" variability="continuous"'
        outputs = "".join(f'<Output valueReference="{row[1]}"/>' for row in rows[-3:])
        units = f'<UnitDefinitions><Unit name="{self.unit}"/></UnitDefinitions>' * bool(self.unit)
        return (
            '<fmiModelDescription fmiVersion="3.0" modelName="Linear" instantiationToken="1">'
            f"<CoSimulation {self.ability('FMUState')}/>{units}<ModelVariables>{variables}"
            f"<Float64 {time}/></ModelVariables>"
            f"<ModelStructure>{outputs}</ModelStructure></fmiModelDescription>"
        )

    def description2(self, rows):
        variables = "".join(
            f"<ScalarVariable {attributes(*row)}><Real {more}/></ScalarVariable>"
            for *row, more in rows
        )
        outputs = "".join(f'<Unknown index="{len(rows) - k}"/>' for k in (2, 1, 0))
        return (
            '<fmiModelDescription fmiVersion="2.0" modelName="Linear" guid="1">'
            f"<CoSimulation {self.ability('FMUstate')}/><ModelVariables>{variables}"
            f"</ModelVariables><ModelStructure><Outputs>{outputs}</Outputs><InitialUnknowns>"
            f"{outputs}</InitialUnknowns></ModelStructure></fmiModelDescription>"
        )


def attributes(name, reference, causality):
    kind = "fixed" if causality == "parameter" else "continuous"
    text = f'name="{name}" valueReference="{reference}" causality="{causality}"'
    return f'{text} variability="{kind}"'


@functools.cache
def library(fmi):
    """The drive compiled; other functions that an importer looks up return an error."""
    folder = Path(tempfile.mkdtemp())
    atexit.register(shutil.rmtree, folder)
    importer = Path(fmpy.__file__).with_name(f"fmi{fmi}.py").read_text()
    names = sorted({*re.findall(rf"\bfmi{fmi}[A-Z]\w+", importer)})
    absent = [f"__attribute__((weak)) int {name}(void) {{ return 3; }}\n" for name in names]
    (folder / "absent.c").write_text("".join(absent))
    path = folder / f"linear{sharedLibraryExtension}"
    line = ["cc", "-O2", "-shared", "-fPIC", f"-DFMI={fmi}", "-o", path, SOURCE]
    subprocess.run([*map(str, line), folder / "absent.c", "-lm"], check=True)
    return path


def draw(seed, masses=(2.0, 8.0)):
    """A random drive: a table on a suspension, a coil or other lag, a filter before the force."""
    rng, words = np.random.default_rng(seed), random.Random(seed)
    mass, lag, filtered = rng.uniform(*masses), rng.uniform(0.01, 0.1), bool(seed % 2)
    frequency, damping = rng.uniform(5.0, 30.0), rng.uniform(0.02, 0.3)
    a, b, c, d = np.zeros((SIZE, SIZE)), np.zeros((SIZE, 2)), np.zeros(SIZE), np.zeros(2)
    c[:3] = -(frequency**2), -2.0 * damping * frequency, rng.uniform(5.0, 20.0) / mass
    a[3, 3], b[3, 0] = -1.0 / lag, 1.0 / lag
    if filtered:  # the force acts late: no direct feedthrough
        c[3] = 1.0 / mass
    else:
        d[0] = 1.0 / mass
    a[0, 1], a[1], b[1] = 1.0, c, d
    a[2, 1], a[2, 2] = -rng.uniform(10.0, 100.0), -rng.uniform(20.0, 100.0)
    b[2, 1] = rng.uniform(10.0, 40.0)
    letters = "abcdefghijklmnopqrstuvwxyz_"
    names = {"".join(words.choices(letters, k=words.randint(3, 9))) + str(i) for i in range(5)}
    signs = words.choice((1, -1)), words.choice((1, -1))
    return LinearDrive(a, b, c, d, tuple(sorted(names)), signs, has_states=seed % 3 == 0)


def together(drive, s, command, times, start=(0.0,) * 4):
    """Displacements of both masses and the number of impacts, with the drive as one system."""

    def rates(time, state):
        x1, x2, v1, v2, *x = state
        u = np.array([s.k1 * x1 + s.d1 * v1 + s.k2 * x2 + s.d2 * v2, command(time)])
        box = float(drive.c @ x + drive.d @ u)
        a1 = -(s.k1 * x1 + s.d1 * v1) / s.m1 - box
        a2 = -(s.k2 * x2 + s.d2 * v2) / s.m2 - box
        return [v1, v2, a1, a2, *(drive.a @ x + drive.b @ u)]

    def gap(time, state):
        return state[1] - state[0] + s.clearance

    def play(time, state):
        return s.stroke - gap(time, state)

    gap.terminal, gap.direction, play.terminal, play.direction = True, -1, True, -1
    ends = (gap, play) if s.stroke else (gap,)
    time, impacts, rows = 0.0, 0, {0.0: start[:2]}
    # masses that are pressed together at first are let apart where they part, a step later
    state = np.array([start[0], start[1] or 1e-14, *start[2:], *np.zeros(len(drive.c))])
    while time < times[-1]:
        asked = {"t_eval": times[time + 1e-12 < times], "events": ends, "max_step": 0.05}
        done = solve_ivp(rates, (time, times[-1]), state, "DOP853", **asked, rtol=1e-11, atol=1e-14)
        points = np.reshape(done.y, (len(state), -1))[:2].T
        rows |= dict(zip(np.round(done.t, 9), points, strict=True))
        if done.status == 0:
            break
        far = int(not done.t_events[0].size)  # whether it is the other end of the play
        time, state = done.t_events[far][0], done.y_events[far][0].copy()
        closing = state[2] - state[3]
        assert impacts < 400, "it chatters, which this solver cannot"
        impulse = (1.0 + s.e) * s.m1 * s.m2 / (s.m1 + s.m2) * closing
        state[2] -= impulse / s.m1
        state[3] += impulse / s.m2
        state[1] = state[0] - s.clearance + (s.stroke - 1e-15 if far else 1e-15)
        impacts += abs(closing) > 1e-9
    return np.array([rows[time] for time in np.round(times, 9)]), impacts


def displacement_error(run, truth):
    """Largest error of x1 and x2, m, at the times that a run and the truth have in common."""
    coarse = min(run.sizes["time"], len(truth)) - 1
    both = np.column_stack([run.x1.values, run.x2.values])
    rows = (all_rows[:: (len(all_rows) - 1) // coarse] for all_rows in (both, truth))
    return np.abs(np.subtract(*rows)).max()


def table_drive(n):
    """The shaker of :mod:`.table` in this form."""
    c = np.array([-n["stiffness"], -n["damping"], n["bl"]]) / n["mass"]
    d = np.array([1.0 / n["mass"], 0.0])
    a = np.array([[0.0, 1.0, 0.0], c, [0.0, -n["bl"] / n["l"], -n["r"] / n["l"]]])
    b = np.array([[0.0, 0.0], d, [0.0, 1.0 / n["l"]]])
    rest = SIZE - len(c)
    a, b = np.pad(a, (0, rest)), np.pad(b, ((0, rest), (0, 0)))
    return LinearDrive(a, b, np.pad(c, (0, rest)), d)


def sine(amplitude=20.0, rate=26.0):
    return lambda time: amplitude * math.sin(rate * time)
