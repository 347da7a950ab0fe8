/* Life cycle, checks and messages of an instance; see core.h. */
#define DEFINE_VARIABLES
#include "core.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>


/* The shortest decimal that reads back as the same number. */
static void write_number(char *text, double value) {
    if (isnan(value)) { strcpy(text, "nan"); return; }
    if (isinf(value)) { strcpy(text, value > 0 ? "inf" : "-inf"); return; }
    for (int digits = 15; digits <= 17; digits++) {
        snprintf(text, 32, "%.*g", digits, value);
        if (strtod(text, NULL) == value) break;
    }
    if (!strpbrk(text, ".,en")) strcat(text, ".0");
}

static void append(char *text, const char *part) {
    strncat(text, part, TEXT - strlen(text) - 1);
}

static void append_number(char *text, double value) {
    char digits[40];
    write_number(digits, value);
    append(text, digits);
}

/* The whole number next to a value. */
static void append_whole_number(char *text, double value) {
    char digits[320];  /* the largest double has 309 */
    if (!isfinite(value)) { append_number(text, value); return; }
    snprintf(digits, sizeof digits, "%.0f", value);
    append(text, digits);
}

/* Whether a number is one of FMI's integers, of 32 bits; without the mathematical library. */
static bool is_whole(double value) {
    return fabs(value) < 2147483648.0 && (double)(int32_t)value == value;
}

/* A value as people write it: Integers without a fraction, Booleans as words. */
static void append_value(char *text, const Variable *variable, double value) {
    if (variable->type == BOOLEAN && (value == 0 || value == 1)) append(text, value != 0 ? "true" : "false");
    else if (variable->type == INTEGER && is_whole(value)) append_whole_number(text, value);
    else append_number(text, value);
}

/* Report of a call what has %g for the next of the numbers, %v for that as the variable's value, %s for the next of the texts. */
static Status report_values(Instance *instance, Status status, const char *call, const char *format, const Variable *variable, const double *numbers,
                            const char *const *texts) {
    char text[TEXT] = "";
    append(text, call);
    append(text, ": ");
    for (; *format; format++) {
        char piece[2] = {*format, 0};
        if (*format != '%') append(text, piece);
        else if (*++format == 'g') append_number(text, *numbers++);
        else if (*format == 'v') append_value(text, variable, *numbers++);
        else append(text, *texts++);
    }
    instance->report(instance, status, text);
    return status;
}
#define refuse_with_values(instance, ...) report_values(instance, FAILED, __VA_ARGS__)
#define NUMBERS(...) (const double[]){__VA_ARGS__}
#define TEXTS(...) (const char *const[]){__VA_ARGS__}

Status refuse(Instance *instance, const char *call, const char *reason) {
    return instance ? refuse_with_values(instance, call, "%s", NULL, NULL, &reason) : FAILED;
}

bool require_phase(Instance *instance, const char *call, int phases) {
    static const char *const names[] = {"instantiated", "initialization mode", "step mode", "event mode", "stopped after an error", "terminated"};
    enum { PHASES = sizeof names / sizeof *names };
    if (!instance) return false;
    if (instance->state.phase & phases) return true;
    const char *texts[1 + 2 * PHASES] = {""}, **next = texts + 1, *separator = "";
    for (int i = 0; i < PHASES; i++) {
        bool allowed = phases & 1 << i;
        if (instance->state.phase == 1 << i) texts[0] = names[i];
        *next++ = allowed ? separator : "";
        *next++ = allowed ? names[i] : "";
        if (allowed) separator = ", ";
    }
    refuse_with_values(instance, call, "called when %s: expected when %s%s%s%s%s%s%s%s%s%s%s%s", NULL, NULL, texts);
    return false;
}

Status change_phase(Instance *instance, const char *call, int from, Phase to) {
    if (!require_phase(instance, call, from)) return FAILED;
    instance->state.phase = to;
    return OK;
}

bool refuse_missing_array(Instance *instance, const char *call, size_t count, const void *a, const void *b) {
    if (count == 0 || (a && b)) return false;
    refuse(instance, call, "a null pointer for an array that is not empty");
    return true;
}

static char *copy_text(const char *text) {
    size_t size = strlen(text) + 1;
    char *made = malloc(size);
    if (made) memcpy(made, text, size);
    return made;
}

