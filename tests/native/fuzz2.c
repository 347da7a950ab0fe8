/* FMI 2.0 by bytes, see fuzz.h. */
#include "fuzz.h"
#include "importer2.h"

enum { INSTANCES = 3, MOST = 3 };

typedef struct { fmi2Component c; fmi2FMUstate state; double time; } Slot;

/* Every refusal comes with a message. */
static void told(fmi2Status status) {
    CHECK(status == fmi2OK || messages > 0);
    messages = 0;
}

static void values(Bytes *in, fmi2Component c) {
    unsigned refs[MOST];
    double reals[MOST] = {0.0};
    int whole[MOST], orders[MOST];
    size_t count = take(in) % (MOST + 1);
    for (size_t i = 0; i < MOST; i++) {
        refs[i] = any_reference(in);
        reals[i] = any_number(in);
        whole[i] = (int)take(in) - 8;
        orders[i] = (int)(take(in) % 6) - 1;
    }
    bool none = one_in(in, 32);
    const unsigned *r = none ? NULL : refs;
    switch (take(in) % 8) {
    case 0: told(fmi.SetReal(c, r, count, reals)); break;
    case 1: told(fmi.GetReal(c, r, count, reals)); break;
    case 2: told(fmi.SetInteger(c, r, count, whole)); break;
    case 3: told(fmi.GetInteger(c, r, count, whole)); break;
    case 4: told(fmi.SetBoolean(c, r, count, whole)); break;
    case 5: told(fmi.GetBoolean(c, r, count, whole)); break;
    case 6: told(fmi.SetRealInputDerivatives(c, r, count, orders, reals)); break;
    default: told(fmi.GetRealOutputDerivatives(c, r, count, orders, reals)); break;
    }
}

/* Saved, damaged at a place, sealed or not, and read again. */
static void serialised(Bytes *in, Slot *slot) {
    char *bytes;
    size_t size = fmu_save(slot->c, &bytes), place = ((size_t)take(in) * 256 + take(in)) % size;
    bool damaged = !one_in(in, 3);
    if (damaged) bytes[place] ^= (char)take(in);
    if (one_in(in, 2)) seal(bytes, size);
    messages = 0;
    fmi2FMUstate state = NULL;
    fmi2Status status = fmi.DeSerializeFMUstate(slot->c, bytes, one_in(in, 16) ? size - 1 : size, &state);
    told(status);
    if (status == fmi2OK && fmi.SetFMUstate(slot->c, state) == fmi2OK) {
        told(fmi.GetRealStatus(slot->c, fmi2LastSuccessfulTime, &slot->time));
        told(fmi.DoStep(slot->c, slot->time, damaged ? 0x1p-20 : 0.25, fmi2True));
        if (damaged) told(fmi.Reset(slot->c)); /* what nobody saved may take long to step */
        told(fmi.GetRealStatus(slot->c, fmi2LastSuccessfulTime, &slot->time));
    }
    fmi.FreeFMUstate(slot->c, &state);
    free(bytes);
}

static void life(Bytes *in, fmi2Component c) {
    switch (take(in) % 5) {
    case 0: told(fmi.SetupExperiment(c, fmi2False, 0.0, any_number(in), one_in(in, 2), any_number(in))); break;
    case 1: told(fmi.EnterInitializationMode(c)); break;
    case 2: told(fmi.ExitInitializationMode(c)); break;
    case 3: told(one_in(in, 4) ? fmi.Terminate(c) : fmi2OK); break;
    default: told(fmi.Reset(c)); break;
    }
}

static void rest(Bytes *in, fmi2Component c) {
    fmi2Status status;
    int whole;
    double real;
    fmi2String text;
    fmi2StatusKind kind = (fmi2StatusKind)(take(in) % 4);
    told(fmi.GetStatus(c, kind, &status));
    told(fmi.GetRealStatus(c, kind, &real));
    told(fmi.GetIntegerStatus(c, kind, &whole));
    told(fmi.GetBooleanStatus(c, kind, &whole));
    told(fmi.GetStringStatus(c, kind, &text));
    told(fmi.CancelStep(c));
    told(fmi.SetDebugLogging(c, one_in(in, 2), 0, NULL));
}

static void call(Bytes *in, Slot *slot) {
    switch (take(in) % 12) {
    case 0: case 1: case 2: values(in, slot->c); break;
    case 3: case 4: life(in, slot->c); break;
    case 5: serialised(in, slot); break;
    case 6: told(fmi.GetFMUstate(slot->c, &slot->state)); break;
    case 7: if (slot->state) { told(fmi.SetFMUstate(slot->c, slot->state)); fmi.GetRealStatus(slot->c, fmi2LastSuccessfulTime, &slot->time); } break;
    case 8: rest(in, slot->c); break;
    default: {
        double step = any_step(in), now = one_in(in, 16) ? any_number(in) : slot->time;
        told(fmi.DoStep(slot->c, now, step, one_in(in, 2)));
        told(fmi.GetRealStatus(slot->c, fmi2LastSuccessfulTime, &slot->time));
    }
    }
}

void fuzz(const uint8_t *data, size_t size) {
    Bytes in = {data, data + size};
    Slot slots[INSTANCES] = {0};
    for (int i = 0; i < INSTANCES; i++) slots[i].c = fmu_open("%s%n");
    for (int i = 0; i < INSTANCES; i++)
        if (take(&in) % 4) fmu_initialize(slots[i].c, 0.0); /* most inputs begin where there is most to do */
    while (in.at < in.end) call(&in, &slots[take(&in) % INSTANCES]);
    for (int i = 0; i < INSTANCES; i++) {
        fmi.FreeFMUstate(slots[i].c, &slots[i].state);
        fmi.FreeInstance(slots[i].c);
    }
}
