/* Calls that nobody would think of, read from bytes: for a fuzzer, or for bytes drawn at random. Nothing may crash, and what is refused is said. */
#ifndef FUZZ_H
#define FUZZ_H

#include <math.h>

#include "importer.h"

typedef struct { const uint8_t *at, *end; } Bytes;

static inline uint8_t take(Bytes *in) { return in->at < in->end ? *in->at++ : 0; }
static inline bool one_in(Bytes *in, int count) { return take(in) % count == 0; }

/* Any variable, now and then no variable at all. */
static inline unsigned any_reference(Bytes *in) {
    static const unsigned other[] = {0u, 1000u, 1005u, 1006u, 2000u, 2001u, 0x7fffffffu, 0xffffffffu};
    if (one_in(in, 8)) return other[take(in) % 8];
    unsigned place = take(in);
    return NAMES[(one_in(in, 16) ? place * 256u + take(in) : place % 48u) % NAME_COUNT].reference;
}

/* Numbers that keep a step short, and those that are refused; no driver of 1e30 rad/s, which is refused only after ten seconds. */
static inline double any_number(Bytes *in) {
    static const double special[] = {NAN, INFINITY, -INFINITY, -1.0, 0.0, 1.0, 0.5, 1e301};
    uint8_t kind = take(in);
    return kind < 64 ? special[kind % 8] : ((double)take(in) - 64.0) / 16.0;
}

static inline double any_step(Bytes *in) {
    static const double special[] = {NAN, INFINITY, -1.0, 5e-324, 0.0};
    uint8_t kind = take(in);
    return kind < 32 ? special[kind % 5] : (kind - 31) / 64.0;
}

/* The calls of one input, on a few instances; all are freed at the end. */
void fuzz(const uint8_t *data, size_t size);

#endif