Status require_known_categories(Instance *instance, const char *call, size_t count, const char *const categories[]) {
    if (refuse_missing_array(instance, call, count, categories, categories)) return FAILED;
    for (size_t i = 0; i < count; i++) {
        bool known = false;
        for (unsigned k = 0; categories[i] && k < CATEGORY_COUNT; k++) known = known || strcmp(categories[i], CATEGORIES[k]) == 0;
        if (!known) return refuse_with_values(instance, call, "log category %s: expected " CATEGORY_NAMES, NULL, NULL, TEXTS(categories[i] ? categories[i] : "NULL"));
    }
    return OK;
}

Instance *instance_new(const char *call, const char *name, const char *token_name, const char *token, Report report, void *environment, void *logger) {
    Instance *instance = calloc(1, sizeof *instance);
    if (!instance) return NULL;
    instance->report = report;
    instance->environment = environment;
    instance->logger = logger;
    instance->name = copy_text(name ? name : "");
    if (!instance->name) { free(instance); return NULL; }
    if (!token || strcmp(token, MODEL_TOKEN) != 0) {
        refuse_with_values(instance, call, "%s: expected that of this FMU, " MODEL_TOKEN ", not %s", NULL, NULL, TEXTS(token_name, token ? token : "a null pointer"));
        instance_free(instance);
        return NULL;
    }
    instance_reset(instance);
    if (!has_right_bits(instance->state.memory)) {
        refuse(instance, call, "this library's numbers differ from the model's in their last digits: compile it with -ffp-contract=off and without -ffast-math");
        instance_free(instance);
        return NULL;
    }
    instance_reset(instance);
    return instance;
}

void instance_free(Instance *instance) {
    if (!instance) return;
    free(instance->name);
    free(instance);
}

void instance_reset(Instance *instance) {
    State *state = &instance->state;
    memset(state, 0, sizeof *state);
    for (unsigned i = 0; i < VARIABLE_COUNT; i++) if (!VARIABLES[i].calculated) state->memory[i] = VARIABLES[i].start;
    state->phase = INSTANTIATED;
    state->stale = true;
    instance->stop_time = INFINITY;
    instance->warned = false;
}

/* A kernel's message with its slots filled in: {12}, {12:0} as a whole number, or {12:one|two}. */
static void format_message(char *text, const double *memory, int code) {
    const char *from = code > 0 && code < MESSAGE_COUNT && MESSAGES[code] ? MESSAGES[code] : "failed inside";
    text[0] = 0;
    while (*from) {
        char piece[2] = {*from, 0};
        if (*from != '{') { append(text, piece); from++; continue; }
        char *rest;
        unsigned slot = (unsigned)strtol(from + 1, &rest, 10);
        double value = memory[slot];
        if (strncmp(rest, ":0}", 3) == 0) {
            append_whole_number(text, value);
            from = rest + 3;
        } else if (*rest == ':') {
            const char *word = rest + 1;
            for (double skip = value; skip > 0.5 && strchr(word, '|'); skip--) word = strchr(word, '|') + 1;
            while (*word != '|' && *word != '}') { piece[0] = *word++; append(text, piece); }
            while (*word != '}') word++;
            from = word + 1;
        } else {
            if (slot < VARIABLE_COUNT) append_value(text, &VARIABLES[slot], value);
            else append_number(text, value);
            from = rest + 1;
        }
    }
}

/* What a kernel's answer is for the call: with code 0 the outputs belong to the values set. */
static Status check_kernel_code(Instance *instance, const char *call, int code) {
    instance->state.stale = code != 0;
    if (!code) return OK;
    char text[TEXT];
    format_message(text, instance->state.memory, code);
    return refuse(instance, call, text);
}

static Status initialize_if_stale(Instance *instance, const char *call) {
    State *state = &instance->state;
    return state->stale ? check_kernel_code(instance, call, kernel_initialize(state->memory, state->start_time)) : OK;
}

Status bring_up_to_date(Instance *instance) {
    State *state = &instance->state;
    if (state->phase == INITIALIZING) return initialize_if_stale(instance, "get");
#if REFRESH
    if (state->stale && state->phase & (STEPPING | EVENT)) return check_kernel_code(instance, "get", kernel_refresh(state->memory, state->memory[TIME_SLOT]));
#endif
    return OK;
}

Status set_experiment(Instance *instance, const char *call, double start_time, double stop_time) {
    if (!require_phase(instance, call, INSTANTIATED)) return FAILED;
    if (!isfinite(start_time)) return refuse_with_values(instance, call, "startTime = %g s: expected every finite number", NULL, &start_time, NULL);
    if (!(stop_time >= start_time))
        return refuse_with_values(instance, call, "startTime = %g s with stopTime = %g s: expected stopTime >= startTime", NULL, NUMBERS(start_time, stop_time), NULL);
    instance->state.start_time = start_time;
    instance->stop_time = stop_time;
    return OK;
}

