"""Long computations: jobs in chunks, on all cores or a Dask cluster, stored and resumable.

======================  =========================================================================
module                  idea
======================  =========================================================================
:mod:`.job`             definition of a long computation: items, chunks, what decides its numbers
:mod:`.identity`        identity of a stored result: the question, the FMUs, the code
:mod:`.options`         keywords that all questions share
:mod:`.store`           storage of chunks and results, in memory or on disk
:mod:`.journal`         chunks on disk while a job is under way
:mod:`.array_blocks`    arrays larger than memory, block by block
:mod:`.checksum`        checksum of a result, however it is stored
:mod:`.netcdf`          NetCDF files that may come from anybody
:mod:`.formats`         export of a result: CSV, MATLAB, Excel
:mod:`.provenance`      attributes that say where a dataset comes from
:mod:`.executors`       this process, its threads, or processes of this machine
:mod:`.cluster`         the workers of a Dask scheduler, or any executor
:mod:`.bar`             progress bar
:mod:`.chunk_schedule`  chunks done, under way, guessed; what may be computed next
:mod:`.runner`          keeps the workers busy until every result is there
======================  =========================================================================
"""
