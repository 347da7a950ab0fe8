"""Compare answers before and after a change: ``python -m tests.referee --before REV``.

The earlier commit and this tree answer the same questions. Bits of numeric variables have to be
the same where nothing is decided anew; decisions are counted before and after. Answers of a commit
are stored in ``results/referee``; those of this tree are computed each time. The default takes some
six minutes of processor time a side; ``--full`` is all of Figures 6, 10 and 11, 500 beams, 2,000
structures and 40 drives.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from orchestrate.errors import VibroimpactError
from orchestrate.flags import flag_words

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "results" / "referee"
SOURCES = ("tests/__init__.py", "tests/referee", "tests/draws.py", "tests/benches")
FULL = {"stride": 1, "beams": 500, "structures": 2000, "drives": 40}
PARTS = ("orchestrate", "fmu_src", "pyproject.toml")  # of a commit; the questions are this tree's
Answer = dict[str, Any]


def decisions(name: str, variable: xr.Variable) -> list[str] | None:
    """Return the words of a variable that is a decision; None of one that is a number."""
    values = variable.values.ravel()
    words = flag_words(variable.attrs) if "flag_meanings" in variable.attrs else {}
    if words and {*words.values()} != {"no", "yes"}:  # a state such as contact is a number
        return [words.get(int(value), str(value)) for value in values]
    if name == "multiplicity":
        return [f"{value:g}" if value else "undecided" for value in values]
    return [str(value) for value in values] if values.dtype.kind in "SUO" else None


def summarize(data: xr.Dataset) -> Answer:
    """Return the words of each decision, and digest, size and shape of each number."""
    answer: Answer = {"decisions": {}, "bits": {}}
    for name, variable in data.variables.items():
        words = decisions(str(name), variable)
        if words is not None:
            if name not in data.coords:  # a label decides nothing
                answer["decisions"][name] = words
            continue
        values = np.asarray(variable.values, dtype=float)
        values = np.where(np.isnan(values), np.nan, values)  # all NaNs alike
        digest = hashlib.sha256(values.tobytes() + str(values.shape).encode()).hexdigest()[:16]
        answer["bits"][name] = [digest, float(np.nansum(np.abs(values))), list(values.shape)]
    return answer


def ask(group: str, number: int, stride: int) -> Answer:
    """Answer one question, in the checkout that this process runs in."""
    from . import questions

    try:
        if group.startswith("figure "):
            return summarize(questions.figure(group.removeprefix("figure "), stride))
        if group in ("beams", "structures", "drives"):
            own = {"beams": questions.beam, "structures": questions.attractors}
            return summarize(own.get(group, questions.drive)(number))
        function = questions.QUESTIONS[group]
        seed = [*group.encode(), number]
        return summarize(function(questions.Draw(np.random.default_rng(seed))))
    except VibroimpactError as error:
        return {"decisions": {"error": [f"{type(error).__name__}: {error}"]}, "bits": {}}
    except Exception as error:  # an answer too, where both fail alike
        return {"decisions": {"error": [f"FAILED {type(error).__name__}: {error}"]}, "bits": {}}


def groups(options: argparse.Namespace) -> dict[str, int]:
    """Return the number of questions of each group that the options choose."""
    from . import questions

    counts = {f"figure {number}": 1 for number in questions.PAPER}
    few = max(1, options.questions // 4)
    usual = options.questions
    counts |= {name: few if name in questions.SLOW else usual for name in questions.QUESTIONS}
    counts |= {"beams": options.beams, "structures": options.structures}
    counts["drives"] = 8 * options.drives
    return {name: count for name, count in counts.items() if name in (options.only or counts)}


def answer_all(options: argparse.Namespace) -> None:
    """Answer all questions into a folder, one file a group; those that are there stay."""
    import orchestrate

    print(f"answers of {Path(orchestrate.__file__).parents[1]}", flush=True)
    for group, count in groups(options).items():
        more = f"-{options.stride}" if group.startswith("figure") else ""
        path = options.answer / f"{group}{more}.json"
        answers = json.loads(path.read_text()) if path.exists() else []
        answers += [ask(group, i, options.stride) for i in range(len(answers), count)]
        path.write_text(json.dumps(answers))


def check_out(revision: str) -> Path:
    """Unpack a commit's package into the results' folder, once; return the folder."""
    command = ["git", "-C", str(ROOT), "rev-parse", "--verify", f"{revision}^{{commit}}"]
    commit = subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()
    folder = FOLDER / commit[:12] / "checkout"
    folder.mkdir(parents=True, exist_ok=True)
    archive = ["git", "-C", str(ROOT), "archive", commit, *PARTS]
    packed = subprocess.run(archive, capture_output=True, check=True).stdout
    subprocess.run(["tar", "-x", "-C", str(folder)], input=packed, check=True)
    return folder


def questions_digest() -> str:
    """Return a digest of what asks: stored answers belong to these questions alone."""
    hashed = hashlib.sha256()
    for name in SOURCES:
        path = ROOT / name
        for file in sorted(path.rglob("*.[pc]*") if path.is_dir() else [path]):
            hashed.update(file.read_bytes() if file.suffix in (".py", ".c") else b"")
    return hashed.hexdigest()[:8]


def run_side(checkout: Path, folder: Path, arguments: Sequence[str]) -> Path:
    """Answer in a process that imports the package of a checkout and the tools of this tree."""
    folder.mkdir(parents=True, exist_ok=True)
    command = [sys.executable, "-m", "tests.referee", *arguments, "--answer", str(folder)]
    subprocess.run(command, cwd=checkout, env={**os.environ, "PYTHONPATH": str(ROOT)}, check=True)
    return folder


def differing_bits(before: Answer, after: Answer) -> dict[str, float]:
    """Return the numeric variables of both answers that differ, with the change of their size."""
    changes = {}
    for name in before["bits"].keys() & after["bits"].keys():
        one, other = before["bits"][name], after["bits"][name]
        if one[0] != other[0]:
            same = one[2] == other[2]
            changes[name] = abs(other[1] - one[1]) / (abs(one[1]) or 1.0) if same else np.inf
    return changes


def changed_words(before: Answer, after: Answer) -> Iterator[tuple[str, str, str]]:
    """Yield variable, word before and word after of each decision that changed."""
    names = before["decisions"].keys() & after["decisions"].keys()
    names |= {"error"} & (before["decisions"].keys() | after["decisions"].keys())
    for name in sorted(names):
        one, other = (side["decisions"].get(name, ["an answer"]) for side in (before, after))
        if len(one) != len(other):
            yield name, f"{len(one)} values", f"{len(other)} values"
            continue
        yield from ((name, *pair) for pair in zip(one, other, strict=True) if pair[0] != pair[1])


def undecided(answers: Sequence[Answer]) -> tuple[int, int]:
    """Return how many decisions of some answers are undecided, and how many there are."""
    words = [word for each in answers for some in each["decisions"].values() for word in some]
    return sum("undecided" in word for word in words), len(words)


def compare(group: str, before: Sequence[Answer], after: Sequence[Answer]) -> bool:
    numeric, words, anew = Counter[str](), Counter[tuple[str, str, str]](), 0
    size: dict[str, float] = {}
    for one, other in zip(before, after, strict=True):
        changed = list(changed_words(one, other))
        words.update(changed)
        anew += bool(changed)
        for name, change in differing_bits(one, other).items() if not changed else ():
            numeric[name] += 1
            size[name] = max(size.get(name, 0.0), change)
    (open_before, count), (open_after, _) = undecided(before), undecided(after)
    errors = [word for each in after for word in each["decisions"].get("error", ())]
    print(
        f"{group:20}{len(after):6}{sum(numeric.values()):10}{anew:14}{count:12}"
        f"{open_before:12} -> {open_after}" + f"   {len(errors)} refused" * bool(errors),
        flush=True,
    )
    for name, number in numeric.most_common(5):
        print(f"    bits of {name} in {number} answers, size by up to {size[name]:.1g}")
    for (name, old, new), number in words.most_common(8):
        print(f"    {name}: {old[:70]} -> {new[:70]}: {number}")
    return bool(numeric or words)


def parse_arguments(arguments: Sequence[str] | None) -> tuple[argparse.Namespace, list[str]]:
    """Return the options, and those of them that choose questions as arguments."""
    parser = argparse.ArgumentParser(prog="python -m tests.referee", description=__doc__)
    parser.add_argument("--before", metavar="REV", help="commit to compare this tree with")
    parser.add_argument("--answer", type=Path, help=argparse.SUPPRESS)
    chosen: Mapping[str, tuple[int, str]] = {
        "questions": (20, "of each public function; a quarter of the slow ones"),
        "stride": (40, "of the figures' 7,901 frequencies"),
        "beams": (4, "of the virtual benches; some 10 s each"),
        "structures": (100, "of the campaign on attractors"),
        "drives": (1, "at four rates, bonded and delaminated; some 100 s each"),
    }
    for name, (default, text) in chosen.items():
        parser.add_argument(f"--{name}", type=int, default=default, help=f"{text} ({default})")
    parser.add_argument("--only", nargs="+", metavar="GROUP", help="functions, beams, drives ...")
    parser.add_argument("--full", action="store_true", help=f"{FULL}")
    options = parser.parse_args(arguments)
    vars(options).update(FULL if options.full else {})
    again = [part for name in chosen for part in (f"--{name}", str(getattr(options, name)))]
    return options, again + (["--only", *options.only] if options.only else [])


def main(arguments: Sequence[str] | None = None) -> int:
    """Answer on both sides and compare; return 1 if anything differs."""
    options, again = parse_arguments(arguments)
    if options.answer:
        answer_all(options)
        return 0
    checkout = check_out(options.before)
    kept = run_side(checkout, checkout.parent / questions_digest(), again)
    print(f"{'':20}{'asked':>6}{'bits':>10}{'decided anew':>14}{'decisions':>12}{'undecided':>12}")
    differs = []
    with tempfile.TemporaryDirectory() as now:
        for path in sorted(run_side(ROOT, Path(now), again).glob("*.json")):
            after = json.loads(path.read_text())
            before = json.loads((kept / path.name).read_text())[: len(after)]
            differs += [path.stem] * compare(path.stem, before, after)
    print(f"differs: {', '.join(differs)}" if differs else "nothing differs")
    return int(bool(differs))


if __name__ == "__main__":
    sys.exit(main())