Status exit_initialization(Instance *instance, const char *call) {
    if (!require_phase(instance, call, INITIALIZING)) return FAILED;
    Status status = initialize_if_stale(instance, call);
    if (status == OK) instance->state.phase = instance->event_mode ? EVENT : STEPPING;
    return status;
}

/* Why a step cannot be tried. */
static Status refuse_step(Instance *instance, const char *call, double current, double size) {
    double reached = instance->state.memory[TIME_SLOT];
    if (!(size >= 0) || isinf(size)) return refuse_with_values(instance, call, "communicationStepSize = %g s: expected every finite number >= 0", NULL, &size, NULL);
    if (!(fabs(current - reached) <= 1e-9 * (fabs(reached) + size)))
        return refuse_with_values(instance, call, "currentCommunicationPoint = %g s: expected %g s, where the last step ended", NULL, NUMBERS(current, reached), NULL);
    if (isinf(current + size)) return refuse_with_values(instance, call, "communicationStepSize = %g s: expected a step that ends at a finite time", NULL, &size, NULL);
    const double *ends = NUMBERS(current + size, instance->stop_time);
    return refuse_with_values(instance, call, "the step to time = %g s: expected none past stopTime = %g s", NULL, ends, NULL);
}

/* Report once that a step is so short that the time stays the same; it is done all the same. */
static Status warn_short_step(Instance *instance, const char *call, double current, double size) {
    instance->warned = true;
    return report_values(instance, WARNING, call, "communicationStepSize = %g s: too short to change the time, %g s, expected a longer one; reported once",
                         NULL, NUMBERS(size, current), NULL);
}

/* Advance with a copy of the state to go back to: a step that reaches its limit of evaluations is discarded, and a shorter one may follow. */
static Status advance_or_go_back(Instance *instance, const char *call, double target) {
    double *memory = instance->state.memory, reached = memory[TIME_SLOT];
    double before[MEMORY_SIZE - SKIP_COUNT];  /* what the step only writes need not be put back */
    size_t head = SKIP_FIRST * sizeof(double), tail = sizeof before - head;
    memcpy(before, memory, head);
    memcpy(before + SKIP_FIRST, memory + SKIP_FIRST + SKIP_COUNT, tail);
    memory[STOP_SLOT] = instance->early_return;
    if (FILLS_SERIES(memory)) instance->state.has_series = true;
    int code = kernel_advance(memory, target);
    if (!code) {  /* the time of an impact just after the communication point may round to one before it */
        if (memory[TIME_SLOT] < reached) memory[TIME_SLOT] = reached;
        return OK;
    }
    char text[TEXT];
    format_message(text, memory, code);
    memcpy(memory, before, head);
    memcpy(memory + SKIP_FIRST + SKIP_COUNT, before + SKIP_FIRST, tail);
    return report_values(instance, code == LIMITED_CODE ? DISCARD : FAILED, call, "%s", NULL, NULL, TEXTS(text));
}

Status step_to_point(Instance *instance, const char *call, double current, double size) {
    if (!require_phase(instance, call, STEPPING)) return FAILED;
    double *memory = instance->state.memory, reached = memory[TIME_SLOT], target = current + size;
    double rounding = 1e-9 * (fabs(reached) + size);  /* of the importer's own sum of steps: no step past the end */
    if (!(size >= 0 && target < INFINITY && fabs(current - reached) <= rounding) || target - instance->stop_time > rounding)
        return refuse_step(instance, call, current, size);
    if (target < reached) target = reached;  /* the importer's clock may be a rounding behind */
    bool short_step = size > 0 && current + size == current && !instance->warned;
    Status warning = short_step ? warn_short_step(instance, call, current, size) : OK;
#if COAST
    if (!kernel_coast(memory, target)) return warning;
#endif
    Status status = advance_or_go_back(instance, call, target);
    return status == OK ? warning : status;
}

Status require_readable(Instance *instance, const char *call, const Variable *variable) {
    if (!variable->calculated || instance->state.phase != INSTANTIATED) return OK;
    return refuse_with_values(instance, call, "%s is calculated: expected when initialization mode has been entered", NULL, NULL, &variable->name);
}

bool require_rate(Instance *instance, const char *call, const Variable *variable, int order) {
    if (order == 1 && variable->rate >= 0) return true;
    refuse_with_values(instance, call, "%s: expected order 1 of a continuous output", NULL, NULL, &variable->name);
    return false;
}

