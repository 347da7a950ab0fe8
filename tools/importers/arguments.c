/* Both FMI versions: null pointers and wrong references. */
#include "hostile.h"

void null_pointers(Instance c) {
    const unsigned *r = reference(OUTPUT), *in = reference(SMOOTH_INPUT), *b = reference(TUNABLE), *n = reference(COUNT);
    double x = 0.0;
    Integer one = 1;
    Boolean truth = true;
    REFUSED(c, get_reals(c, NULL, 1, &x)); REFUSED(c, get_reals(c, r, 1, NULL));
    REFUSED(c, set_reals(c, NULL, 1, &x)); REFUSED(c, set_reals(c, in, 1, NULL));
    REFUSED(c, get_integers(c, NULL, 1, &one)); REFUSED(c, get_integers(c, n, 1, NULL));
    REFUSED(c, set_integers(c, NULL, 1, &one)); REFUSED(c, set_integers(c, n, 1, NULL));
    REFUSED(c, get_booleans(c, NULL, 1, &truth)); REFUSED(c, get_booleans(c, b, 1, NULL));
    REFUSED(c, set_booleans(c, NULL, 1, &truth)); REFUSED(c, set_booleans(c, b, 1, NULL));
    REFUSED(c, get_derivatives(c, NULL, 1, &one, &x)); REFUSED(c, get_derivatives(c, r, 1, NULL, &x));
    REFUSED(c, get_derivatives(c, r, 1, &one, NULL));
    REFUSED(c, get_state(c, NULL)); REFUSED(c, set_state(c, NULL));
    const char *categories[] = {"logStatusError", "%s%n"}, *nothing = NULL;
    IS_OK(fmi.SetDebugLogging(c, true, 0, NULL)); IS_OK(fmi.SetDebugLogging(c, true, 1, categories));
    REFUSED(c, fmi.SetDebugLogging(c, true, 2, categories)); SAYS("logAll");
    REFUSED(c, fmi.SetDebugLogging(c, true, 1, &nothing)); REFUSED(c, fmi.SetDebugLogging(c, true, 1, NULL));
    IS_OK(get_reals(c, NULL, 0, NULL)); IS_OK(set_reals(c, NULL, 0, NULL));
    IS_OK(get_integers(c, NULL, 0, NULL)); IS_OK(set_integers(c, NULL, 0, NULL));
    IS_OK(get_booleans(c, NULL, 0, NULL)); IS_OK(set_booleans(c, NULL, 0, NULL));
    IS_OK(get_derivatives(c, NULL, 0, NULL, NULL));
    IS_OK(free_state(c, NULL)); /* as the standard has it */
}

/* Reals that names.h does not have: FMI 3.0's arrays and their elements are another test's. */
static bool of_array(unsigned r, const Name *name) {
#if FMI_VERSION == 3
    return !name && (r < TIME_REFERENCE || (ARRAYS && r >= POSITIONS && r < ARRAYS_END));
#else
    return (void)r, (void)name, false;
#endif
}

/* Every reference with every type: only those of modelDescription.xml. */
void references(Instance c) {
    for (unsigned i = 0; i < 2200; i++) {
        unsigned r = i < 2100 ? i : i < 2150 ? 0x7fffffc0u + i - 2100 : 0xffffffffu - (i - 2150);
        const Name *name = NULL;
        for (size_t k = 0; k < NAME_COUNT; k++) if (NAMES[k].reference == r) name = &NAMES[k];
        char type = name ? name->type : 0;
        double x = 0.0;
        Integer n = 0;
        Boolean b = false;
        if (type != 'R' || !name->settable) REFUSED(c, set_reals(c, &r, 1, &x));
        if (type != 'I' || !name->settable) REFUSED(c, set_integers(c, &r, 1, &n));
        if (type != 'B' || !name->settable) REFUSED(c, set_booleans(c, &r, 1, &b));
        if (type == 'I') IS_OK(get_integers(c, &r, 1, &n));
        else REFUSED(c, get_integers(c, &r, 1, &n));
        if (type == 'B') IS_OK(get_booleans(c, &r, 1, &b));
        else REFUSED(c, get_booleans(c, &r, 1, &b));
        if (type == 'R') IS_OK(get_reals(c, &r, 1, &x));
        else if (FMI_VERSION == 3 && r == TIME_REFERENCE) { IS_OK(get_reals(c, &r, 1, &x)); CHECK(x == 20.0); }
        else if (!of_array(r, name)) REFUSED(c, get_reals(c, &r, 1, &x));
    }
}
