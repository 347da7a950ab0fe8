/* Calls that nobody would think of, read from bytes: for a fuzzer, or for bytes drawn at random. Nothing may crash, and what is refused is said. */
#ifndef FUZZ_H
#define FUZZ_H

#include <math.h>

#include "importer.h"

enum { MOST = 3 }; /* variables in one call */

typedef struct { const uint8_t *at, *end; } Bytes;

/* An instance, a state of it that was kept, and the time it has reached. */
typedef struct { void *instance, *state; double time; } Slot;

/* Whether values are drawn from the whole range that modelDescription.xml declares, under a small evaluation_limit; else such as keep a step short. */
extern bool declared;

uint8_t take(Bytes *in);
bool one_in(Bytes *in, int count);
unsigned any_reference(Bytes *in);
double any_number(Bytes *in);
double number_for(Bytes *in, unsigned reference);

/* Values of the declared range for some variables, then initialized; refused or not. */
void fuzz_start(Bytes *in, Slot *slot);

/* Every refusal comes with a message. */
void told(int status);
void fuzz_reset(Bytes *in, void *instance);

/* Of an FMI version: each reads its arguments from the bytes. */
void fuzz_open(Bytes *in, Slot *slot);
void fuzz_values(Bytes *in, void *instance);
void fuzz_life(Bytes *in, void *instance);
void fuzz_rest(Bytes *in, void *instance);
void fuzz_step(Bytes *in, void *instance, double time, double size);

/* The calls of one input, on a few instances; all are freed at the end. */
void fuzz(const uint8_t *data, size_t size);

#endif
