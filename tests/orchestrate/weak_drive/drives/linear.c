/* A linear drive of somebody else as an FMU: x' = A x + B u, acceleration C x + D u, exact for inputs
 * that are held over a step. References: parameters from 0, u from 30, what it does from the time AT on and
 * whether it has states at 32, outputs from 40. FMI 3.0, or 2.0 with -DFMI=2. */
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#ifndef FMI
#define FMI 3
#endif
#define AT 0.1

enum { N = 4, OK = 0, WARNING = 1, DISCARD = 2, ERROR = 3 };
enum { NOTHING, WARNS, WARNS_SILENTLY, DISCARDS, DISCARDS_SILENTLY, ENDS, ENDS_AFTER, RETURNS_EARLY, FAILS, DISCARDS_LONG };

typedef void Log3(void *environment, int status, const char *category, const char *message);
typedef void Log2(void *environment, const char *name, int status, const char *category, const char *message, ...);

typedef struct {
    double a[N][N], b[N][2], c[N], d[2];  /* the parameters, in this order */
    double u[2], does, has_states, x[N];
    double last;  /* of the last step, for FMI 2.0 */
    int ended;
    void *environment, (*log)(void);
} Drive;

static void say(Drive *m, int status, const char *message) {
    if (FMI == 3) ((Log3 *)m->log)(m->environment, status, "all", message);
    else ((Log2 *)m->log)(m->environment, "drive", status, "all", message);
}

static double *place(Drive *m, unsigned reference, double *value) {
    if (reference < 30) return &m->a[0][0] + reference;
    if (reference < 34) return m->u + reference - 30;
    if (reference == 40) {
        *value = m->d[0] * m->u[0] + m->d[1] * m->u[1];
        for (int i = 0; i < N; i++) *value += m->c[i] * m->x[i];
        return value;
    }
    return reference < 43 ? m->x + reference - 41 : NULL;
}

static int clear(Drive *m) { memset(m, 0, offsetof(Drive, environment)); return OK; }

static int set(void *m, const unsigned *references, size_t n, const double *values) {
    double none;
    for (size_t i = 0; i < n; i++) {
        double *at = references[i] < 34 ? place(m, references[i], &none) : NULL;
        if (!at) return ERROR;
        *at = values[i];
    }
    return OK;
}

static int get(void *m, const unsigned *references, size_t n, double *values) {
    double value;
    for (size_t i = 0; i < n; i++) {
        double *at = place(m, references[i], &value);
        if (!at) return ERROR;
        values[i] = *at;
    }
    return OK;
}

static void integrate(Drive *m, double h) {
    double size = 0.0;
    for (int i = 0; i < N; i++) for (int k = 0; k < N; k++) size += fabs(m->a[i][k]);
    int parts = 1 + (int)(size * h);
    double part = h / parts;
    for (int p = 0; p < parts; p++) {  /* a power series of each part */
        double term[N], next[N];
        for (int i = 0; i < N; i++) term[i] = m->x[i];
        for (int order = 1; order < 25; order++) {
            for (int i = 0; i < N; i++) {
                next[i] = order == 1 ? m->b[i][0] * m->u[0] + m->b[i][1] * m->u[1] : 0.0;
                for (int k = 0; k < N; k++) next[i] += m->a[i][k] * term[k];
            }
            for (int i = 0; i < N; i++) m->x[i] += term[i] = next[i] * part / order;
        }
    }
}

/* A step; what it does otherwise, it does in those that end after AT. */
static int advance(Drive *m, double time, double h, bool *end, bool *early, double *last) {
    int kind = (int)m->does, does = time + h > AT * (1.0 + 1e-9) ? kind : NOTHING;
    *end = *early = false, *last = time;
    if (does == FAILS) return say(m, ERROR, "fuse blown"), ERROR;
    if (kind == DISCARDS_LONG) does = h > 3e-3 ? DISCARDS : NOTHING;  /* from the start on */
    if (does == DISCARDS) say(m, DISCARD, "coil too hot");
    if (does == DISCARDS || does == DISCARDS_SILENTLY) return DISCARD;
    *end = does == ENDS || (kind == ENDS_AFTER && time + h > AT * (1.0 - 1e-9));
    if (*end) say(m, OK, "the emergency stop was pressed");
    if (does == ENDS) return OK;
    *early = does == RETURNS_EARLY;
    if (*early) h *= 0.5;
    integrate(m, h);
    *last = time + h;
    if (does == WARNS) say(m, WARNING, "coil is warm");
    return does == WARNS || does == WARNS_SILENTLY ? WARNING : OK;
}

