/* The FMI version of the FMU at hand: its functions in the table `fmi`, and by names that both versions share. */
#include "importer.h"
#if FMI_VERSION == 2
#include "importer2.h"
#else
#include "importer3.h"
#endif
