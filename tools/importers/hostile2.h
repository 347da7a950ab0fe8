/* FMI 2.0 with hostile arguments: what the tests of it share. Each call is refused with one message and changes nothing. */
#include <math.h>

#include "importer2.h"
#include "roles.h"

void picture(fmi2Component c);
bool unchanged(fmi2Component c);
void refused(fmi2Component c, fmi2Status status, const char *file, int line, const char *text);
#define REFUSED(c, call) (picture(c), refused(c, call, __FILE__, __LINE__, #call))
#define SAYS(text) CHECK(strstr(message, text) != NULL)
#define IS_OK(call) CHECK((call) == fmi2OK)

enum { NEW, INITIALIZING, STEPPING, TERMINATED, PHASES };

fmi2Component in_phase(int phase);

void absent(fmi2Component c);
void no_instance(void);
void instantiation(void);
void null_pointers(fmi2Component c);
void references(fmi2Component c);
