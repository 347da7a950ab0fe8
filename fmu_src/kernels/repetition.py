"""After how many periods a response repeats, decided by one code for Python and C.

In the subset of Python that :mod:`fmu_src.export.translation` translates, over a flat memory: a
head, the stroboscopic states as they come, some of them over the motion's size, a row for each
co-ordinate, and room for deviations.
"""

# slots of the head, then the states
COUNT, FREQUENCY, GAP, TOLERANCE, MULTIPLICITY, DECIDED, DEVIATION, LATER, AWAY = range(9)
# of :func:`confirm_by_impacts`: impacts over the samples, over as many periods as it repeats
# after, and whether no motion without impacts exists
IMPACTS, OWN_IMPACTS, MUST = range(9, 12)
SIZE, SIZE_OF_GAP, SIZE_OF_RATE = range(12, 15)  # of displacements, of the gap and of its rate
# of :func:`write_nearest_state`: the number of the state, its distance, and the state whose
# neighbour it is
NEAREST, DISTANCE, GIVEN = range(15, 18)
HEAD = 21
STATE, COLUMNS = 4, 6  # numbers of a state, and of a scaled one: the gap and its rate come last
IRREGULAR, REPEATED, UNDECIDED = 0, 1, 2
MIN_RELATIVE_GAP = 1.0 / 1048576.0  # of the motion's size: smaller gaps are as large
ROUNDING = 1e-9  # of the motion's size: what is left of deviations that have died, with room
BLOCKS = 5  # parts of the later half from each of which to the next a dying deviation shrinks
CHANCE = 1.0512710963760241  # exp(0.05): ratio of deviations that chance makes
MAX_DRIFT = 1e-4  # of a distance that stays: change over the samples, of one that dies it is more
MAX_DYING_RATIO = 0.8  # ratio of deviations late and early, below which they die
MIN_VISITS = 5  # a quarter of the samples over it: periods after which states are seen often enough
MAX_CONTRACTION = 0.6  # over half of all samples: ratio of deviations that shrink, beyond chance
NEGLIGIBLE = 1e-3  # of the tolerance: counts as no deviation where it is seen a few times only
INFINITE = float("inf")


def memory_size(count: int) -> int:
    return HEAD + (STATE + COLUMNS + 1) * count


def write_decided_multiplicity(m, time):
    """Decide a response's multiplicity: its deviations must have died or be decaying.

    Of the later half of the samples, as parts of the motion's size:

    - *Repeated* after n periods: states n apart agree within the tolerance; the drift that
      remains is below the tolerance too; and states a divisor of n apart keep a steady difference.
    - An n above a quarter of these samples returns too rarely for that: it counts if no smaller one
      agrees and the deviation is below ``NEGLIGIBLE`` of the tolerance.
    - *Undecided*, with the best guess: some n agrees but is not confirmed, or a deviation shrinks
      (to ``MAX_DYING_RATIO`` if some n agrees, of all samples to ``MAX_CONTRACTION`` if none does).
    - *Undecided* too if only n up to three quarters of all samples agrees.
    - *Irregular*: all else, also where the states of each n that agrees drift steadily.
    """
    write_scaled_states(m, int(m[COUNT] / 2))
    count, limit, tolerance = int(m[LATER]), max_multiplicity(m), m[TOLERANCE]
    many = int(count / 4)
    nearly, drifting, n = 0, 0, next_repetition(m, 0, limit, tolerance)
    while n > 0:
        largest = measure_deviations(m, n)
        if n > many:
            if nearly == 0 and drifting == 0 and largest <= NEGLIGIBLE * tolerance:
                return write_conclusion(m, n, REPEATED)
            if nearly == 0 and drifting == 0:
                nearly = n
            break
        growth = deviation_growth(m, count - n)
        spread = spread_over_returns(m, 0, count, n)
        left = ROUNDING
        minimum = spread / MAX_DRIFT
        if spread > ROUNDING:
            left = estimate_remaining_drift(m, n, spread)
            minimum = tolerance
        minimum = max(minimum, 4.0 * left)
        if left <= tolerance and has_persistent_difference(m, n, minimum):
            return write_conclusion(m, n, REPEATED)
        if spread > tolerance and not is_beyond_chance(growth):
            drifting = n
        elif nearly == 0:
            nearly = n
        n = next_repetition(m, n, limit, tolerance)
    ratio = MAX_CONTRACTION
    last = int(many / MIN_VISITS)
    if nearly > 0:
        ratio = MAX_DYING_RATIO
        if last > nearly:
            last = nearly
    else:
        write_scaled_states(m, 0)
    for shorter in range(1, last + 1):
        if contraction_ratio(m, shorter) < ratio:
            return write_conclusion(m, shorter, UNDECIDED)
    if nearly == 0 and drifting == 0:  # of all samples: few states come back after n periods
        nearly = next_repetition(m, limit, int(m[COUNT]) - limit, tolerance)
    if nearly > 0:
        return write_conclusion(m, nearly, UNDECIDED)
    return write_conclusion(m, 0, IRREGULAR)


