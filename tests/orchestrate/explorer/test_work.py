"""No computation of the page keeps others waiting: the work between two pauses, counted.

Counts are the same on every machine, however busy: they stand where times would fail by chance.
"""

import pytest

from orchestrate.explorer.bundle import bundle
from orchestrate.explorer.page import read_modules

from ...sparing import ordinary

PROBE = """
import { Oscillator } from "./kernel.js";
import { load } from "./payload.js";
import { TASKS } from "./tasks.js";
load().then(({ compiled }) => {
  window.probe = { instance: new Oscillator(compiled.oscillator), TASKS };
});
"""
LONGEST = """
const [task, asked, eta, changes] = arguments;
const { instance, TASKS } = window.probe;
const structure = { ...explorer.table.usual, ...changes };
const frequency = eta * Math.sqrt(structure.k1 / structure.m1);
const point = { structure, eta, frequency, amplitude: 1 / (eta * eta) };
const proto = Object.getPrototypeOf(Object.getPrototypeOf(instance));
const call = proto.call;
let work = 0;
instance.call = function (...words) {
  const before = instance.get("impact_count");
  call.apply(instance, words);
  work += 1 + Math.max(0, instance.get("impact_count") - before);
};
const found = [];
const settings = { transient: 500, samples: 200, tolerance: 1e-2 };
for (const _ of TASKS[task](instance, { point, start: [0, 0, 0, 0], settings, ...asked })) {
  found.push(work);
  work = 0;
}
return [...found, work];
"""
PLANE = {"side": 64, "gap": 3.0, "speed": 3.0, "mean": [0.0, 0.0]}
TASKS = {  # what a worker is asked, and how often it hands over at the least
    "motion": ({"periods": 200, "points": 200}, 3),
    "basin": ({"plane": PLANE, "cells": [[32, 32], [5, 60]]}, 2),
    "section": ({"periods": 2000}, 10),
    "spectra": ({}, 40),
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
    """Another task has the instance in every pause."""
    same = """
    const { instance, TASKS } = window.probe;
    const structure = explorer.table.usual;
    const point = { structure, eta: 0.3, frequency: 0.3, amplitude: 1 / (0.3 * 0.3) };
    const settings = { transient: 500, samples: 200, tolerance: 1e-2 };
    const asked = { point, start: [0, 0, 0, 0], settings, periods: 100, points: 200 };
    const run = (between) => {
      let pauses = 0;
      for (const part of TASKS.motion(instance, asked)) {
        if (part) return [pauses, Array.from(part.motion.states)];
        pauses += 1;
        if (between) instance.begin({ ...point, frequency: 2.9 }, [0, 0, 1, -1]);
      }
    };
    const [[first, alone], [second, shared]] = [run(false), run(true)];
    return [first, second, alone.length, alone.every((value, i) => value === shared[i])];
    """
    first, second, count, alike = probed.run(same)
    assert first == second > 2 and count > 80_000 and alike
