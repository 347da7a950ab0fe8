/* FMI 3.0 by bytes, see fuzz.h. */
#include "fuzz.h"
#include "version.h"

enum { ROOM = 1024 };

/* Most inputs begin where there is most to do. */
void fuzz_open(Bytes *in, Slot *slot) {
    uint8_t options = take(in);
    bool events = options & 1;
    slot->instance = open_with("%s%n", events, options & 2);
    if (declared) fuzz_start(in, slot);
    else if (options & 12) fmu_initialize(slot->instance, 0.0);
    if ((options & 12) && events) told(fmi.EnterStepMode(slot->instance));
}

void fuzz_values(Bytes *in, void *instance) {
    static _Thread_local double reals[ROOM];
    unsigned refs[MOST];
    fmi3Int32 whole[MOST], orders[MOST];
    fmi3Boolean truth[MOST];
    fmi3Clock ticks[MOST];
    size_t count = take(in) % (MOST + 1), size = one_in(in, 4) ? (size_t)take(in) * 4 : count;
    for (size_t i = 0; i < MOST; i++) {
        refs[i] = any_reference(in);
        reals[i] = number_for(in, refs[i]);
        whole[i] = (fmi3Int32)take(in) - 8;
        truth[i] = one_in(in, 2);
        orders[i] = (fmi3Int32)(take(in) % 6) - 1;
    }
    const unsigned *r = one_in(in, 32) ? NULL : refs;
    size_t few = size > MOST ? MOST : size; /* as many as there is room for */
    switch (take(in) % 9) {
    case 0: told(fmi.SetFloat64(instance, r, count, reals, size)); break;
    case 1: told(fmi.GetFloat64(instance, r, count, reals, size)); break;
    case 2: told(fmi.SetInt32(instance, r, count, whole, few)); break;
    case 3: told(fmi.GetInt32(instance, r, count, whole, few)); break;
    case 4: told(fmi.SetBoolean(instance, r, count, truth, few)); break;
    case 5: told(fmi.GetBoolean(instance, r, count, truth, few)); break;
    case 6: told(fmi.GetClock(instance, r, count, ticks)); break;
    case 7: told(fmi.SetFloat32(instance, r, count, NULL, few)); break;
    default: told(fmi.GetOutputDerivatives(instance, r, count, orders, reals, size)); break;
    }
}

void fuzz_life(Bytes *in, void *instance) {
    switch (take(in) % 4) {
    case 0: told(fmi.EnterInitializationMode(instance, false, 0.0, any_number(in), one_in(in, 2), any_number(in))); break;
    case 1: told(fmi.ExitInitializationMode(instance)); break;
    case 2: told(one_in(in, 4) ? fmi.Terminate(instance) : fmi3OK); break;
    default: one_in(in, 2) ? fuzz_reset(in, instance) : told(fmi.EnterConfigurationMode(instance)); break;
    }
}

/* Events. */
void fuzz_rest(Bytes *in, void *instance) {
    fmi3Boolean news[5];
    double next;
    switch (take(in) % 4) {
    case 0: told(fmi.EnterEventMode(instance)); break;
    case 1: told(fmi.EnterStepMode(instance)); break;
    case 2: told(fmi.UpdateDiscreteStates(instance, news, news + 1, news + 2, news + 3, news + 4, &next)); break;
    default: told(fmi.EvaluateDiscreteStates(instance)); break;
    }
}

void fuzz_step(Bytes *in, void *instance, double time, double size) {
    fmi3Boolean event, end, early;
    double last;
    told(fmi.DoStep(instance, time, size, one_in(in, 2), &event, &end, &early, one_in(in, 64) ? NULL : &last));
}
