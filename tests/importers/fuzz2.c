/* FMI 2.0 by bytes, see fuzz.h. */
#include "fuzz.h"
#include "version.h"

/* Most inputs begin where there is most to do. */
void fuzz_open(Bytes *in, Slot *slot) {
    slot->instance = fmu_open("%s%n");
    if (declared) fuzz_start(in, slot);
    else if (take(in) % 4) fmu_initialize(slot->instance, 0.0);
}

void fuzz_values(Bytes *in, void *instance) {
    unsigned refs[MOST];
    double reals[MOST] = {0.0};
    int whole[MOST], orders[MOST];
    size_t count = take(in) % (MOST + 1);
    for (size_t i = 0; i < MOST; i++) {
        refs[i] = any_reference(in);
        reals[i] = number_for(in, refs[i]);
        whole[i] = (int)take(in) - 8;
        orders[i] = (int)(take(in) % 6) - 1;
    }
    const unsigned *r = one_in(in, 32) ? NULL : refs;
    switch (take(in) % 8) {
    case 0: told(fmi.SetReal(instance, r, count, reals)); break;
    case 1: told(fmi.GetReal(instance, r, count, reals)); break;
    case 2: told(fmi.SetInteger(instance, r, count, whole)); break;
    case 3: told(fmi.GetInteger(instance, r, count, whole)); break;
    case 4: told(fmi.SetBoolean(instance, r, count, whole)); break;
    case 5: told(fmi.GetBoolean(instance, r, count, whole)); break;
    case 6: told(fmi.SetRealInputDerivatives(instance, r, count, orders, reals)); break;
    default: told(fmi.GetRealOutputDerivatives(instance, r, count, orders, reals)); break;
    }
}

void fuzz_life(Bytes *in, void *instance) {
    switch (take(in) % 5) {
    case 0: told(fmi.SetupExperiment(instance, fmi2False, 0.0, any_number(in), one_in(in, 2), any_number(in))); break;
    case 1: told(fmi.EnterInitializationMode(instance)); break;
    case 2: told(fmi.ExitInitializationMode(instance)); break;
    case 3: told(one_in(in, 4) ? fmi.Terminate(instance) : fmi2OK); break;
    default: fuzz_reset(in, instance); break;
    }
}

void fuzz_rest(Bytes *in, void *instance) {
    fmi2Status status;
    int whole;
    double real;
    fmi2String text;
    fmi2StatusKind kind = (fmi2StatusKind)(take(in) % 4);
    told(fmi.GetStatus(instance, kind, &status));
    told(fmi.GetRealStatus(instance, kind, &real));
    told(fmi.GetIntegerStatus(instance, kind, &whole));
    told(fmi.GetBooleanStatus(instance, kind, &whole));
    told(fmi.GetStringStatus(instance, kind, &text));
    told(fmi.CancelStep(instance));
    told(fmi.SetDebugLogging(instance, one_in(in, 2), 0, NULL));
}

void fuzz_step(Bytes *in, void *instance, double time, double size) { told(fmi.DoStep(instance, time, size, one_in(in, 2))); }
