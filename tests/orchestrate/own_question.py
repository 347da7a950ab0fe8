"""A user's own question as a plain script: an own beam, a map on two processes, kept on disk."""

import sys

import orchestrate

print("begun", flush=True)
own = orchestrate.Structure(m1=0.8, m2=1.1, k1=5000.0, k2=7500.0, d1=1.3, d2=0.9, e=0.6)
found = orchestrate.map(
    own,
    frequency=[55.0, 63.0, 80.0],
    amplitude=1e-3,
    e=[0.3, 0.5, 0.7],
    transient=300,
    jobs=2,
    store=sys.argv[1],
    keep_stale="keep" in sys.argv,
)
print("impacts per period", found.impacts_per_period.values.tolist())
