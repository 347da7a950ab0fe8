/* A linear drive of somebody else as an FMI 3.0 FMU: x' = A x + B u, acceleration C x + D u, exact
 * for inputs that are held over a step. References: parameters from 0, u from 30, outputs from 40. */
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

enum { N = 4, OK = 0, ERROR = 3 };

typedef struct {
    double a[N][N], b[N][2], c[N], d[2];  /* the parameters, in this order */
    double u[2], x[N];
} Drive;

static double *place(Drive *m, unsigned reference, double *value) {
    if (reference < 30) return &m->a[0][0] + reference;
    if (reference < 32) return m->u + reference - 30;
    if (reference == 40) {
        *value = m->d[0] * m->u[0] + m->d[1] * m->u[1];
        for (int i = 0; i < N; i++) *value += m->c[i] * m->x[i];
        return value;
    }
    return reference < 43 ? m->x + reference - 41 : NULL;
}

const char *fmi3GetVersion(void) { return "3.0"; }
int fmi3SetDebugLogging(void *m, bool on, size_t n, const char *const *names) { return OK; }
void *fmi3InstantiateCoSimulation(const char *name, const char *token, const char *path, bool visible, bool logging,
                                  bool events, bool early, const unsigned *needed, size_t n, void *environment,
                                  void *log, void *update) { return calloc(1, sizeof(Drive)); }
void fmi3FreeInstance(void *m) { free(m); }
int fmi3EnterInitializationMode(void *m, bool has_tolerance, double tolerance, double start, bool has_stop, double stop) { return OK; }
int fmi3ExitInitializationMode(void *m) { return OK; }
int fmi3Terminate(void *m) { return OK; }
int fmi3Reset(void *m) { memset(m, 0, sizeof(Drive)); return OK; }

int fmi3SetFloat64(void *m, const unsigned *references, size_t n, const double *values, size_t count) {
    double none;
    for (size_t i = 0; i < n; i++) {
        double *at = references[i] < 32 ? place(m, references[i], &none) : NULL;
        if (!at) return ERROR;
        *at = values[i];
    }
    return OK;
}

int fmi3GetFloat64(void *m, const unsigned *references, size_t n, double *values, size_t count) {
    double value;
    for (size_t i = 0; i < n; i++) {
        double *at = place(m, references[i], &value);
        if (!at) return ERROR;
        values[i] = *at;
    }
    return OK;
}

int fmi3DoStep(void *instance, double time, double h, bool later, bool *event, bool *end, bool *early, double *last) {
    Drive *m = instance;
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
    *event = *end = *early = false, *last = time + h;
    return OK;
}

int fmi3GetFMUState(void *m, void **state) {
    if (!*state) *state = malloc(sizeof(Drive));
    memcpy(*state, m, sizeof(Drive));
    return OK;
}
int fmi3SetFMUState(void *m, void *state) { memcpy(m, state, sizeof(Drive)); return OK; }
int fmi3FreeFMUState(void *m, void **state) { free(*state); *state = NULL; return OK; }
int fmi3SerializedFMUStateSize(void *m, void *state, size_t *size) { *size = sizeof(Drive); return OK; }
int fmi3SerializeFMUState(void *m, void *state, unsigned char *bytes, size_t size) { memcpy(bytes, state, size); return OK; }
int fmi3DeserializeFMUState(void *m, const unsigned char *bytes, size_t size, void **state) {
    if (!*state) *state = malloc(sizeof(Drive));
    memcpy(*state, bytes, size);
    return OK;
}

/* Importers look all of these up. */
#define NONE(name) int fmi3##name(void) { return ERROR; }
NONE(ActivateModelPartition) NONE(CompletedIntegratorStep) NONE(EnterConfigurationMode) NONE(EnterContinuousTimeMode)
NONE(EnterEventMode) NONE(EnterStepMode) NONE(EvaluateDiscreteStates) NONE(ExitConfigurationMode)
NONE(GetAdjointDerivative) NONE(GetBinary) NONE(GetBoolean) NONE(GetClock) NONE(GetContinuousStateDerivatives)
NONE(GetContinuousStates) NONE(GetDirectionalDerivative) NONE(GetEventIndicators) NONE(GetFloat32) NONE(GetInt16)
NONE(GetInt32) NONE(GetInt64) NONE(GetInt8) NONE(GetIntervalDecimal) NONE(GetIntervalFraction)
NONE(GetNominalsOfContinuousStates) NONE(GetNumberOfContinuousStates) NONE(GetNumberOfEventIndicators)
NONE(GetNumberOfVariableDependencies) NONE(GetOutputDerivatives) NONE(GetShiftDecimal) NONE(GetShiftFraction)
NONE(GetString) NONE(GetUInt16) NONE(GetUInt32) NONE(GetUInt64) NONE(GetUInt8) NONE(GetVariableDependencies)
NONE(InstantiateModelExchange) NONE(InstantiateScheduledExecution) NONE(SetBinary) NONE(SetBoolean) NONE(SetClock)
NONE(SetContinuousStates) NONE(SetFloat32) NONE(SetInt16) NONE(SetInt32) NONE(SetInt64) NONE(SetInt8)
NONE(SetIntervalDecimal) NONE(SetIntervalFraction) NONE(SetShiftDecimal) NONE(SetShiftFraction) NONE(SetString)
NONE(SetTime) NONE(SetUInt16) NONE(SetUInt32) NONE(SetUInt64) NONE(SetUInt8) NONE(UpdateDiscreteStates)
