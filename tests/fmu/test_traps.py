"""What pythonfmu 0.7.0 does to an FMU's user, measured, and that this FMU does not pass it on."""

import re
import zipfile

import pytest

from .driver import FMUS, run, run_with_output
from .exporting import export_copy

PYTHON = FMUS["fmi2-python"]


@pytest.fixture(scope="module")
def other(tmp_path_factory):
    """An FMU of the same model name whose coefficient of restitution is another one."""
    return export_copy(
        tmp_path_factory.mktemp("other"),
        [("models/oscillator/variables.py", '"e", "1", 0.7', '"e", "1", 0.25')],
    )


def test_two_versions_in_one_process_do_not_share_code(other, tmp_path):
    """Same model, script and class names: each has its own defaults and numbers, in whatever order
    they come, and its own states.
    """
    script = r"""
    mine, other = sys.argv[1:3]

    def numbers(path):
        f = open_fmu(path)
        f.enter()
        e, = f.get("e")
        f.leave()
        return [e, f.step(200.0).outputs()]

    order = [mine, other, mine] if sys.argv[3] == "mine" else [other, mine, other]
    found = [numbers(path) for path in order]
    data, time = open_fmu(mine).start().step(1.0).save()
    try:
        open_fmu(other).start().restore(data, time)
        status = OK
    except Refused as refused:
        status = [refused.status, "\n".join(refused.messages)]
    answer([found, status])
    """
    (mine, foreign, again), status = run(script, PYTHON, other, "mine", cwd=tmp_path)
    assert (mine[0], foreign[0]) == (0.7, 0.25)
    assert again == mine
    assert mine[1] != foreign[1]
    assert status[0] != 0 and "FMU state: expected a state saved by this FMU" in status[1]
    (first, second, third), _ = run(script, PYTHON, other, "other", cwd=tmp_path)
    assert (first, second, third) == (foreign, mine, foreign)


def test_host_with_modules_of_the_same_names(tmp_path):
    """An importer that is itself written in Python, and has modules named as ours are, keeps them;
    the FMU does not get them.
    """
    script = r"""
    import types
    names = ("fmu_src", "fmu_src.runtime", "runtime", "kernels", "models", "runtime.slave", "kernels.oscillator", "kernels.oscillator.memory", "oscillator", "models.oscillator.model",
             "slave", "table", "memory", "model", "variables", "TwoMassImpactOscillator", "stepper", "compiled")
    hosts = {name: types.ModuleType(name) for name in names}
    sys.modules.update(hosts)
    for name in names:
        (Path.cwd() / (name.split(".")[-1] + ".py")).write_text("raise SystemExit('imported')")
    sys.path.insert(0, str(Path.cwd()))
    outputs = open_fmu(PATH).start(**harmonic(1.13)).step(200.0).outputs()
    new = sorted(name for name, module in sys.modules.items() if str(getattr(module, "__file__", "")).startswith(str(Fmu2.folders[PATH])))
    answer([outputs, [name for name in names if sys.modules[name] is not hosts[name]], new])
    """
    plain = run(
        "answer(open_fmu(PATH).start(**harmonic(1.13)).step(200.0).outputs())", PYTHON, cwd=tmp_path
    )
    outputs, replaced, new = run(script, PYTHON, cwd=tmp_path)
    assert outputs == plain
    assert replaced == []
    assert new
    # the only modules an FMU brings: pythonfmu's, and ours under names with a hash of their
    # contents
    for name in new:
        assert re.match(
            r"pythonfmu(\.|$)|fmu_[0-9a-f]{12}(\.|$)|TwoMassImpactOscillator_[0-9a-f]{12}$", name
        ), name


def test_script_is_tiny(tmp_path):
    """The script is read and run again for each instance: it defines the class and nothing else."""
    with zipfile.ZipFile(PYTHON) as archive:
        (name,) = [
            n
            for n in archive.namelist()
            if re.match(r"resources/TwoMassImpactOscillator\w*\.py", n)
        ]
        assert len(archive.read(name)) < 1024


def test_many_instances_and_resets(tmp_path):
    """References that pythonfmu only borrows, released 5000 times, and memory that stays."""
    script = r"""
    def resident():
        return int(Path("/proc/self/statm").read_text().split()[1]) * 4096

    expected = open_fmu(PATH).start(**harmonic(1.13)).step(20.0).outputs()
    f, sizes = open_fmu(PATH), []
    for k in range(5000):
        f.reset().start(**harmonic(1.13)).step(1.0)
        if k % 1000 == 0:
            gc.collect()
            sizes.append(resident())
    same = [f.reset().start(**harmonic(1.13)).step(20.0).outputs() == expected]
    for k in range(500):
        g = open_fmu(PATH, name=f"instance {k}").start(**harmonic(1.13)).step(1.0)
        if k % 3 == 0:
            g.reset()
        g.free()
        if k % 100 == 0:
            gc.collect()
            same.append(f.reset().start(**harmonic(1.13)).step(20.0).outputs() == expected)
    answer([same, sizes])
    """
    same, sizes = run(script, PYTHON, cwd=tmp_path)
    assert all(same) and len(same) == 6
    assert sizes[-1] - sizes[1] < 8e6  # bytes; an instance has 8 kB