void copy_with_rates(const Instance *instance, double memory[MEMORY_SIZE]) {
    memcpy(memory, instance->state.memory, sizeof instance->state.memory);
    kernel_differentiate(memory, memory[TIME_SLOT]);
}

const Variable *find_variable(Instance *instance, const char *call, unsigned reference, Type type) {
    const Variable *variable = reference < VARIABLE_COUNT ? &VARIABLES[reference] : NULL;
    bool real = variable && REAL_OUTPUTS && variable->calculated;  /* so described; by its own type it can be read all the same */
    if (variable && (variable->type == type || (real && type == REAL))) return variable;
    char number[16];
    snprintf(number, sizeof number, "%u", reference);
    if (variable)
        refuse_with_values(instance, call, "valueReference = %s: %s is one of the %s variables, expected one of the %s variables in modelDescription.xml", NULL, NULL,
                           TEXTS(number, variable->name, TYPE_NAMES[real ? REAL : variable->type], TYPE_NAMES[type]));
    else refuse_with_values(instance, call, "valueReference = %s: expected one of the %s variables in modelDescription.xml", NULL, NULL, TEXTS(number, TYPE_NAMES[type]));
    return NULL;
}

static bool in_range(const Variable *variable, double value) {
    return variable->type == BOOLEAN || (isfinite(value) && value >= variable->minimum && value <= variable->maximum);
}

Status require_settable(Instance *instance, const char *call, const Variable *variable, double value) {
    const char *reason = NULL;
    if (variable->calculated) reason = ": an output cannot be set, expected a parameter or an input";
    else if (variable->fixed && !(instance->state.phase & (INSTANTIATED | INITIALIZING)))
        reason = ": a fixed parameter, to be set before the end of initialisation";
    else if (in_range(variable, value)) return OK;
    if (reason) return refuse_with_values(instance, call, "%s = %v%s", variable, &value, TEXTS(variable->name, reason));
    bool has_unit = variable->unit[0] && strcmp(variable->unit, "1") != 0;
    const char *const *texts = TEXTS(variable->name, has_unit ? " " : "", has_unit ? variable->unit : "", variable->range);
    return refuse_with_values(instance, call, "%s = %v%s%s: expected %s", variable, &value, texts);
}

void set_value(Instance *instance, unsigned reference, double value) {
    State *state = &instance->state;
    state->memory[reference] = value;
    if (VARIABLES[reference].set_flag) state->memory[VARIABLES[reference].set_flag] = 1.0;
    state->stale = true;
}

/* FNV-1a: a state damaged on its way is refused. */
static uint64_t checksum(const char *bytes) {
    uint64_t hash = 0xcbf29ce484222325u;
    for (size_t i = 0; i < STATE_BYTES - sizeof hash; i++) hash = (hash ^ (unsigned char)bytes[i]) * 0x100000001b3u;
    return hash;
}

static void state_to_bytes(const State *state, char *bytes) {
    double head[3] = {state->phase, state->start_time, state->stale + 2 * state->clock};
    memset(bytes, 0, STATE_HEADER);
    strcpy(bytes, STATE_MAGIC);
    memcpy(bytes + STATE_HEADER, head, sizeof head);
    memcpy(bytes + STATE_HEADER + sizeof head, state->memory, sizeof state->memory);
    uint64_t hash = checksum(bytes);
    memcpy(bytes + STATE_BYTES - sizeof hash, &hash, sizeof hash);
}

/* Undamaged bytes of this model's state, without a look at its numbers. */
static bool unpack_state(State *state, const char *bytes, size_t size) {
    char header[STATE_HEADER] = STATE_MAGIC;
    double head[3];
    uint64_t hash;
    if (size != STATE_BYTES || memcmp(bytes, header, STATE_HEADER) != 0) return false;
    memcpy(&hash, bytes + STATE_BYTES - sizeof hash, sizeof hash);
    if (hash != checksum(bytes)) return false;
    memset(state, 0, sizeof *state);
    memcpy(head, bytes + STATE_HEADER, sizeof head);
    memcpy(state->memory, bytes + STATE_HEADER + sizeof head, sizeof state->memory);
    for (int phase = 1; phase <= TERMINATED; phase *= 2) if (head[0] == phase) state->phase = phase;
    if (!state->phase || !isfinite(head[1]) || !(head[2] == 0 || head[2] == 1 || head[2] == 2 || head[2] == 3)) return false;
    state->start_time = head[1];
    state->stale = head[2] == 1 || head[2] == 3;
    state->clock = head[2] >= 2;
    state->has_series = true;
    return true;
}

