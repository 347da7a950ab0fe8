/* libFuzzer's way in: the FMU's binary from the environment, and each input one test. */
#include "fuzz.h"

int LLVMFuzzerInitialize(int *count, char ***arguments) {
    (void)count, (void)arguments;
    fmu_load(getenv("FMU_BINARY"));
    return 0;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    fuzz(data, size);
    if (failures) abort();
    return 0;
}