#define STATES(prefix, State, Serialized, Serialize, Deserialize) \
    int prefix##Get##State(void *m, void **state) { \
        if (!*state) *state = malloc(sizeof(Drive)); \
        memcpy(*state, m, sizeof(Drive)); \
        return OK; \
    } \
    int prefix##Set##State(void *m, void *state) { memcpy(m, state, offsetof(Drive, environment)); return OK; } \
    int prefix##Free##State(void *m, void **state) { \
        if (!((Drive *)m)->has_states) return say(m, ERROR, "no states"), ERROR; \
        free(*state), *state = NULL; \
        return OK; \
    } \
    int prefix##Serialized(void *m, void *state, size_t *size) { *size = sizeof(Drive); return OK; } \
    int prefix##Serialize(void *m, void *state, unsigned char *bytes, size_t size) { memcpy(bytes, state, size); return OK; } \
    int prefix##Deserialize(void *m, const unsigned char *bytes, size_t size, void **state) { \
        if (!*state) *state = malloc(sizeof(Drive)); \
        memcpy(*state, bytes, size); \
        return OK; \
    }

#if FMI == 3
const char *fmi3GetVersion(void) { return "3.0"; }
int fmi3SetDebugLogging(void *m, bool on, size_t n, const char *const *names) { return OK; }
void *fmi3InstantiateCoSimulation(const char *name, const char *token, const char *path, bool visible, bool logging,
                                  bool events, bool early, const unsigned *needed, size_t n, void *environment,
                                  void (*log)(void), void *update) {
    Drive *m = calloc(1, sizeof(Drive));
    m->environment = environment, m->log = log;
    return m;
}
void fmi3FreeInstance(void *m) { free(m); }
int fmi3EnterInitializationMode(void *m, bool has_tolerance, double tolerance, double start, bool has_stop, double stop) { return OK; }
int fmi3ExitInitializationMode(void *m) { return OK; }
int fmi3Terminate(void *m) { return OK; }
int fmi3Reset(void *m) { return clear(m); }

int fmi3SetFloat64(void *m, const unsigned *references, size_t n, const double *values, size_t count) {
    return set(m, references, n, values);
}
int fmi3GetFloat64(void *m, const unsigned *references, size_t n, double *values, size_t count) {
    return get(m, references, n, values);
}
int fmi3DoStep(void *m, double time, double h, bool later, bool *event, bool *end, bool *early, double *last) {
    *event = false;
    return advance(m, time, h, end, early, last);
}

STATES(fmi3, FMUState, SerializedFMUStateSize, SerializeFMUState, DeserializeFMUState)
#else
typedef struct { Log2 *log; void *allocate, *release, *finished, *environment; } Callbacks;

const char *fmi2GetTypesPlatform(void) { return "default"; }
const char *fmi2GetVersion(void) { return "2.0"; }
int fmi2SetDebugLogging(void *m, int on, size_t n, const char *const *names) { return OK; }
void *fmi2Instantiate(const char *name, int type, const char *token, const char *path, const Callbacks *callbacks, int visible, int logging) {
    Drive *m = calloc(1, sizeof(Drive));
    m->environment = callbacks->environment, m->log = (void (*)(void))callbacks->log;
    return m;
}
void fmi2FreeInstance(void *m) { free(m); }
int fmi2SetupExperiment(void *m, int has_tolerance, double tolerance, double start, int has_stop, double stop) { return OK; }
int fmi2EnterInitializationMode(void *m) { return OK; }
int fmi2ExitInitializationMode(void *m) { return OK; }
int fmi2Terminate(void *m) { return OK; }
int fmi2Reset(void *m) { return clear(m); }
int fmi2SetReal(void *m, const unsigned *references, size_t n, const double *values) { return set(m, references, n, values); }
int fmi2GetReal(void *m, const unsigned *references, size_t n, double *values) { return get(m, references, n, values); }
int fmi2DoStep(void *instance, double time, double h, int later) {
    Drive *m = instance;
    bool end, early;
    int status = advance(m, time, h, &end, &early, &m->last);
    m->ended = end;
    return end || early ? DISCARD : status;
}
int fmi2GetRealStatus(void *m, int kind, double *value) { *value = ((Drive *)m)->last; return kind == 2 ? OK : ERROR; }
int fmi2GetBooleanStatus(void *m, int kind, int *value) { *value = ((Drive *)m)->ended; return kind == 3 ? OK : ERROR; }
STATES(fmi2, FMUstate, SerializedFMUstateSize, SerializeFMUstate, DeSerializeFMUstate)
#endif
