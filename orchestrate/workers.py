"""Worker processes that end at once, in the middle of what they do."""


def stop(pool):
    """Terminate the processes of a pool, so that its shutdown does not wait for them.

    Parameters
    ----------
    pool : concurrent.futures.ProcessPoolExecutor

    Notes
    -----
    Python before 3.11.5 waits for ever for a task in the pipe that nobody is there to read (python/cpython#94777); it ends when the reading end
    is closed, as later versions do themselves.
    """
    for process in list((getattr(pool, "_processes", None) or {}).values()):
        process.terminate()
    queue = getattr(pool, "_call_queue", None)
    if queue is not None:
        queue._reader.close()
