"""``orchestrate paper`` as its users run it."""

import contextlib
import sqlite3

from .command import Sweeps


class Papers(Sweeps):
    """Paper commands at the reduced resolution, with one results folder."""

    COMMAND = "paper"

    def start(self, *options, preexec_fn=None):
        """Start one."""
        return super().start("--quick", *options, preexec_fn=preexec_fn)

    def chunks(self, name):
        """Chunks on disk, all of the rows of the journal."""
        with contextlib.suppress(sqlite3.Error):
            database = sqlite3.connect(f"file:{self.journal(name)}?mode=ro", uri=True, timeout=5.0)
            try:
                return database.execute("SELECT COUNT(*) FROM rows").fetchone()[0]
            finally:
                database.close()
        return 0

    def wait_for_chunks(self, process, name, least):
        """Wait until so many chunks are on disk; returns their number."""
        self.wait_for(lambda: self.chunks(name) >= least, process, f"chunk {least} of {name} was on disk")
        return self.chunks(name)
