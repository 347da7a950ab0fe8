"""The diagnosis: from a record to a verdict.

======================  ===========================================================================
module                  idea
======================  ===========================================================================
:mod:`.orders`          orders of a record's channels in short windows, and the floor between them
:mod:`.indicators`      the model-free signs of the literature: formula, source, what moves them
:mod:`.signs`           the signs of a record, their floors, and those of a sound structure
:mod:`.response_signs`  signs of accelerations over time
:mod:`.drive_signs`     signs of a run on a weak drive
:mod:`.sound`           the sound structure that a record is compared with
:mod:`.opening`         the force that would open the faces of a sound structure, in closed form
:mod:`.plan_test`       where the delaminated and the sound structure differ most
======================  ===========================================================================
"""
