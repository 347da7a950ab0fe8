/* The compiled kernel as a library of its own, for the pythonfmu form. */
#ifdef _WIN32
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

int kernel_initialize(double *memory, double time);
int kernel_advance(double *memory, double time);
int kernel_differentiate(double *memory, double time);
int kernel_restore(double *memory, double start_time);

EXPORT int initialize(double *memory, double time) { return kernel_initialize(memory, time); }
EXPORT int advance(double *memory, double time) { return kernel_advance(memory, time); }
EXPORT int differentiate(double *memory, double time) { return kernel_differentiate(memory, time); }
EXPORT int restore(double *memory, double start_time) { return kernel_restore(memory, start_time); }

#ifdef REFRESH
int kernel_refresh(double *memory, double time);
EXPORT int refresh(double *memory, double time) { return kernel_refresh(memory, time); }
#endif

#ifdef COAST
int kernel_coast(double *memory, double time);
EXPORT int coast(double *memory, double time) { return kernel_coast(memory, time); }
#endif
