/* How small deviations of a motion grow, and its largest Lyapunov exponent, from its impacts. Matrices by ../deviations.py, translated. */
#include "fmi.h"
#include "deviations.h"

#define LN2 0.6931471805599453

enum { NUMBERS = 18, MOST_ROWS = 6 };
static const int places[NUMBERS] = {M1, M2, K1, K2, D1, D2, E, GAMMA, BONDED, WALL, CLEARANCE, STROKE, E_SLOPE, BOX_AMPLITUDE, BOX_AMPLITUDE + 1, BOX_ACCELERATION,
                                     FORCE1_AMPLITUDE, FORCE1_AMPLITUDE + 1};

/* Size of the memory for a number of impacts. */
EXPORT size_t exponent_size(size_t count) { return TABLES + (ROW + STATES * STATES + 3) * count; }

/* For each impact (time, state after it, closing speed, whether contact follows; SI) up to an end in s the matrix that maps a deviation before it to that
   before the next one; then how long each contact lasts, in tau. Of the structure and its excitation there are NUMBERS numbers. The answer is where in the
   memory the matrices begin. */
EXPORT size_t find_deviations(const double *numbers, const double *impacts, size_t count, double end, double *memory) {
    for (int i = 0; i < IMPACTS; i++) memory[i] = 0.0;
    for (int i = 0; i < NUMBERS; i++) memory[places[i]] = numbers[i];
    memory[IMPACTS] = (double)count;
    memory[SPAN_END] = end;
    for (size_t i = 0; i < ROW * count; i++) memory[TABLES + i] = impacts[i];
    kernel_write_deviation_matrices(memory, 0.0);
    return TABLES + ROW * count;
}

static double logarithm(double x) {
    int exponent = 0;
    if (!__builtin_isfinite(x)) return x;
    for (; x > 1.5; x *= 0.5) exponent++;
    for (; x < 0.75; x *= 2.0) exponent--;
    double s = (x - 1.0) / (x + 1.0), total = 0.0;
    for (int n = 23; n > 0; n -= 2) total = total * s * s + 1.0 / n;
    return exponent * LN2 + 2.0 * s * total;
}

/* Logarithmic growth of a vector over blocks of matrices; false where it becomes zero. */
EXPORT bool find_growth(const double *matrices, size_t count, size_t rows, size_t size, double *growth) {
    double vector[MOST_ROWS], next[MOST_ROWS], total = 0.0;
    for (size_t k = 0; k < rows; k++) vector[k] = 1.0 / (1.0 + 0.7 * (double)k);  /* in no special direction */
    for (size_t i = 0; i < count; i++, matrices += rows * rows) {
        double largest = 0.0, square = 0.0;
        for (size_t k = 0; k < rows; k++) {
            next[k] = 0.0;
            for (size_t j = 0; j < rows; j++) next[k] += matrices[rows * k + j] * vector[j];
            if (fabs(next[k]) > largest) largest = fabs(next[k]);
        }
        if (largest == 0.0) return false;
        for (size_t k = 0; k < rows; k++) next[k] /= largest, square += next[k] * next[k];
        double norm = sqrt(square);
        for (size_t k = 0; k < rows; k++) vector[k] = next[k] / norm;
        total += logarithm(largest) + logarithm(norm);
        if ((i + 1) % size == 0 || i + 1 == count) growth[i / size] = total, total = 0.0;
    }
    return true;
}

/* Mean growth per time over blocks, and its standard error by batch means; the first group is left out. */
EXPORT void find_average(const double *growth, const double *durations, size_t count, size_t batches, double *mean) {
    double means = 0.0, squares = 0.0, grown = 0.0, time = 0.0;
    size_t groups = batches - 1;
    for (int pass = 0; pass < 2; pass++) {
        for (size_t group = groups, block = count / batches; group > 0; group--) {
            double own = 0.0, duration = 0.0;
            for (size_t left = (count - block + group - 1) / group; left > 0; left--, block++) own += growth[block], duration += durations[block];
            if (pass) squares += (own / duration - means) * (own / duration - means);
            else means += own / duration / (double)groups, grown += own, time += duration;
        }
    }
    mean[0] = grown / time;
    mean[1] = sqrt(squares / (double)(groups - 1) / (double)groups);
}

/* The largest exponent per unit of tau and its standard error; minus infinity and NaN where permanent contact forgets all deviations. */
EXPORT void largest_exponent(const double *numbers, const double *impacts, size_t count, double end, size_t blocks, size_t batches, double *memory,
                             double *exponent) {
    size_t size = count / blocks ? count / blocks : 1, found = 0;
    double *matrices = memory + find_deviations(numbers, impacts, count, end, memory), omega = memory[OMEGA];
    double *growth = matrices + (STATES * STATES + 1) * count, *durations = growth + count;
    exponent[0] = -__builtin_inf(), exponent[1] = __builtin_nan("");
    if (!find_growth(matrices, count, STATES, size, growth)) return;
    for (size_t i = 0; i < count; i += size) durations[found++] = omega * ((i + size < count ? impacts[ROW * (i + size)] : end) - impacts[ROW * i]);
    find_average(growth, durations, found, batches, exponent);
}

/* What an exponent that only wanders, by this factor over a time, is at most. */
EXPORT double wander_floor(double wander, double span) { return logarithm(wander) / span; }

/* 1 chaotic, -1 periodic, 0 neither: within a number of standard errors of zero, or within the floor. */
EXPORT int classify_exponent(double value, double error, double floor, double sigmas) {
    double distance = sigmas * error > floor ? sigmas * error : floor;
    return (value > distance) - (value < -distance);
}
