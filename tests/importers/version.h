/* The FMI version of the FMU at hand: its functions in the table `fmi`, and by names that both versions share. */
#include "importer.h"
#if FMI_VERSION == 2
#include "importer2.h"
#else
#include "importer3.h"
#endif

/* Of scalar variables: as many values as references. */
#define TRANSFER(NAME, FUNCTION, TYPE) \
    static inline Status NAME(Instance c, const unsigned *r, size_t count, TYPE *x) { return fmi.FUNCTION(c, r, count, VALUES(x, count)); }
TRANSFER(get_reals, REALS(Get), double)
TRANSFER(set_reals, REALS(Set), const double)
TRANSFER(get_integers, INTEGERS(Get), Integer)
TRANSFER(set_integers, INTEGERS(Set), const Integer)
TRANSFER(get_booleans, GetBoolean, Boolean)
TRANSFER(set_booleans, SetBoolean, const Boolean)

static inline Status get_state(Instance c, State *state) { return fmi.STATE(Get)(c, state); }
static inline Status set_state(Instance c, State state) { return fmi.STATE(Set)(c, state); }
static inline Status free_state(Instance c, State *state) { return fmi.STATE(Free)(c, state); }
static inline Status serialized_size(Instance c, State state, size_t *size) { return fmi.STATE_SIZE(c, state, size); }
static inline Status serialize(Instance c, State state, char *bytes, size_t size) { return fmi.STATE(Serialize)(c, state, (void *)bytes, size); }
static inline Status deserialize(Instance c, const char *bytes, size_t size, State *state) { return fmi.DESERIALIZE(c, (const void *)bytes, size, state); }
