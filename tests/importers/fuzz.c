/* What both FMI versions are put through, see fuzz.h. */
#include "fuzz.h"
#include "version.h"

enum { INSTANCES = 3, EVALUATIONS = 250 };
bool declared = false;

uint8_t take(Bytes *in) { return in->at < in->end ? *in->at++ : 0; }

bool one_in(Bytes *in, int count) { return take(in) % count == 0; }

/* Any variable, now and then no variable at all. */
unsigned any_reference(Bytes *in) {
    static const unsigned other[] = {0u, 1000u, 1005u, 1006u, 2000u, 2001u, 0x7fffffffu, 0xffffffffu};
    if (one_in(in, 8)) return other[take(in) % 8];
    unsigned place = take(in);
    return NAMES[(one_in(in, 16) ? place * 256u + take(in) : place % 48u) % NAME_COUNT].reference;
}

/* Numbers that keep a step short, and those that are refused; no driver of 1e30 rad/s, which is refused only after a second or two. */
double any_number(Bytes *in) {
    static const double special[] = {NAN, INFINITY, -INFINITY, -1.0, 0.0, 1.0, 0.5, 1e301};
    uint8_t kind = take(in);
    return kind < 64 ? special[kind % 8] : ((double)take(in) - 64.0) / 16.0;
}

/* A size between two, uniform in its logarithm; 0 is as small as there is. */
static double any_size(Bytes *in, double low, double high) {
    double first = low > 0.0 ? log2(low) : one_in(in, 4) ? -1074.0 : -log2(high), last = log2(high);
    double size = exp2(first + (last - first) * (take(in) * 256 + take(in)) / 65535.0);
    return fmin(fmax(size, low), high);
}

static const Name *variable_of(unsigned reference) {
    for (size_t i = 0; i < NAME_COUNT; i++) if (NAMES[i].reference == reference) return &NAMES[i];
    return NULL;
}

/* Ends of the range, zero, sizes about 1 and any other. */
double number_for(Bytes *in, unsigned reference) {
    const Name *name = variable_of(reference);
    if (!declared || !name || one_in(in, 16)) return any_number(in);
    double low = fmax(name->minimum, -1e308), high = fmin(name->maximum, 1e308);
    uint8_t kind = take(in) % 16;
    if (kind < 3) return (double[]){low, high, fmin(fmax(0.0, low), high)}[kind];
    double size = kind < 10 ? fmin(fmax(any_size(in, 0x1p-10, 0x1p10), fmax(low, 0.0)), high) : any_size(in, fmax(low, 0.0), high);
    return low < 0.0 && one_in(in, 2) ? -size : size;
}

static double any_step(Bytes *in) {
    static const double special[] = {NAN, INFINITY, -1.0, 5e-324, 0.0};
    if (declared && !one_in(in, 4)) return one_in(in, 2) ? any_size(in, 0x1p-6, 0x1p6) : any_size(in, 0x1p-40, one_in(in, 16) ? 0x1p1023 : 0x1p70);
    uint8_t kind = take(in);
    return kind < 32 ? special[kind % 5] : (kind - 31) / 64.0;
}

void told(int status) {
    CHECK(status == 0 || messages > 0);
    messages = 0;
}

/* Few evaluations: a step is short in time, whatever its length. */
static void limit_work(Bytes *in, void *instance) { fmu_set(instance, "evaluation_limit", 1.0 + take(in) % EVALUATIONS); }

void fuzz_reset(Bytes *in, void *instance) {
    Status status = fmi.Reset(instance);
    told(status);
    if (declared && status == FMI_OK) limit_work(in, instance);
}

static void set_any(Bytes *in, void *instance, const Name *name) {
    double real = number_for(in, name->reference);
    Integer whole = (Integer)take(in);
    Boolean truth = one_in(in, 2);
    told(name->type == 'R' ? set_reals(instance, &name->reference, 1, &real)
         : name->type == 'I' ? set_integers(instance, &name->reference, 1, &whole)
                             : set_booleans(instance, &name->reference, 1, &truth));
}

