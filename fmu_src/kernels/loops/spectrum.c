/* The amplitude spectrum of a sampled signal; its rule is ../spectrum.py, translated. */
#include "fmi.h"
#include "lines.h"

/* Numbers of the memory for so many samples. */
EXPORT size_t spectrum_size(size_t count) { return HEAD + 3 * count + 5 * (size_t)transform_length((int)count); }

/* Amplitudes of count/2 + 1 lines. */
EXPORT void amplitude_spectrum(const double *signal, size_t count, double *memory, double *amplitudes) {
    memory[COUNT] = (double)count;
    for (size_t k = 0; k < count; k++) memory[HEAD + k] = signal[k];
    kernel_amplitudes(memory, 0.0);
    for (size_t k = 0; k <= count / 2; k++) amplitudes[k] = memory[HEAD + k];
}
