"""Tests, with linear algebra in one thread: other processors have tests of their own to run."""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