@pytest.mark.parametrize("pure", [False, True])
def test_instantiation_takes_less_than_a_second(fmu, tmp_path, pure):
    """The first of a process, with all that is imported, and later ones, to the first step."""
    if pure and "python" not in fmu.parent.name:
        pytest.skip("no Python in it")
    script = r"""
    import time
    describe(PATH), Fmu2.folders.update({PATH: fmpy.extract(PATH, tempfile.mkdtemp(dir=Path.cwd()))})
    seconds = []
    for k in range(6):
        begin = time.perf_counter()
        f = open_fmu(PATH, name=f"instance {k}")
        made = time.perf_counter()
        f.start().step(0.1)
        seconds.append([made - begin, time.perf_counter() - begin])
    answer(seconds)
    """
    for made, stepped in run(script, fmu, cwd=tmp_path, pure=pure):
        assert made < 1.0
        assert stepped < 1.0


@pytest.mark.parametrize(
    "name", ["%s%n%s%n", "%d %100000d %p", "ü €", "", "a" * 2000, "two\nlines"]
)
def test_hostile_instance_names(fmu, tmp_path, name):
    """Names and texts end up in a printf format: a percent sign is a percent sign."""
    script = r"""
    f = open_fmu(PATH, name=sys.argv[2])
    try:
        f.set(m1=math.nan)
    except Refused as refused:
        answer(["\n".join(refused.messages), f.reset().start().step(1.0).get("phase")])
    """
    message, phase = run(script, fmu, name, cwd=tmp_path)
    assert "m1 = nan kg: expected 1e-30 <= m1 <= 1e+30" in message
    assert phase == [pytest.approx(0.4)]


def test_percent_signs_in_a_message_reach_the_importer(tmp_path):
    """The only text of a user's that a message repeats is a number, so a variable of a copied FMU
    gets a name with format directives.
    """
    script = r"""
    import ctypes
    module = [m for n, m in sys.modules.items() if n.endswith("runtime.slave")] if open_fmu(PATH) else []
    table = sys.modules[module[0].__name__.replace("slave", "table")]
    real = table.Variable.problem
    table.Variable.problem = lambda self, value: "%s%n %d 100 %: expected everything" if value == 7.5 else real(self, value)
    texts = []
    for k in range(50):
        try:
            open_fmu(PATH).set(m1=7.5)
        except Refused as refused:
            texts += refused.messages
    answer(texts)
    """
    texts = run(script, PYTHON, cwd=tmp_path)
    assert len(texts) == 50
    assert all("%s%n %d 100 %: expected everything" in text for text in texts)


def test_discarded_step_is_noticed(tmp_path):
    """FMPy's loop takes pythonfmu's discarded step for the end of the simulation and reports
    success: stderr has the reason.
    """
    script = r"""
    result = fmpy.simulate_fmu(PATH, stop_time=10.0, output_interval=1.0, start_values={"d1": 0.0}, output=["x1"],
                               input=__import__("numpy").array([(0.0, 0.9), (4.5, 0.9), (4.5, 1.0), (10.0, 1.0)],
                                                               dtype=[("time", "f8"), ("box_frequency", "f8")]))
    answer(list(result["time"]))
    """
    times, done = run_with_output(script, PYTHON, cwd=tmp_path)
    assert times[-1] < 10.0  # the trap
    (line,) = [text for text in done.stderr.splitlines() if "box_frequency" in text]
    assert "box_frequency = 1.0 rad/s is the natural frequency of mass 1" in line
    assert "expected d1 > 0" in line


def test_discarded_step_raises_in_the_project(fmu):
    from orchestrate.fmu import FmuError, Instance

    with Instance(fmu) as instance:
        instance.initialize(d1=0.0)
        instance.step(0.0, 1.0)
        instance.set(box_frequency=1.0)
        with pytest.raises(
            FmuError,
            match=r"box_frequency = 1.0 rad/s is the natural frequency of mass 1.*expected d1 > 0",
        ):
            instance.step(1.0, 2.0)
        instance.set(box_frequency=0.4)
        instance.step(1.0, 2.0)  # it stayed where it was


@pytest.mark.parametrize("place", ["a folder with spaces", "plain"])
def test_working_folder_and_paths(fmu, tmp_path, place):
    """Wherever the importer runs, and wherever it extracts to."""
    folder = tmp_path / place / "run"
    folder.mkdir(parents=True)
    expected = run("answer(open_fmu(PATH).start().step(50.0).outputs())", fmu, cwd=tmp_path)
    assert run("answer(open_fmu(PATH).start().step(50.0).outputs())", fmu, cwd=folder) == expected
    script = "os.chdir('/'); answer(open_fmu(PATH, folder=fmpy.extract(PATH, sys.argv[2])).start().step(50.0).outputs())"
    assert run(script, fmu, folder / "extracted", cwd=tmp_path) == expected
