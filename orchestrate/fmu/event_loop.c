/* The loop over the pieces of an input, the times at which a motion is read, and its impacts, compiled.
 *
 * event_loop.py says what is done and why; here are the same calls of the FMU in the same order, so the bits are the same. Its structures for ctypes are
 * those of this file. No library is needed, nothing is allocated: where a buffer is full, the loop pauses and is called again.
 */
#include <stdbool.h>
#include <stddef.h>

#include "token.h"

#ifdef _WIN32
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

EXPORT const char token[] = TOKEN;  /* of these sources: tells their library from others */

enum { FAILED = -1, DONE = 0, PAUSED = 1 };
enum { OUTPUTS_NOT_FINITE = -1, IMPACT_NOT_FINITE = -2 };  /* statuses that FMI does not have */

typedef struct {
    void *instance;
    int (*set)(void *, const unsigned *references, size_t count, const double *values, size_t value_count);
    int (*get)(void *, const unsigned *references, size_t count, double *values, size_t value_count);
    int (*get_boolean)(void *, const unsigned *references, size_t count, bool *values, size_t value_count);
    int (*step)(void *, double time, double h, bool, bool *event, bool *terminate, bool *early, double *last);
    int (*enter_event_mode)(void *);
    int (*update)(void *, bool *, bool *, bool *, bool *, bool *, double *);
    int (*enter_step_mode)(void *);
    const unsigned *inputs, *outputs, *impact_outputs, *contact;
    size_t input_count, output_count, impact_output_count;
    const char *failed;  /* the function that did not answer OK */
    int status;
} Calls;

typedef struct {  /* what there is to do; arrays by rows */
    const double *nodes, *derivatives, *samples;
    size_t piece_count, sample_count;
    double *rows;
    bool *contacts;
    double *impacts;  /* of each its time, the outputs after it, and whether contact begins */
    size_t impact_capacity, max_steps;
} Task;

typedef struct {  /* what is done, over all calls; of the impacts, in this one */
    double time;
    size_t piece, sample, impact;
    int piece_is_set;
} Progress;

EXPORT const unsigned sizes[] = {sizeof(Calls), sizeof(Task), sizeof(Progress)};  /* event_loop.py has to have the same */

static bool answered(Calls *calls, const char *function, int status) {
    if (!status) return true;
    calls->failed = function;
    calls->status = status;
    return false;
}

static bool get(Calls *calls, const unsigned *references, size_t count, double *values, int not_finite) {
    if (!count) return true;
    if (!answered(calls, "fmi3GetFloat64", calls->get(calls->instance, references, count, values, count))) return false;
    for (size_t i = 0; i < count; i++) if (!__builtin_isfinite(values[i])) return answered(calls, "fmi3GetFloat64", not_finite);
    return true;
}

static bool get_contact(Calls *calls, bool *contact) {
    return answered(calls, "fmi3GetBoolean", calls->get_boolean(calls->instance, calls->contact, 1, contact, 1));
}

static bool set(Calls *calls, const double *values) {
    size_t count = calls->input_count;
    return !count || answered(calls, "fmi3SetFloat64", calls->set(calls->instance, calls->inputs, count, values, count));
}

static bool handle_event(Calls *calls) {
    bool again, terminate, nominals, values, defined;
    double next;
    return answered(calls, "fmi3EnterEventMode", calls->enter_event_mode(calls->instance))
        && answered(calls, "fmi3UpdateDiscreteStates", calls->update(calls->instance, &again, &terminate, &nominals, &values, &defined, &next))
        && answered(calls, "fmi3EnterStepMode", calls->enter_step_mode(calls->instance));
}

static bool keep_impact(Calls *calls, const Task *task, Progress *progress) {
    size_t count = calls->impact_output_count;
    double *row = task->impacts + progress->impact * (count + 2);
    bool contact;
    row[0] = progress->time;
    if (!get(calls, calls->impact_outputs, count, row + 1, IMPACT_NOT_FINITE) || !get_contact(calls, &contact)) return false;
    row[count + 1] = contact;
    progress->impact++;
    return handle_event(calls);
}

static bool step(Calls *calls, const Task *task, Progress *progress, double target) {
    bool event, terminate, early;
    double time = progress->time;
    int status = calls->step(calls->instance, time, target - time, true, &event, &terminate, &early, &progress->time);
    return answered(calls, "fmi3DoStep", status) && (!event || keep_impact(calls, task, progress));
}

static bool read_sample(Calls *calls, const Task *task, Progress *progress) {
    size_t i = progress->sample++;
    double *row = task->rows + i * calls->output_count;
    return get(calls, calls->outputs, calls->output_count, row, OUTPUTS_NOT_FINITE) && get_contact(calls, task->contacts + i);
}

/* Go on with a task: DONE, PAUSED for the caller to take the impacts away, or FAILED. */
EXPORT int run(Calls *calls, const Task *task, Progress *progress) {
    size_t steps = 0;
    progress->impact = 0;
    for (; progress->piece < task->piece_count; progress->piece++, progress->piece_is_set = false) {
        double end = task->nodes[progress->piece + 1];
        if (!progress->piece_is_set && !set(calls, task->derivatives + progress->piece * calls->input_count)) return FAILED;
        progress->piece_is_set = true;
        for (bool reads = true; reads;) {
            reads = progress->sample < task->sample_count && task->samples[progress->sample] < end;
            double target = reads ? task->samples[progress->sample] : end;
            while (progress->time < target) {
                if (steps++ == task->max_steps || progress->impact == task->impact_capacity) return PAUSED;
                if (!step(calls, task, progress, target)) return FAILED;
            }
            if (reads && !read_sample(calls, task, progress)) return FAILED;
        }
    }
    while (progress->sample < task->sample_count) if (!read_sample(calls, task, progress)) return FAILED;  /* at the last node */
    return DONE;
}