def write_least_multiplicity(m, time):
    """Find the least multiplicity within the tolerance, and the largest deviation from it."""
    write_scaled_states(m, int(m[COUNT] / 2))
    n = next_repetition(m, 0, max_multiplicity(m), m[TOLERANCE])
    m[DEVIATION] = INFINITE
    if n > 0:
        m[DEVIATION] = measure_deviations(m, n)
    return write_conclusion(m, n, IRREGULAR)


def confirm_by_impacts(m, time):
    """Make a decision undecided where impacts contradict it.

    - *Repeated*: the samples do not have the impacts of a motion with so many in n periods, up to
      one at either end, or these are too few.
    - *Irregular*: the samples have no impacts. Then the motion is linear, and converges.
    """
    n, found, own = int(m[MULTIPLICITY]), m[IMPACTS], m[OWN_IMPACTS]
    if m[DECIDED] == IRREGULAR and found == 0.0:
        return write_conclusion(m, 1, UNDECIDED)
    if m[DECIDED] != REPEATED:
        return 0
    whole = int(m[COUNT] / n)
    parts = whole
    if whole * n < m[COUNT]:
        parts = whole + 1
    repeats = whole * own - 1.0 <= found and found <= parts * own + 1.0
    if lacks_impacts(own, n, m[MUST]) or not repeats:
        m[DECIDED] = UNDECIDED
    return 0


def write_nearest_state(m, time):
    """Write the number of the state nearest to a given one, and its distance over the size."""
    write_scaled_states(m, 0)
    count, rows = int(m[LATER]), first_scaled_slot(m)
    x1, x2 = m[GIVEN] / m[SIZE], m[GIVEN + 1] / m[SIZE]
    v1, v2 = m[GIVEN + 2] / m[FREQUENCY], m[GIVEN + 3] / m[FREQUENCY]
    gap, rate = (m[GIVEN + 1] - m[GIVEN]) / m[SIZE_OF_GAP], (v2 - v1) / m[SIZE_OF_RATE]
    v1, v2 = v1 / m[SIZE], v2 / m[SIZE]
    m[DISTANCE] = INFINITE
    for k in range(count):
        at = rows + k
        away = max(abs(m[at] - x1), abs(m[at + count] - x2), abs(m[at + 2 * count] - v1))
        away = max(away, abs(m[at + 3 * count] - v2), abs(m[at + 4 * count] - gap))
        away = max(away, abs(m[at + 5 * count] - rate))
        if away < m[DISTANCE]:
            m[DISTANCE] = away
            m[NEAREST] = k
    return 0


def lacks_impacts(impacts, n, must_impact):
    """Return whether no impacts are too few for n periods to last."""
    return impacts == 0.0 and (must_impact != 0.0 or n > 1)


def write_conclusion(m, n, decided):
    m[MULTIPLICITY] = n
    m[DECIDED] = decided
    return 0


def max_multiplicity(m):
    """Return the largest number of periods to test: a quarter of the samples."""
    quarter = int(m[COUNT] / 4)
    if quarter < 1:
        quarter = 1
    return quarter


def write_scaled_states(m, first):
    """Write the states from ``first`` on, a row per co-ordinate, over the motion's size or gap."""
    count = int(m[COUNT])
    later = count - first
    m[LATER] = later
    states = HEAD + STATE * first
    rows = HEAD + STATE * count
    m[AWAY] = rows + COLUMNS * count
    size, rate = 0.0, 0.0
    for k in range(later):
        at = states + STATE * k
        x1, x2 = m[at], m[at + 1]
        v1, v2 = m[at + 2] / m[FREQUENCY], m[at + 3] / m[FREQUENCY]
        size = max(size, abs(x1), abs(x2), abs(v1), abs(v2))
        rate = max(rate, abs(v2 - v1))
    if size == 0.0:
        size = 1.0
    of_gap = max(m[GAP], MIN_RELATIVE_GAP * size)
    of_rate = max(of_gap, rate)
    m[SIZE], m[SIZE_OF_GAP], m[SIZE_OF_RATE] = size, of_gap, of_rate
    for k in range(later):
        at = states + STATE * k
        x1, x2 = m[at], m[at + 1]
        v1, v2 = m[at + 2] / m[FREQUENCY], m[at + 3] / m[FREQUENCY]
        m[rows + k] = x1 / size
        m[rows + later + k] = x2 / size
        m[rows + 2 * later + k] = v1 / size
        m[rows + 3 * later + k] = v2 / size
        m[rows + 4 * later + k] = (x2 - x1) / of_gap
        m[rows + 5 * later + k] = (v2 - v1) / of_rate


