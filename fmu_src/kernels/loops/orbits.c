/* Closed-form motion between impacts and the equations of periodic orbits: ../orbits.py, translated. */
#include "fmi.h"
#include "orbits.h"

EXPORT void find_flows(double *memory) { kernel_flow(memory, 0.0); }

EXPORT void find_steady(double *memory) { kernel_steady(memory, 0.0); }

EXPORT void find_rates(double *memory) { kernel_field(memory, 0.0); }

EXPORT void find_motion(double *memory) { kernel_motion(memory, 0.0); }

EXPORT void find_segments(double *memory) { kernel_segments(memory, 0.0); }
