/* The amplitude spectrum of a sampled signal; its rule is ../spectrum.py, translated. */
#include "fmi.h"
#include "lines.h"

/* Numbers of the memory for so many samples. */
EXPORT size_t spectrum_size(size_t count) { return HEAD + count + 5 * (size_t)transform_length((int)count); }

static void transform_signal(double *memory, size_t count) {
    memory[COUNT] = (double)count;
    kernel_amplitudes(memory, 0.0);
}

/* Amplitudes of count/2 + 1 lines. */
EXPORT void amplitude_spectrum(const double *signal, size_t count, double *memory, double *amplitudes) {
    for (size_t k = 0; k < count; k++) memory[HEAD + k] = signal[k];
    transform_signal(memory, count);
    for (size_t k = 0; k <= count / 2; k++) amplitudes[k] = memory[HEAD + k];
}

/* Amplitudes of a mass's absolute acceleration, impulses included, by states at equal parts of some periods, the last at their end.
   The square of the frequency times the displacement's spectrum has the impulses, which no sampled acceleration has. */
EXPORT void acceleration_spectrum(const double *positions, size_t stride, size_t count, size_t periods, double frequency, double amplitude,
                                  double *memory, double *amplitudes) {
    for (size_t k = 0; k < count; k++) {
        double turns = (double)(periods * (k + 1)) / (double)count;
        memory[HEAD + k] = positions[stride * k] + amplitude * sincos_turns(turns).i0;
    }
    transform_signal(memory, count);
    for (size_t k = 0; k <= count / 2; k++) {
        double speed = frequency * (double)k / (double)periods;
        amplitudes[k] = speed * speed * memory[HEAD + k];
    }
}
