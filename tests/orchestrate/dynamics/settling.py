"""Runs of responses as the public functions have them by default."""

from functools import partial

from orchestrate.dynamics.settling import SettlingSettings

settling_run = partial(SettlingSettings, transient=400, settle=300.0, samples=48)
