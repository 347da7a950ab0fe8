/* Names that the files of an FMU share, with the FMU's own prefix before them: several FMUs' sources can be linked into one program.

   FMI's own functions get the prefix in the standard's headers: compile all files of an FMU with -DFMI2_FUNCTION_PREFIX=NAME_ or, for FMI 3.0,
   -DFMI3_FUNCTION_PREFIX=NAME_, with another NAME for each. Without a prefix this file changes nothing. */
#ifndef NAMES_H
#define NAMES_H

#if defined(FMI2_FUNCTION_PREFIX) && !defined(FMI2_OVERRIDE_FUNCTION_PREFIX)
#define OWN_PREFIX FMI2_FUNCTION_PREFIX
#elif defined(FMI3_FUNCTION_PREFIX) && !defined(FMI3_OVERRIDE_FUNCTION_PREFIX)
#define OWN_PREFIX FMI3_FUNCTION_PREFIX
#elif defined(FMI3_ACTUAL_FUNCTION_PREFIX)
#define OWN_PREFIX FMI3_ACTUAL_FUNCTION_PREFIX
#endif

#if defined(OWN_PREFIX)
#define PASTE(prefix, name) prefix##name
#define PREFIXED(prefix, name) PASTE(prefix, name)
#define OWN(name) PREFIXED(OWN_PREFIX, name)

#define kernel_initialize OWN(kernel_initialize)
#define kernel_advance OWN(kernel_advance)
#define kernel_refresh OWN(kernel_refresh)
#define kernel_coast OWN(kernel_coast)
#define kernel_restore OWN(kernel_restore)
#define kernel_differentiate OWN(kernel_differentiate)

#define VARIABLES OWN(VARIABLES)
#define has_right_bits OWN(has_right_bits)
#define instance_new OWN(instance_new)
#define instance_free OWN(instance_free)
#define instance_reset OWN(instance_reset)
#define refuse OWN(refuse)
#define require_phase OWN(require_phase)
#define change_phase OWN(change_phase)
#define require_known_categories OWN(require_known_categories)
#define set_experiment OWN(set_experiment)
#define exit_initialization OWN(exit_initialization)
#define step_to_point OWN(step_to_point)
#define find_variable OWN(find_variable)
#define TYPE_NAMES OWN(TYPE_NAMES)
#define require_settable OWN(require_settable)
#define set_value OWN(set_value)
#define bring_up_to_date OWN(bring_up_to_date)
#define require_readable OWN(require_readable)
#define require_rate OWN(require_rate)
#define copy_with_rates OWN(copy_with_rates)
#define refuse_missing_array OWN(refuse_missing_array)
#define save_state OWN(save_state)
#define restore_state OWN(restore_state)
#define free_state OWN(free_state)
#define state_size OWN(state_size)
#define serialize_state OWN(serialize_state)
#define deserialize_state OWN(deserialize_state)
#endif

#endif
