/* Amplitude spectra of sampled signals of any length, through a Hann window. */
#include "fmi.h"
#include "turn.h"

typedef struct { double re, im; } Complex;

static Complex product(Complex a, Complex b) { return (Complex){a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re}; }

static Complex turned(double turns) {
    double both[2];
    kernel_write_cosine_and_sine(both, turns);
    return (Complex){both[0], both[1]};
}

/* Discrete Fourier transform in place, of a power of two of numbers. */
static void transform(Complex *z, const Complex *turns, size_t length) {
    for (size_t k = 1, swap = 0; k < length; k++) {
        size_t bit = length / 2;
        for (; swap & bit; bit /= 2) swap ^= bit;
        swap ^= bit;
        if (k < swap) { Complex kept = z[k]; z[k] = z[swap]; z[swap] = kept; }
    }
    for (size_t half = 1; half < length; half *= 2) for (size_t block = 0; block < length; block += 2 * half) for (size_t k = 0; k < half; k++) {
        Complex *one = z + block + k, other = product(one[half], turns[length / (2 * half) * k]);
        one[half] = (Complex){one->re - other.re, one->im - other.im};
        *one = (Complex){one->re + other.re, one->im + other.im};
    }
}

static size_t transform_length(size_t count) {
    size_t length = 1;
    while (length < 2 * count) length *= 2;
    return length;
}

/* Amplitudes of count/2 + 1 lines of the signal at the memory's begin, by Bluestein's transform: a convolution with a chirp.
   The window takes the mean, which it would spread to the next line, from all lines but the mean's own. */
static void find_lines(double *memory, size_t count, double *amplitudes) {
    size_t length = transform_length(count), part = 0;
    Complex *one = (Complex *)(memory + count), *other = one + length, *turns = other + length;
    double mean = 0.0, whole = 0.0, number = (double)count;
    for (size_t k = 0; k < count; k++) mean += memory[k] / number;
    for (size_t k = 0; k < length; k++) one[k] = other[k] = (Complex){0.0, 0.0};
    for (size_t k = 0; k < length / 2; k++) turns[k] = turned(-(double)k / (double)length);
    for (size_t k = 0; k < count; part = (part + 2 * k + 1) % (2 * count), k++) {  /* k^2, less whole turns */
        double weight = 0.5 - 0.5 * turned((double)k / number).re, value = weight * (memory[k] - mean);
        Complex chirp = other[k] = turned(0.5 * (double)part / number);
        if (k) other[length - k] = chirp;
        one[k] = (Complex){value * chirp.re, -value * chirp.im};
        whole += weight * memory[k];
    }
    transform(one, turns, length);
    transform(other, turns, length);
    for (size_t k = 0; k < length; k++) one[k] = product(one[k], other[k]), one[k].im = -one[k].im;  /* for the inverse transform */
    transform(one, turns, length);
    for (size_t k = 0; k <= count / 2; k++)  /* a half of a line is at the negative frequency, and the window's mean is a half */
        amplitudes[k] = 4.0 / number / (double)length * sqrt(one[k].re * one[k].re + one[k].im * one[k].im);
    if (count % 2 == 0) amplitudes[count / 2] *= 0.5;  /* its own negative frequency */
    amplitudes[0] = fabs(2.0 * whole / number);
}

/* Size of the memory for a number of samples. */
EXPORT size_t spectrum_size(size_t count) { return count + 5 * transform_length(count); }

EXPORT void amplitude_spectrum(const double *signal, size_t count, double *memory, double *amplitudes) {
    for (size_t k = 0; k < count; k++) memory[k] = signal[k];
    find_lines(memory, count, amplitudes);
}

/* Amplitudes of a mass's absolute acceleration, impulses included, by states at equal parts of some periods, the last at their end.
   The square of the frequency times the displacement's spectrum has the impulses, which no sampled acceleration has. */
EXPORT void acceleration_spectrum(const double *positions, size_t stride, size_t count, size_t periods, double frequency, double amplitude,
                                  double *memory, double *amplitudes) {
    for (size_t k = 0; k < count; k++) memory[k] = positions[stride * k] + amplitude * turned((double)(periods * (k + 1)) / (double)count).im;
    find_lines(memory, count, amplitudes);
    for (size_t k = 0; k <= count / 2; k++) {
        double speed = frequency * (double)k / (double)periods;
        amplitudes[k] *= speed * speed;
    }
}
