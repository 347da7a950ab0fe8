/* Sources of three FMUs in one program, each with a prefix of its own: all run, side by side. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

typedef void *Any;
typedef struct { Any logger, allocate, release, finished, environment; } Callbacks;

/* as the standard's headers declare them with FMI2_FUNCTION_PREFIX and FMI3_FUNCTION_PREFIX */
Any Second_fmi2Instantiate(const char *, int, const char *, const char *, const Callbacks *, int, int);
int Second_fmi2SetupExperiment(Any, int, double, double, int, double);
int Second_fmi2EnterInitializationMode(Any);
int Second_fmi2ExitInitializationMode(Any);
int Second_fmi2DoStep(Any, double, double, int);
int Second_fmi2GetReal(Any, const unsigned *, size_t, double *);
void Second_fmi2FreeInstance(Any);
#define DECLARE(PREFIX)                                                                                                                       \
    Any PREFIX##_fmi3InstantiateCoSimulation(const char *, const char *, const char *, bool, bool, bool, bool, const uint32_t *, size_t, Any, Any, Any); \
    int PREFIX##_fmi3EnterInitializationMode(Any, bool, double, double, bool, double);                                                       \
    int PREFIX##_fmi3ExitInitializationMode(Any);                                                                                            \
    int PREFIX##_fmi3DoStep(Any, double, double, bool, bool *, bool *, bool *, double *);                                                    \
    int PREFIX##_fmi3GetFloat64(Any, const uint32_t *, size_t, double *, size_t);                                                            \
    void PREFIX##_fmi3FreeInstance(Any);
DECLARE(Third)
DECLARE(Shaker)

#define DO(CALL) do { if (CALL) return fprintf(stderr, "%s\n", #CALL), 1; } while (0)

int main(int count, char **arguments) {
    if (count != 4) return 2;
    const uint32_t v1 = 23, speed = 24;
    const Callbacks callbacks = {NULL, NULL, NULL, NULL, NULL};
    Any second = Second_fmi2Instantiate("second", 1, arguments[1], "", &callbacks, 0, 0);
    Any third = Third_fmi3InstantiateCoSimulation("third", arguments[2], "", false, false, false, false, NULL, 0, NULL, NULL, NULL);
    Any shaker = Shaker_fmi3InstantiateCoSimulation("shaker", arguments[3], "", false, false, false, false, NULL, 0, NULL, NULL, NULL);
    DO(!second || !third || !shaker);
    DO(Second_fmi2SetupExperiment(second, 0, 0.0, 0.0, 0, 0.0) || Second_fmi2EnterInitializationMode(second) || Second_fmi2ExitInitializationMode(second));
    DO(Third_fmi3EnterInitializationMode(third, false, 0.0, 0.0, false, 0.0) || Third_fmi3ExitInitializationMode(third));
    DO(Shaker_fmi3EnterInitializationMode(shaker, false, 0.0, 0.0, false, 0.0) || Shaker_fmi3ExitInitializationMode(shaker));
    bool event, end, early;
    double last, values[3];
    for (int i = 0; i < 100; i++) {
        DO(Second_fmi2DoStep(second, i, 1.0, 1));
        DO(Third_fmi3DoStep(third, i, 1.0, true, &event, &end, &early, &last));
        DO(Shaker_fmi3DoStep(shaker, i * 0.01, 0.01, true, &event, &end, &early, &last));
    }
    DO(Second_fmi2GetReal(second, &v1, 1, &values[0]));
    DO(Third_fmi3GetFloat64(third, &v1, 1, &values[1], 1));
    DO(Shaker_fmi3GetFloat64(shaker, &speed, 1, &values[2], 1));
    printf("%a %a %a\n", values[0], values[1], values[2]);
    Second_fmi2FreeInstance(second);
    Third_fmi3FreeInstance(third);
    Shaker_fmi3FreeInstance(shaker);
    return 0;
}
