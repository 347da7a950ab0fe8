/* An instance of an FMU as the loops call it: its functions by FMI 2.0 or 3.0, and what is done with them.
 *
 * The loops are written by hand, as they call functions by their addresses. They need no library and allocate nothing, so they run natively, past Python, and
 * in a web page. Each function here is true where the FMU answered OK; else `failed` and `status` say which call it was, and what it answered.
 */
#ifndef FMI_H
#define FMI_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

enum { DONE, PAUSED, BROKEN };  /* what a loop answers: paused, it is to be called again */
enum { FMI_WARNING = 1, NOT_FINITE = -1 };  /* statuses, of FMI and one that it does not have */

typedef void Function(void);

typedef struct {  /* fmu/fmi.py has the same */
    void *instance;
    int version;  /* of FMI, 2 or 3 */
    int (*reset)(void *);
    Function *setup, *enter_initialization;  /* of FMI 2.0 two calls, of 3.0 only the second */
    int (*exit_initialization)(void *);
    Function *step, *set_real, *set_integer, *set_boolean, *get_real, *get_integer, *get_boolean;
    int (*enter_event_mode)(void *);  /* of an instance that has events; else NULL */
    int (*update)(void *, bool *, bool *, bool *, bool *, bool *, double *);
    int (*enter_step_mode)(void *);
    const char *failed;
    int status;
    int warned;  /* whether a call answered with a warning; the run continues */
} Fmi;

typedef int (*Setup2)(void *, int, double, double start, int, double);
typedef int (*Enter2)(void *);
typedef int (*Enter3)(void *, bool, double, double start, bool, double);
typedef int (*Step2)(void *, double time, double h, int);
typedef int (*Step3)(void *, double time, double h, bool, bool *event, bool *terminate, bool *early, double *last);
typedef int (*Transfer2)(void *, const unsigned *references, size_t count, void *values);
typedef int (*Transfer3)(void *, const unsigned *references, size_t count, void *values, size_t value_count);

static inline bool answered(Fmi *fmi, const char *function, int status) {
    if (status == FMI_WARNING) fmi->warned = 1;
    if (!status || status == FMI_WARNING) return true;
    fmi->failed = function;
    fmi->status = status;
    return false;
}

/* Set or get variables; arrays of FMI 3.0 have several values. */
static inline bool transfer(Fmi *fmi, const char *name, Function *function, const unsigned *references, size_t count, const void *values, size_t value_count) {
    void *place = (void *)(size_t)values;
    if (!count) return true;
    if (fmi->version == 2) return answered(fmi, name, ((Transfer2)function)(fmi->instance, references, count, place));
    return answered(fmi, name, ((Transfer3)function)(fmi->instance, references, count, place, value_count));
}

static inline bool set_reals(Fmi *fmi, const unsigned *references, size_t count, const double *values) {
    return transfer(fmi, "setting numbers", fmi->set_real, references, count, values, count);
}

static inline bool set_integer(Fmi *fmi, unsigned reference, int32_t value) {
    return transfer(fmi, "setting an integer", fmi->set_integer, &reference, 1, &value, 1);
}

static inline bool set_boolean(Fmi *fmi, unsigned reference, bool value) {
    int value2 = value;  /* FMI 2.0's Booleans are integers */
    return transfer(fmi, "setting a Boolean", fmi->set_boolean, &reference, 1, fmi->version == 2 ? (void *)&value2 : &value, 1);
}

static inline bool get_reals(Fmi *fmi, const unsigned *references, size_t count, double *values, size_t value_count) {
    if (!transfer(fmi, "reading numbers", fmi->get_real, references, count, values, value_count)) return false;
    for (size_t i = 0; i < value_count; i++) if (!__builtin_isfinite(values[i])) return answered(fmi, "reading numbers", NOT_FINITE);
    return true;
}

static inline bool get_integer(Fmi *fmi, unsigned reference, int32_t *value) {
    return transfer(fmi, "reading an integer", fmi->get_integer, &reference, 1, value, 1);
}

static inline bool get_boolean(Fmi *fmi, unsigned reference, bool *value) {
    int value2 = 0;
    if (!transfer(fmi, "reading a Boolean", fmi->get_boolean, &reference, 1, fmi->version == 2 ? (void *)&value2 : value, 1)) return false;
    if (fmi->version == 2) *value = value2 != 0;
    return true;
}

/* Take an instance with its start values set through initialisation at time 0, so that it can be stepped. */
static inline bool initialize(Fmi *fmi) {
    int status;
    if (fmi->version == 2) {
        if (!answered(fmi, "fmi2SetupExperiment", ((Setup2)fmi->setup)(fmi->instance, false, 0.0, 0.0, false, 0.0))) return false;
        status = ((Enter2)fmi->enter_initialization)(fmi->instance);
    } else status = ((Enter3)fmi->enter_initialization)(fmi->instance, false, 0.0, 0.0, false, 0.0);
    return answered(fmi, "EnterInitializationMode", status) && answered(fmi, "ExitInitializationMode", fmi->exit_initialization(fmi->instance))
        && (!fmi->enter_step_mode || answered(fmi, "fmi3EnterStepMode", fmi->enter_step_mode(fmi->instance)));
}

/* One step towards a target; an instance that has events may stop before it. */
static inline bool do_step(Fmi *fmi, double time, double target, bool *event, double *reached) {
    bool terminate, early;
    *event = false;
    *reached = target;
    if (fmi->version == 2) return answered(fmi, "fmi2DoStep", ((Step2)fmi->step)(fmi->instance, time, target - time, true));
    return answered(fmi, "fmi3DoStep", ((Step3)fmi->step)(fmi->instance, time, target - time, true, event, &terminate, &early, reached));
}

static inline bool handle_event(Fmi *fmi) {
    bool again, terminate, nominals, values, defined;
    double next;
    return answered(fmi, "fmi3EnterEventMode", fmi->enter_event_mode(fmi->instance))
        && answered(fmi, "fmi3UpdateDiscreteStates", fmi->update(fmi->instance, &again, &terminate, &nominals, &values, &defined, &next))
        && answered(fmi, "fmi3EnterStepMode", fmi->enter_step_mode(fmi->instance));
}

#endif
