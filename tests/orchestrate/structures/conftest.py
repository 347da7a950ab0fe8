"""Property tests with the same examples on every machine, however slow."""

from __future__ import annotations

from hypothesis import settings

settings.register_profile("the same everywhere", deadline=None, derandomize=True, database=None)
settings.load_profile("the same everywhere")
