/* FMI 3.0 with hostile arguments: what the tests of it share. Each call is refused with one message and changes nothing. */
#include <math.h>

#include "importer3.h"
#include "roles.h"

void picture(fmi3Instance c);
bool unchanged(fmi3Instance c);
void refused(fmi3Instance c, fmi3Status status, const char *file, int line, const char *text);
#define REFUSED(c, call) (picture(c), refused(c, call, __FILE__, __LINE__, #call))
#define SAYS(text) CHECK(strstr(message, text) != NULL)
#define IS_OK(call) CHECK((call) == fmi3OK)

static const fmi3ValueReference POSITIONS = 1000, ARRAYS_END = 1006, CLOCK = 2000;

/* PLAIN is step mode of an importer without event mode, STEPPING that of one with it. */
enum { NEW, INITIALIZING, PLAIN, STEPPING, EVENT, TERMINATED, PHASES };

fmi3Instance in_phase(int phase);
fmi3Status step_to(fmi3Instance c, double time, double size);

void absent(fmi3Instance c);
void no_instance(void);
void instantiation(void);
void null_pointers(fmi3Instance c);
void references(fmi3Instance c);
