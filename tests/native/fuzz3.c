/* FMI 3.0 by bytes, see fuzz.h. */
#include "fuzz.h"
#include "importer3.h"

enum { INSTANCES = 3, MOST = 3, ROOM = 1024 };

typedef struct { fmi3Instance c; fmi3FMUState state; double time; } Slot;

/* Every refusal comes with a message. */
static void told(fmi3Status status) {
    CHECK(status == fmi3OK || messages > 0);
    messages = 0;
}

static void values(Bytes *in, fmi3Instance c) {
    static _Thread_local double reals[ROOM];
    unsigned refs[MOST];
    fmi3Int32 whole[MOST], orders[MOST];
    fmi3Boolean truth[MOST];
    fmi3Clock ticks[MOST];
    size_t count = take(in) % (MOST + 1), size = one_in(in, 4) ? (size_t)take(in) * 4 : count;
    for (size_t i = 0; i < MOST; i++) {
        refs[i] = any_reference(in);
        reals[i] = any_number(in);
        whole[i] = (fmi3Int32)take(in) - 8;
        truth[i] = one_in(in, 2);
        orders[i] = (fmi3Int32)(take(in) % 6) - 1;
    }
    bool none = one_in(in, 32);
    const unsigned *r = none ? NULL : refs;
    size_t few = size > MOST ? MOST : size; /* as many as there is room for */
    switch (take(in) % 9) {
    case 0: told(fmi.SetFloat64(c, r, count, reals, size)); break;
    case 1: told(fmi.GetFloat64(c, r, count, reals, size)); break;
    case 2: told(fmi.SetInt32(c, r, count, whole, few)); break;
    case 3: told(fmi.GetInt32(c, r, count, whole, few)); break;
    case 4: told(fmi.SetBoolean(c, r, count, truth, few)); break;
    case 5: told(fmi.GetBoolean(c, r, count, truth, few)); break;
    case 6: told(fmi.GetClock(c, r, count, ticks)); break;
    case 7: told(fmi.SetFloat32(c, r, count, NULL, few)); break;
    default: told(fmi.GetOutputDerivatives(c, r, count, orders, reals, size)); break;
    }
}

static void step(Bytes *in, Slot *slot, double now, double size) {
    fmi3Boolean event, end, early;
    double last;
    told(fmi.DoStep(slot->c, now, size, one_in(in, 2), &event, &end, &early, one_in(in, 64) ? NULL : &last));
}

/* The time reached: the independent variable. */
static void look(Slot *slot) {
    unsigned time = TIME_REFERENCE;
    double reached;
    if (fmi.GetFloat64(slot->c, &time, 1, &reached, 1) == fmi3OK) slot->time = reached;
    messages = 0;
}

/* Saved, damaged at a place, sealed or not, and read again. */
static void serialised(Bytes *in, Slot *slot) {
    char *bytes;
    size_t size = fmu_save(slot->c, &bytes), place = ((size_t)take(in) * 256 + take(in)) % size;
    bool damaged = !one_in(in, 3);
    if (damaged) bytes[place] ^= (char)take(in);
    if (one_in(in, 2)) seal(bytes, size);
    messages = 0;
    fmi3FMUState state = NULL;
    fmi3Status status = fmi.DeserializeFMUState(slot->c, (fmi3Byte *)bytes, one_in(in, 16) ? size - 1 : size, &state);
    told(status);
    if (status == fmi3OK && fmi.SetFMUState(slot->c, state) == fmi3OK) {
        look(slot);
        step(in, slot, slot->time, damaged ? 0x1p-20 : 0.25);
        if (damaged) told(fmi.Reset(slot->c)); /* what nobody saved may take long to step */
        look(slot);
    }
    fmi.FreeFMUState(slot->c, &state);
    free(bytes);
}

static void life(Bytes *in, fmi3Instance c) {
    fmi3Boolean news[5];
    double next;
    switch (take(in) % 8) {
    case 0: told(fmi.EnterInitializationMode(c, false, 0.0, any_number(in), one_in(in, 2), any_number(in))); break;
    case 1: told(fmi.ExitInitializationMode(c)); break;
    case 2: told(fmi.EnterEventMode(c)); break;
    case 3: told(fmi.EnterStepMode(c)); break;
    case 4: told(fmi.UpdateDiscreteStates(c, news, news + 1, news + 2, news + 3, news + 4, &next)); break;
    case 5: told(fmi.EvaluateDiscreteStates(c)); break;
    case 6: told(one_in(in, 4) ? fmi.Terminate(c) : fmi3OK); break;
    default: told(one_in(in, 2) ? fmi.Reset(c) : fmi.EnterConfigurationMode(c)); break;
    }
}

static void call(Bytes *in, Slot *slot) {
    switch (take(in) % 12) {
    case 0: case 1: case 2: values(in, slot->c); break;
    case 3: case 4: case 5: life(in, slot->c); break;
    case 6: serialised(in, slot); break;
    case 7: told(fmi.GetFMUState(slot->c, &slot->state)); break;
    case 8: if (slot->state) { told(fmi.SetFMUState(slot->c, slot->state)); look(slot); } break;
    default:
        step(in, slot, one_in(in, 16) ? any_number(in) : slot->time, any_step(in));
        look(slot);
    }
}

void fuzz(const uint8_t *data, size_t size) {
    Bytes in = {data, data + size};
    Slot slots[INSTANCES] = {0};
    for (int i = 0; i < INSTANCES; i++) {
        uint8_t options = take(&in);
        slots[i].c = open_with("%s%n", options & 1, options & 2);
        /* most inputs begin where there is most to do */
        if (options & 12) fmu_initialize(slots[i].c, 0.0);
        if ((options & 13) > 1 && options & 1) told(fmi.EnterStepMode(slots[i].c));
    }
    while (in.at < in.end) call(&in, &slots[take(&in) % INSTANCES]);
    for (int i = 0; i < INSTANCES; i++) {
        fmi.FreeFMUState(slots[i].c, &slots[i].state);
        fmi.FreeInstance(slots[i].c);
    }
}
