"""No computation of the page keeps others waiting: the work between two pauses, counted.

Counts are the same on every machine, however busy: they stand where times would fail by chance.
"""

import pytest

from orchestrate.explorer.bundle import bundle
from orchestrate.explorer.page import read_modules

from ...sparing import ordinary

PROBE = """
import { Library } from "./kernel.js";
import { useLibrary } from "./model.js";
import { load } from "./payload.js";
import { perform } from "./tasks.js";
load().then(({ compiled }) => {
  const library = new Library(compiled);
  useLibrary(library);
  window.probe = { library, perform: (task, asked) => perform(task, asked, library) };
});
"""
LONGEST = """
const [task, asked, eta, changes] = arguments;
const { library, perform } = window.probe;
const structure = { ...explorer.table.usual, ...changes };
const frequency = eta * Math.sqrt(structure.k1 / structure.m1);
const point = { structure, eta, frequency, amplitude: 1 / (eta * eta) };
const { calls, variables } = library;
const place = calls.malloc(8);
let work = 0;
// what a loop runs on begins with its FMU
const counted = (name) => (fmu, ...numbers) => {
  const impacts = () => {
    const words = library.view("u32", place, 2);
    words.set([variables.oscillator.impact_count, 0]);
    const [instance] = library.view("u32", fmu, 1);
    calls.oscillator_fmi3GetInt32(instance, place, 1, place + 4, 1); // 0 before it began
    return words[1];
  };
  const before = impacts();
  const answer = calls[name](fmu, ...numbers);
  work += 1 + Math.max(0, impacts() - before);
  return answer;
};
library.calls = { ...calls };
for (const name of ["begin", "respond", "sample_evenly", "play"]) {
  library.calls[name] = counted(name);
}
const found = [];
const settings = { transient: 500, samples: 200, tolerance: 1e-2 };
for (const _ of perform(task, { point, start: [0, 0, 0, 0], settings, ...asked })) {
  found.push(work);
  work = 0;
}
library.calls = calls;
calls.free(place);
return [...found, work];
"""
PLANE = {"side": 64, "gap": 3.0, "speed": 3.0, "mean": [0.0, 0.0]}
TASKS = {  # what a worker is asked, and how often it hands over at the least
    "motion": ({"periods": 200, "points": 200}, 3),
    "basin": ({"plane": PLANE, "cells": [[32, 32], [5, 60]]}, 2),
    "section": ({"periods": 2000}, 10),
    "spectra": ({}, 30),
}
MOST = 25_000  # impacts and steps: 5 to 15 ms on a core of today


@pytest.fixture(scope="module")
def probed(chromium, page):
    """The page, with the kernel and what workers compute at hand."""
    chromium.open(page)
    chromium.run(bundle({**read_modules(), "probe": PROBE}, "probe"))
    chromium.until("return Boolean(window.probe)")
    yield chromium
    assert chromium.console() == []


@pytest.mark.parametrize("task", TASKS)
@pytest.mark.parametrize("eta", ordinary([0.1, 0.3, 2.9]))
def test_little_is_done_between_two_pauses(probed, task, eta):
    asked, least = TASKS[task]
    work = probed.run(LONGEST, task, asked, eta, {})
    assert len(work) > least and max(work) <= MOST, work


def test_a_motion_that_paused_goes_on_as_if_it_had_not(probed):
    """Other tasks have their turn in every pause, and one is called off."""
    same = """
    const { perform, library } = window.probe;
    const structure = explorer.table.usual;
    const at = (eta) => ({ structure, eta, frequency: eta, amplitude: 1 / (eta * eta) });
    const settings = { transient: 500, samples: 200, tolerance: 1e-2 };
    const asked = { start: [0, 0, 0, 0], settings, periods: 100, points: 200 };
    const task = (eta) => perform("motion", { ...asked, point: at(eta) });
    const run = (between) => {
      let pauses = 0;
      for (const part of task(0.3)) {
        if (part) return [pauses, Array.from(part.motion.states)];
        pauses += 1;
        if (between) {
          const other = task(0.31);
          other.next();
          other.return();
        }
      }
    };
    const [[first, alone], [second, shared]] = [run(false), run(true)];
    const size = library.memory.buffer.byteLength;
    for (let i = 0; i < 20; i++) run(true);
    const grown = library.memory.buffer.byteLength - size;
    return [first, second, alone.length, alone.every((value, i) => value === shared[i]), grown];
    """
    first, second, count, alike, grown = probed.run(same)
    assert first == second > 2 and count > 80_000 and alike and not grown
