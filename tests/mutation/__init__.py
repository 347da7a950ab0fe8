"""How the tests are measured: every number and comparison broken on purpose, one at a time."""