void fuzz_start(Bytes *in, Slot *slot) {
    limit_work(in, slot->instance);
    uint8_t few = take(in) % 4;
    for (size_t i = 0; i < NAME_COUNT; i++)
        if (NAMES[i].settable && strcmp(NAMES[i].name, "evaluation_limit") && !one_in(in, 1 + few)) set_any(in, slot->instance, &NAMES[i]);
    slot->time = one_in(in, 4) ? any_size(in, 0x1p-10, 0x1p60) : 0.0;
    told(start_experiment(slot->instance, slot->time, false, 0.0));
    told(fmi.ExitInitializationMode(slot->instance));
}

/* The time an instance has reached, where the FMU tells it. */
static double time_reached(void *instance, double otherwise) {
    double reached;
#if FMI_VERSION == 2
    Status status = fmi.GetRealStatus(instance, fmi2LastSuccessfulTime, &reached);
#else
    unsigned time = TIME_REFERENCE;
    Status status = get_reals(instance, &time, 1, &reached);
#endif
    told(status);
    return status == FMI_OK ? reached : otherwise;
}

/* Back to the state that was kept; whether the FMU takes it. */
static bool go_back(Slot *slot) {
    Status status = set_state(slot->instance, slot->state);
    told(status);
    return status == FMI_OK;
}

static void forget(Slot *slot) { told(free_state(slot->instance, &slot->state)); }

/* A byte changed anywhere, or a number of the state: another one, or that of another place. */
static void damage(Bytes *in, char *bytes, size_t size) {
    size_t place = (size_t)take(in) * 256 + take(in), count = size / sizeof(double) - 1; /* the last is the checksum */
    char *number = bytes + size - (place % count + 2) * sizeof(double);
    double value;
    switch (take(in) % 3) {
    case 0: bytes[place % size] ^= (char)take(in); return;
    case 1: value = any_number(in); break;
    default: memcpy(&value, bytes + size - ((size_t)take(in) % count + 2) * sizeof value, sizeof value);
    }
    memcpy(number, &value, sizeof value);
}

/* Saved, damaged or not, sealed or not, and read again. */
static void serialised(Bytes *in, Slot *slot) {
    char *bytes;
    size_t size = fmu_save(slot->instance, &bytes);
    bool damaged = !one_in(in, 3);
    for (int i = damaged ? 1 + take(in) % 3 : 0; i > 0; i--) damage(in, bytes, size);
    if (one_in(in, 2)) seal(bytes, size);
    messages = 0;
    Slot read = {.instance = slot->instance};
    Status status = deserialize(read.instance, bytes, one_in(in, 16) ? size - 1 : size, &read.state);
    told(status);
    if (status == FMI_OK && go_back(&read)) {
        slot->time = time_reached(slot->instance, slot->time);
        fuzz_step(in, slot->instance, slot->time, damaged ? 0x1p-20 : 0.25);
        if (damaged) fuzz_reset(in, slot->instance); /* what nobody saved may take long to step */
        slot->time = time_reached(slot->instance, slot->time);
    }
    forget(&read);
    free(bytes);
}

static void call(Bytes *in, Slot *slot) {
    switch (take(in) % 14) {
    case 0: case 1: case 2: fuzz_values(in, slot->instance); break;
    case 3: case 4: case 5: fuzz_life(in, slot->instance); break;
    case 6: case 7: serialised(in, slot); break;
    case 8: told(get_state(slot->instance, &slot->state)); break;
    case 9: if (slot->state) go_back(slot); break;
    case 10: fuzz_rest(in, slot->instance); break;
    default: {
        double size = any_step(in), time = one_in(in, 16) ? any_number(in) : slot->time;
        fuzz_step(in, slot->instance, time, size);
    }
    }
    slot->time = time_reached(slot->instance, slot->time);
}

void fuzz(const uint8_t *data, size_t size) {
    Bytes in = {data, data + size};
    Slot slots[INSTANCES] = {0};
    int count = declared ? 1 : INSTANCES; /* to make one takes longer than its calls */
    for (int i = 0; i < count; i++) fuzz_open(&in, &slots[i]);
    while (in.at < in.end) call(&in, &slots[take(&in) % count]);
    for (int i = 0; i < count; i++) {
        forget(&slots[i]);
        fmu_close(slots[i].instance);
    }
}
