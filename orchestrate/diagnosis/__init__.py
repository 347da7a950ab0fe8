"""The diagnosis: from a record to a verdict.

=======================  ===========================================================================
module                   idea
=======================  ===========================================================================
:mod:`.indicators`       the model-free signs of the literature: formula, source, what moves them
:mod:`.signs`            the signs of a record, their floors, and those of a sound structure
:mod:`.response_signs`   signs of accelerations over time
:mod:`.drive_signs`      signs of a run on a weak drive
:mod:`.undamaged`        the sound structure that a record is compared with: a linear oscillator
:mod:`.opening_force`    the force that would open the faces of a sound structure, in closed form
:mod:`.plan_test`        the lowest level at which ``detect`` decides, by rehearsals
:mod:`.settings`         every threshold and effort, in one place that a caller reaches
:mod:`.order_windows`    orders of a record's channels in short windows, and the floor between them
:mod:`.wiring`           whether channels are wired as stated: polarity, unit, delay, swapped, hum
:mod:`.evidence`         orders of a record with their errors, and the base as input of motions
:mod:`.curve_evidence`   the same of a resonance curve: settled motions under a stepped sine
:mod:`.single_mass`      a sound structure's motion: one mass on a spring that is not linear
:mod:`.hypotheses`       what the structure may be: sound in several ways, or delaminated
:mod:`.multistart`       the search for a hypothesis's numbers, from many starts
:mod:`.misfit`           the soft misfit of residuals, and a linear model of these around a minimum
:mod:`.standard_errors`  standard errors from simulated noise and from blocks of windows
:mod:`.opening_measures` whether faces open: order 2 above its floor, two faces that move apart
:mod:`.impact_timing`    when in the period something strikes, and by that what does
:mod:`.search_job`       all searches of a record as a job, in parallel
:mod:`.fit`              the numbers of a structure from a record
:mod:`.decision_rule`    the rule by which the records of a beam become a verdict
:mod:`.detect`           the verdict on a beam's records, and on those of many beams, in parallel
=======================  ===========================================================================
"""
