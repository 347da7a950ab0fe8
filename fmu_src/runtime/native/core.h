/* One instance of a model in C: the kernel's flat memory, a life cycle, and a logger. Generic over model.h, the generated variable table.
 *
 * No global mutable state: instances in different threads do not meet. Every message is text, never a format.
 */
#ifndef CORE_H
#define CORE_H

#include <math.h>
#include <stdbool.h>
#include <stddef.h>

#include "names.h"

#if defined(FMI_STATUS)  /* the file has FMI's functions, which are passed more than this FMU needs */
#if defined(__GNUC__)
#pragma GCC diagnostic ignored "-Wunused-parameter"
#elif defined(_MSC_VER)
#pragma warning(disable : 4100)
#endif

/* A function that passes on to this file, which gets its name as `call`. */
#define PASS_ON(NAME, PARAMETERS, EXPRESSION) \
    FMI_STATUS NAME PARAMETERS { static const char *const call = #NAME; return c ? (FMI_STATUS)(EXPRESSION) : (FMI_STATUS)FAILED; }
#endif

#if defined(__GNUC__) && !defined(_WIN32)
/* names of this library only, whatever options compile it: the C library, too, has a function step */
#pragma GCC visibility push(hidden)
#endif

#include "model.h"

/* The compiled kernel. */
int kernel_initialize(double *memory, double time);
int kernel_advance(double *memory, double time);
int kernel_refresh(double *memory, double time);  /* where REFRESH is 1 */
int kernel_coast(double *memory, double time);  /* where COAST is 1: 0 where the step is done, else nothing is */
int kernel_restore(double *memory, double start_time);  /* what the parameters decide, in a memory that came from outside */
int kernel_differentiate(double *memory, double time);  /* rates of the continuous outputs into their slots */

typedef enum { OK, WARNING, DISCARD, FAILED, FATAL } Status;  /* numbered as in FMI 2.0 and 3.0 */
typedef enum { INSTANTIATED = 1, INITIALIZING = 2, STEPPING = 4, EVENT = 8, STOPPED = 16, TERMINATED = 32 } Phase;
#define ANY_PHASE (INSTANTIATED | INITIALIZING | STEPPING | EVENT | STOPPED | TERMINATED)
#define TEXT 1024  /* longest message */

typedef struct Instance Instance;
typedef void (*Report)(Instance *, Status, const char *text);
#define CATEGORY(status) ((status) == WARNING ? "logStatusWarning" : "logStatusError")

typedef struct {  /* what saving an instance has to keep */
    double zero;  /* always 0.0: importers exist that free a state by a pointer to it, not to its handle (fmusim 0.0.39); then NULL is what is freed */
    double memory[MEMORY_SIZE];
    double start_time;
    int phase;
    bool stale;  /* outputs do not belong yet to the values set: in initialisation mode; where REFRESH is 1, later too */
    bool clock;  /* the event clock ticks now */
    bool has_series;  /* a step may have filled the series since the reset; else they are zeros, and need no copying */
} State;

struct Instance {
    State state;
    double stop_time;  /* of the experiment, not of the state: a saved state may go on in a longer one */
    Report report;
    void *environment;
    void *logger;
    bool event_mode, early_return;
    bool warned;  /* of a step too short to advance the time */
    char *name;
};

/* `call` and `token_name` are for the message where the token is not MODEL_TOKEN. */
bool has_right_bits(double *memory);  /* of an instance that has been reset, and is to be reset after it */
Instance *instance_new(const char *call, const char *name, const char *token_name, const char *token, Report report, void *environment, void *logger);
void instance_free(Instance *);
void instance_reset(Instance *);

/* Fail with a message, which is no format; without an instance, here and below, without one. */
Status refuse(Instance *, const char *call, const char *reason);
bool require_phase(Instance *, const char *call, int phases);
Status change_phase(Instance *, const char *call, int from, Phase to);
bool refuse_missing_array(Instance *, const char *call, size_t count, const void *a, const void *b);  /* an array that is not empty */

/* Whether all categories are those of modelDescription.xml. */
Status require_known_categories(Instance *, const char *call, size_t count, const char *const categories[]);

/* `stop_time` is INFINITY where none is defined. */
Status set_experiment(Instance *, const char *call, double start_time, double stop_time);
Status exit_initialization(Instance *, const char *call);
Status step_to_point(Instance *, const char *call, double current, double size);

extern const char *const TYPE_NAMES[];  /* of FMI's version, in the order of Type */

/* Find the variable of a reference, of a type; NULL after a refusal. */
const Variable *find_variable(Instance *, const char *call, unsigned reference, Type type);
Status require_settable(Instance *, const char *call, const Variable *, double value);

/* Set a variable that may be set: a polynomial input begins here. */
void set_value(Instance *, unsigned reference, double value);
Status bring_up_to_date(Instance *);

Status require_readable(Instance *, const char *call, const Variable *);

/* Whether a variable has a derivative of this order: continuous outputs have the first. */
bool require_rate(Instance *, const char *call, const Variable *, int order);

/* A copy of the memory with all rates of change in their slots: reading them changes no state. */
void copy_with_rates(const Instance *, double memory[MEMORY_SIZE]);

#define STATE_BYTES (STATE_HEADER + sizeof(double) * (MEMORY_SIZE + 3) + 8)  /* header, head, memory, checksum */
#define STATE_HEADER 64

/* An instance's state, kept at a handle, and as bytes, of which the checksum and what indexes, counts or bounds a loop are checked. */
Status save_state(Instance *, const char *call, void **to);
Status restore_state(Instance *, const char *call, const void *from);
void free_state(void **state);
Status state_size(Instance *, const char *call, const void *state, size_t *size);
Status serialize_state(Instance *, const char *call, const void *state, void *bytes, size_t size);
Status deserialize_state(Instance *, const char *call, const void *bytes, size_t size, void **to);

#if defined(__GNUC__) && !defined(_WIN32)
#pragma GCC visibility pop
#endif

#endif
