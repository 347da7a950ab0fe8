/* Closed-form motion between impacts and the equations of periodic orbits: ../orbits.py, translated. */
#include "fmi.h"
#include "orbits.h"

EXPORT void find_flows(double *memory) { kernel_write_free_flows(memory, 0.0); }

EXPORT void find_steady(double *memory) { kernel_write_steady_states(memory, 0.0); }

EXPORT void find_rates(double *memory) { kernel_write_rates_of_states(memory, 0.0); }

EXPORT void find_motion(double *memory) { kernel_write_later_states(memory, 0.0); }

EXPORT void find_segments(double *memory) { kernel_write_segment_equations(memory, 0.0); }