def first_scaled_slot(m):
    return HEAD + STATE * int(m[COUNT])


def next_repetition(m, before, limit, tolerance):
    """Return the next number of periods after which all states agree within the tolerance, or 0."""
    count, rows = int(m[LATER]), first_scaled_slot(m)
    for n in range(before + 1, limit + 1):
        if n < count and do_states_agree(m, rows, count, n, tolerance):
            return n
    return 0


def do_states_agree(m, rows, count, n, tolerance):
    for k in range(count - n):
        for column in range(COLUMNS):
            at = rows + column * count + k
            if not abs(m[at + n] - m[at]) <= tolerance:
                return False
    return True


def measure_deviations(m, n):
    """Write the largest difference of each state from that n periods before; return the largest."""
    count, rows, away = int(m[LATER]), first_scaled_slot(m), int(m[AWAY])
    largest = 0.0
    for k in range(count - n):
        deviation = 0.0
        for column in range(COLUMNS):
            at = rows + column * count + k
            deviation = max(deviation, abs(m[at + n] - m[at]))
        m[away + k] = deviation
        largest = max(largest, deviation)
    return largest


def largest_deviation_between(m, first, last):
    away = int(m[AWAY])
    largest = 0.0
    for k in range(first, last):
        largest = max(largest, m[away + k])
    return largest


def deviation_growth(m, length):
    """Return the maximum of the later half of deviations over that of the earlier half."""
    half = int(length / 2)
    early, late = (
        largest_deviation_between(m, 0, half),
        largest_deviation_between(m, length - half, length),
    )
    if early == 0.0 or late == 0.0:
        return 1.0
    return late / early


def is_beyond_chance(growth):
    """Return whether a ratio of deviations is more than chance makes."""
    return growth > CHANCE or growth * CHANCE < 1.0


def spread_over_returns(m, first, last, n):
    """Return how far states in a range lie apart at most that n, 2n, 3n ... periods separate."""
    count, rows = int(m[LATER]), first_scaled_slot(m)
    widest = 0.0
    for column in range(COLUMNS):
        row = rows + column * count
        for phase in range(first, first + n):
            low = high = m[row + phase]
            k = phase + n
            while k < last:
                low = min(low, m[row + k])
                high = max(high, m[row + k])
                k = k + n
            widest = max(widest, high - low)
    return widest


def estimate_remaining_drift(m, n, spread):
    """Estimate what n-periodic states still drift: q of the spread, a geometric series."""
    ratio = contraction_ratio(m, n)
    if ratio >= MAX_DYING_RATIO:
        return INFINITE
    q = ratio * ratio  # over twice the time
    return spread * q / (1.0 - q)


def contraction_ratio(m, n):
    """Return the late spread of states n apart over the early one, turns included; 1: unknown."""
    count = int(m[LATER])
    half = int(count / 2)
    if 4 * n > half:  # seen too seldom: from the deviations themselves
        measure_deviations(m, n)
        length = count - n
        if length < BLOCKS:
            return 1.0
        before, end = INFINITE, 0
        for block in range(BLOCKS):
            begin = end
            end = begin + int(length / BLOCKS)
            if block < length % BLOCKS:
                end = end + 1
            largest = largest_deviation_between(m, begin, end)
            if largest >= before:
                return 1.0
            before = largest
        return deviation_growth(m, length)
    early = spread_over_returns(m, 0, half, n)
    late = spread_over_returns(m, count - half, count, n)
    if early == 0.0:
        return 1.0
    return late / early


def has_persistent_difference(m, n, minimum):
    """Return whether states a divisor of n periods apart keep a steady difference.

    Next to a period doubling the deviation after half the periods dies slowly: while it does,
    nothing tells the response from the doubled one.
    """
    count = int(m[LATER])
    for divisor in range(1, n):
        if n % divisor == 0:
            measure_deviations(m, divisor)
            length = count - divisor
            if largest_deviation_between(m, length - n, length) <= minimum:
                return False
            if is_beyond_chance(deviation_growth(m, length)):
                return False
    return True
