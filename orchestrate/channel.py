"""Fast calls on one instance: preallocated arrays, one call for many variables, one handle for a state that is saved again and again.

Only Real variables. Both FMI versions; statuses are checked by FMPy.
"""

from ctypes import byref, c_double, c_uint

from .fmu import FmuError


class Channel:
    """What a co-simulation master does with an instance, thousands of times a second.

    Parameters
    ----------
    instance : Instance
        Initialised, or about to be.
    inputs, outputs : sequence of str
        Names of the variables that :meth:`put` sets and :meth:`get` reads, in this order.
    """

    def __init__(self, instance, inputs, outputs):
        self.instance = instance
        self._fmu = instance._fmu
        self._v3 = instance.description.fmi_version.startswith("3")
        self._in = self._array(inputs)
        self._out = self._array(outputs)
        self._set, self._get, self._step = self._functions()
        save, restore, free = ("GetFMUState", "SetFMUState", "FreeFMUState") if self._v3 else ("GetFMUstate", "SetFMUstate", "FreeFMUstate")
        prefix = "fmi3" if self._v3 else "fmi2"
        self._save, self._restore, self._free = (getattr(self._fmu, prefix + name) for name in (save, restore, free))
        self._reused = not instance.description.needs_tool  # pythonfmu makes a new state each time
        self._states: dict = {}

    def _array(self, names):
        references = [self.instance.variable(name).valueReference for name in names]
        return (c_uint * len(references))(*references), len(references), (c_double * len(references))()

    def _functions(self):
        fmu, component = self._fmu, self._fmu.component
        if not self._v3:
            return fmu.fmi2SetReal, fmu.fmi2GetReal, lambda time, h: fmu.fmi2DoStep(component, time, h, 0)
        from ctypes import c_bool

        flags, last = [c_bool() for _ in range(3)], c_double()
        answers = [*map(byref, flags), byref(last)]
        return fmu.fmi3SetFloat64, fmu.fmi3GetFloat64, lambda time, h: fmu.fmi3DoStep(component, time, h, False, *answers)

    def _call(self, function, *arguments):
        """Call, with the FMU's message where it fails."""
        messages = self.instance._messages
        messages.clear()
        try:
            function(*arguments)
        except Exception as error:
            raise FmuError("; ".join(messages) or str(error)) from None

    def put(self, *values):
        """Set the first of the inputs, as many as values are given."""
        references, _, array = self._in
        count = len(values)
        array[:count] = values
        self._call(self._set, self._fmu.component, references, count, array, *([count] if self._v3 else []))

    def get(self):
        """Values of the outputs, a list of floats."""
        references, count, array = self._out
        self._call(self._get, self._fmu.component, references, count, array, *([count] if self._v3 else []))
        return array[:]

    def step(self, time, h):
        """One communication step of length ``h`` from ``time``, s."""
        self._call(self._step, time, h)

    def save(self, level=0):
        """Keep the present state, in a place of its own for each ``level``."""
        handle = self._states.get(level)
        if handle is None:
            handle = self._states[level] = self._fmu_handle()
        elif not self._reused:
            self._call(self._free, self._fmu.component, byref(handle))
        self._call(self._save, self._fmu.component, byref(handle))

    def restore(self, level=0):
        """Back to the state kept."""
        self._call(self._restore, self._fmu.component, self._states[level])

    @staticmethod
    def _fmu_handle():
        from ctypes import c_void_p

        return c_void_p()

    def close(self):
        """Free the states kept."""
        for handle in self._states.values():
            self._call(self._free, self._fmu.component, byref(handle))
        self._states.clear()
