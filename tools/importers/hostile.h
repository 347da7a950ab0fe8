/* Hostile arguments: what the tests of them share. Each call is refused with one message and changes nothing. */
#include <math.h>

#include "roles.h"
#include "version.h"

void picture(Instance c);
bool unchanged(Instance c);
void refused(Instance c, Status status, const char *file, int line, const char *text);
#define REFUSED(c, call) (picture(c), refused(c, call, __FILE__, __LINE__, #call))
#define SAYS(text) CHECK(strstr(message, text) != NULL)
#define IS_OK(call) CHECK((call) == FMI_OK)

/* In arguments.c: of both versions. */
void null_pointers(Instance c);
void references(Instance c);

/* In arguments2.c and arguments3.c: of one version. */
void absent(Instance c);
void no_instance(void);
void instantiation(void);
void own_null_pointers(Instance c);

#if FMI_VERSION == 3
void start_values(Instance c);
void event_mode(Instance c);
static const fmi3ValueReference POSITIONS = 1000, ARRAYS_END = 1006, CLOCK = 2000;
#endif
