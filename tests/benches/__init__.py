"""Virtual test benches: shaken beams by models other than the package's, with sensors.

They judge what the package says of records: nothing of its dynamics is used here. Contacts are
compliant (a penalty with a dashpot, Hunt and Crossley's law), the motion is integrated with small
equal steps and no events, filters are SciPy's.

==================  ==============================================================================
module              idea
==================  ==============================================================================
:mod:`.system`      modes on a shaken base, with contacts, springs and friction on top of them
:mod:`.integrator`  Runge-Kutta steps of such a system in C
:mod:`.lumped`      two masses, a bonded one, and a bonded one in a rattling clamp
:mod:`.beam`        an Euler-Bernoulli beam of finite elements with a through-width delamination
:mod:`.restitution` what a contact law makes of a closing speed, in closed form
:mod:`.excitation`  what the base does: swept, stepped, random
:mod:`.sensors`     bandwidth, gain, delay, noise, sampling
:mod:`.bench`       a system, an excitation and sensors: a record
:mod:`.recipe`      random beams, with the truth about each and a guess of it
:mod:`.strikers`    sound beams that something strikes or kinks: stops, cracks, parts, bearings
:mod:`.verdicts`    rates of verdicts on random beams
:mod:`.plans`       plans of tests, followed to the letter
:mod:`.intervals`   whether intervals of fits contain the truth
:mod:`.lines`       a line of JSON for each case, so that a run resumes
:mod:`.tutorial`    the CSV files of the manual
==================  ==============================================================================
"""
