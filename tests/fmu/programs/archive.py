"""The reference results, recomputed."""

import itertools

from driver import open_fmu


def reference_results(path, inputs, settings, names, times):

    def values(time):
        return dict(zip(inputs, [row for row in settings if row[0] <= time][-1][1:], strict=True))

    f = open_fmu(path).start(times[0], **values(times[0]))
    found = [f.get(*names)]
    for time, target in itertools.pairwise(times):
        f.set(**values(time))
        found.append(f.step(target).get(*names))
    return found
