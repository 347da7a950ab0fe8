"""Runs of responses as the public functions have them by default."""

from functools import partial

from orchestrate.dynamics.clusters import SettlingRun

settling_run = partial(SettlingRun, transient=400, settle=300.0, samples=48)
