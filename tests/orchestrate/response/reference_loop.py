"""The loop of responses by calls of the FMU one after the other: slow, to compare."""

import math

import numpy as np

from fmu_src.kernels import repetition
from orchestrate.fmu import begin, gap_between
from orchestrate.fmu.oscillator import PEAKS, SAMPLE_SERIES
from orchestrate.model.outcomes import REPEATED
from orchestrate.response.response_loop import COUNTED, COUNTS, Responses, traits_of


def respond(instance, points, starts, settings):
    """What the compiled loop answers."""
    count = len(points)
    results = Responses(
        states=np.empty((count, settings.samples, 4)),
        ends=np.empty((count, 4)),
        x_rel_max=np.empty(count),
        impacts=np.empty(count),
        deviations=np.zeros(count),
        peaks=np.zeros((count, len(PEAKS))),
        counts={name: np.zeros(count, np.int32) for name in COUNTS},
        must_impact=np.array([bool(traits_of(point)[-1]) for point in points]),
    )
    transients = np.broadcast_to(settings.transient, count).tolist()
    given, gap = np.atleast_2d(np.asarray(starts, dtype=float)), settings.chain_gap
    for i, point in enumerate(points):
        start = given[0 if settings.is_chain else i]
        if settings.is_chain:
            start, offset = results.ends[i - 1] if i else start, point.structure.gap_offset
            if gap is not None and gap != offset and np.any(start):
                start = np.add(start, (0.0, gap - offset, 0.0, 0.0))
                if gap_between(start, offset) < 0.0:  # by rounding
                    start[1] = start[0] - offset
            gap = offset
        begin(instance, *point, start)
        sample(instance, point, transients[i], settings.samples, results, i)
        decide(instance, point, transients[i] + settings.samples, settings, results, i)
    return results


def sample(instance, point, transient, samples, results, i):
    """Run through transient and samples."""
    period = point.excitation.period
    if transient:
        instance.step(0.0, transient * period)
    counts = instance.get("impact_count", "contact_count", "in_contact")
    results.states[i], results.x_rel_max[i] = stroboscopic(instance, period, transient, samples)
    counts += instance.get("impact_count", "contact_count")
    for name, number in zip(COUNTED, counts, strict=True):
        results.counts[name][i] = number
    results.impacts[i] = (counts[3] - counts[0]) / samples
    results.ends[i] = round_state(results.states[i, -1], point.structure.gap_offset)


def decide(instance, point, first, settings, results, i):
    """Apply the rule of repetition, and run on for peaks and for the impacts of what repeats."""
    counts = results.counts

    def rule(name, tolerance):
        memory = [0.0] * repetition.memory_size(settings.samples)
        head = settings.samples, point.excitation.frequency, float(results.x_rel_max[i]), tolerance
        memory[: repetition.MULTIPLICITY] = head
        states = results.states[i].ravel().tolist()
        memory[repetition.HEAD : repetition.HEAD + len(states)] = states
        getattr(repetition, name)(memory, 0.0)
        return memory

    if settings.loose:
        near = rule("repeat", settings.loose)
        counts["nearly"][i] = near[repetition.MULTIPLICITY]
        results.deviations[i] = near[repetition.DEVIATION]
        counts["multiplicity"][i] = rule("repeat", settings.tolerance)[repetition.MULTIPLICITY]
    if not settings.decides:
        return
    memory = rule("decide", settings.tolerance)
    n = counts["multiplicity"][i] = int(memory[repetition.MULTIPLICITY])
    span = periods_to_sample(n, settings.peak_periods)
    begun, done, end = ((first + count) * point.excitation.period for count in (0, span, n))
    instance.set(x_rel_max_on=False)
    instance.set(sample_count=0, peaks_on=True)
    instance.step(begun, done)
    results.peaks[i] = instance.get(*PEAKS)
    instance.set(peaks_on=False)
    if memory[repetition.DECIDED] == REPEATED:
        if n > span:
            instance.step(done, end)
        own = instance.get("impact_count")[0] - counts["impacts_after"][i]
        memory[repetition.OWN_IMPACTS] = float(own)
        results.impacts[i] = own / n
    memory[repetition.IMPACTS] = float(counts["impacts_after"][i] - counts["impacts_before"][i])
    memory[repetition.MUST] = float(results.must_impact[i])
    repetition.confirm(memory, 0.0)
    counts["multiplicity"][i] = int(memory[repetition.MULTIPLICITY])
    counts["decided"][i] = int(memory[repetition.DECIDED])


def last_samples(instance, count):
    """States kept in the last step."""
    return instance.read(*SAMPLE_SERIES).reshape(len(SAMPLE_SERIES), -1)[:, :count].T


def sampled(instance, time, target, count):
    """States at equal parts of a span."""
    room = instance.size(*SAMPLE_SERIES) // len(SAMPLE_SERIES)
    states, width = np.empty((count, 4)), (target - time) / count
    for done in range(0, count, room):
        size = min(room, count - done)
        instance.set(sample_count=size)
        instance.step(time + done * width, time + (done + size) * width)
        states[done : done + size] = last_samples(instance, size)
    return states


def stroboscopic(instance, period, transient, samples):
    """States at phase 0 of successive periods, and the largest gap."""
    room = instance.size(*SAMPLE_SERIES) // len(SAMPLE_SERIES)
    states, peak = np.empty((samples, 4)), 0.0
    for done in range(0, samples, room):
        count, first = min(room, samples - done), transient + done
        instance.set(x_rel_max_on=True, sample_count=count)
        instance.step(first * period, (first + count) * period)
        states[done : done + count] = last_samples(instance, count)
        peak = max(peak, *instance.get("x_rel_max"))
    return states, peak


def round_state(state, offset=0.0, bits=44):
    """A state to so many binary digits of the larger face, and of the larger velocity."""
    x1, x2, v1, v2 = state.tolist()
    velocities = round_to_bits(v1, v2, bits)
    if offset == 0.0:
        return (*round_to_bits(x1, x2, bits), *velocities)
    face_1, face_2 = round_to_bits(x1, x1 + float(gap_between(state, offset)), bits)
    return (face_1, face_2 - offset, *velocities)


def round_to_bits(first, second, bits):
    """Two numbers to so many binary digits of the larger one."""
    exponent = math.frexp(max(abs(first), abs(second)))[1]
    if exponent < -970:  # too small to have so many digits
        return first, second
    digit = math.ldexp(1.0, exponent - bits)
    return tuple(math.copysign(round(x / digit) * digit, x) for x in (first, second))


def periods_to_sample(multiplicity, max_periods):
    """Periods looked at for peaks: the multiplicity, or half of the most if none."""
    return min(multiplicity, max_periods) or (max_periods + 1) // 2