/* Whether a variable may have a value at all, whoever set or calculated it. */
static bool is_value(const Variable *variable, double value) {
    if (variable->type == BOOLEAN) return value == 0 || value == 1;
    return in_range(variable, value) && (variable->type == REAL || is_whole(value));
}

/* Whether a slot behind the variables may have a value: its range, else every finite number. */
static bool is_hidden_value(unsigned slot, double value) {
    for (const SlotRange *row = RANGES; row < RANGES + RANGE_COUNT; row++)
        if (slot >= row->first && slot - row->first < row->size)
            return row->lowest > row->highest || (value >= row->lowest && value <= row->highest);
    return isfinite(value);
}

#define NEVER "a saved state that this FMU never had: "

static Status check_restored_state(Instance *instance, const char *call, State *state) {
    for (unsigned i = 0; i < VARIABLE_COUNT; i++) {
        const Variable *variable = &VARIABLES[i];
        if (!is_value(variable, state->memory[i]))
            return refuse_with_values(instance, call, NEVER "%s = %v: expected %s", variable, &state->memory[i], TEXTS(variable->name, variable->range));
    }
    if (state->phase & (INSTANTIATED | INITIALIZING)) {  /* nothing is calculated yet, or it is once more */
        for (unsigned i = 0; i < MEMORY_SIZE; i++) if (i >= VARIABLE_COUNT || VARIABLES[i].calculated) state->memory[i] = 0;
        state->stale = state->stale || state->phase == INSTANTIATED || kernel_initialize(state->memory, state->start_time);
        return OK;
    }
    for (unsigned i = VARIABLE_COUNT; i < MEMORY_SIZE; i++) {
        if (is_hidden_value(i, state->memory[i])) continue;
        char slot[16];
        snprintf(slot, sizeof slot, "%u", i);
        return refuse_with_values(instance, call, NEVER "%g in slot %s", NULL, &state->memory[i], TEXTS(slot));
    }
    int code = kernel_restore(state->memory, state->start_time);
    if (!code) return OK;
    char problem[TEXT];
    format_message(problem, state->memory, code);
    return refuse_with_values(instance, call, NEVER "%s", NULL, NULL, TEXTS(problem));
}

/* Most of a state are series that a master never asks for. */
static void copy_state(State *to, const State *from) {
    size_t head = offsetof(State, memory) + SKIP_FIRST * sizeof(double), tail = head + SKIP_COUNT * sizeof(double);
    bool whole = from->has_series || to->has_series;
    memcpy(to, from, whole ? tail : head);
    memcpy((char *)to + tail, (const char *)from + tail, sizeof *to - tail);
}

static Status keep_state_at_handle(Instance *instance, const char *call, void **to, const State *state) {
    if (!*to) *to = calloc(1, sizeof(State));
    if (!*to) return refuse(instance, call, "out of memory");
    copy_state(*to, state);
    return OK;
}

Status save_state(Instance *instance, const char *call, void **to) {
    return to ? keep_state_at_handle(instance, call, to, &instance->state) : refuse(instance, call, "a null pointer");
}

Status restore_state(Instance *instance, const char *call, const void *from) {
    if (!from) return refuse(instance, call, "a null pointer");
    copy_state(&instance->state, from);
    if (!instance->event_mode) {  /* saved by an instance that has event mode: here the event is done with */
        if (instance->state.phase == EVENT) instance->state.phase = STEPPING;
        instance->state.clock = false;
    }
    return OK;
}

void free_state(void **state) {
    if (!state) return;
    free(*state);
    *state = NULL;
}

Status state_size(Instance *instance, const char *call, const void *state, size_t *size) {
    if (!state || !size) return refuse(instance, call, "a null pointer");
    *size = STATE_BYTES;
    return OK;
}

Status serialize_state(Instance *instance, const char *call, const void *state, void *bytes, size_t size) {
    if (!state || !bytes) return refuse(instance, call, "a null pointer");
    if (size < STATE_BYTES) return refuse(instance, call, "size: expected at least the serialized state's size");
    state_to_bytes(state, bytes);
    return OK;
}

Status deserialize_state(Instance *instance, const char *call, const void *bytes, size_t size, void **to) {
    if (!bytes || !to) return refuse(instance, call, "a null pointer");
    State state;
    if (!unpack_state(&state, bytes, size)) return refuse(instance, call, "expected a state saved by this FMU (" STATE_MAGIC "), and undamaged");
    Status status = check_restored_state(instance, call, &state);
    return status == OK ? keep_state_at_handle(instance, call, to, &state) : status;
}
