/* How small deviations of a motion grow, and its largest Lyapunov exponent, from its impacts. The rules are ../deviations.py, translated. */
#include "fmi.h"
#include "growth.h"

enum { NUMBERS = 14 };
static const int places[NUMBERS] = {M1, M2, K1, K2, D1, D2, E, GAMMA, BONDED, CLEARANCE, E_SLOPE, BOX_AMPLITUDE, BOX_AMPLITUDE + 1, BOX_ACCELERATION};

/* Numbers of the memory for so many impacts. */
EXPORT size_t exponent_size(size_t count) { return TABLES + (ROW + 2 * STATES * STATES + 4) * count + 2 * (GROWTHS + 64); }

/* For each impact (time, state after it, closing speed, whether contact follows; SI) up to an end in s the matrix that maps a deviation before it to that
   before the next one, and how long contact lasts, in tau. Of the structure and its excitation there are NUMBERS numbers. */
EXPORT void find_deviations(const double *numbers, const double *impacts, size_t count, double end, double *memory, double *matrices, double *durations) {
    for (int i = 0; i < IMPACTS; i++) memory[i] = 0.0;
    for (int i = 0; i < NUMBERS; i++) memory[places[i]] = numbers[i];
    memory[IMPACTS] = (double)count;
    memory[SPAN_END] = end;
    for (size_t i = 0; i < ROW * count; i++) memory[TABLES + i] = impacts[i];
    kernel_deviate(memory, 0.0);
    const double *written = memory + TABLES + ROW * count;
    for (size_t i = 0; i < STATES * STATES * count; i++) matrices[i] = written[i];
    for (size_t i = 0; i < count; i++) durations[i] = written[STATES * STATES * count + i];
}

/* Logarithmic growth of a vector over blocks of so many matrices; false where it becomes zero. */
EXPORT bool find_growth(const double *matrices, size_t count, size_t rows, size_t size, double *memory, double *growth) {
    memory[COUNT] = (double)count;
    memory[ROWS] = (double)rows;
    memory[BLOCK_SIZE] = (double)size;
    double *copy = memory + VECTOR + 2 * rows;
    for (size_t i = 0; i < rows * rows * count; i++) copy[i] = matrices[i];
    kernel_grow(memory, 0.0);
    for (size_t i = 0; i * size < count; i++) growth[i] = copy[rows * rows * count + i];
    return memory[VANISHES] == 0.0;
}

/* Mean growth per time over blocks, and its standard error. */
EXPORT void find_average(const double *growth, const double *durations, size_t count, size_t batches, double *memory, double *mean) {
    memory[COUNT] = (double)count;
    memory[BATCHES] = (double)batches;
    for (size_t i = 0; i < count; i++) memory[GROWTHS + i] = growth[i], memory[GROWTHS + count + i] = durations[i];
    kernel_average(memory, 0.0);
    mean[0] = memory[MEAN];
    mean[1] = memory[ERROR];
}

/* The largest exponent per unit of tau and its standard error; minus infinity and NaN where permanent contact forgets all deviations. */
EXPORT void largest_exponent(const double *numbers, const double *impacts, size_t count, double end, size_t blocks, size_t batches, double *memory,
                             double *exponent) {
    size_t size = count / blocks ? count / blocks : 1, found = 0;
    double *matrices = memory + TABLES + (ROW + STATES * STATES + 1) * count, *growth = matrices + STATES * STATES * count, *durations = growth + count;
    find_deviations(numbers, impacts, count, end, memory, matrices, durations);
    double omega = memory[OMEGA];
    exponent[0] = -__builtin_inf(), exponent[1] = __builtin_nan("");
    if (!find_growth(matrices, count, STATES, size, memory, growth)) return;
    for (size_t i = 0; i < count; i += size) durations[found++] = omega * ((i + size < count ? impacts[ROW * (i + size)] : end) - impacts[ROW * i]);
    find_average(growth, durations, found, batches, memory, exponent);
}

/* What an exponent that only wanders, by this factor over a time, is at most. */
EXPORT double wander_floor(double wander, double span) { return logarithm(wander) / span; }

/* 1 chaotic, -1 periodic, 0 neither: within so many standard errors of zero, or within the floor. */
EXPORT int classify_exponent(double value, double error, double floor, double sigmas) {
    double distance = sigmas * error > floor ? sigmas * error : floor;
    return (value > distance) - (value < -distance);
}
