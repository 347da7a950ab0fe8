"""All that is long, in one way: chunks on all cores or a cluster, resumable, whole or not at all.

==================  ===============================================================================
module              idea
==================  ===============================================================================
:mod:`.job`         what a long computation is: items, chunks, what decides its numbers
:mod:`.identity`    what a stored result answers: the question, the FMUs, the code
:mod:`.options`     how a question is computed, whatever it asks
:mod:`.store`       where chunks and results are kept: in memory or on disk
:mod:`.journal`     chunks on disk while a job is under way
:mod:`.provenance`  where a dataset comes from, in its attributes
:mod:`.executors`   who computes: this process, or processes of this machine
:mod:`.cluster`     the workers of a Dask scheduler
:mod:`.progress`    how far a job is, and what may be computed next, guesses included
:mod:`.runner`      keeps them busy until every result is there
==================  ===============================================================================
"""
