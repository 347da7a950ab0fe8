"""What an analyser shows of a record, measured or simulated.

======================  ===========================================================================
module                  idea
======================  ===========================================================================
:mod:`.channels`        the channels of a record, checked; its overlapping segments; labels
:mod:`.frf`             frequency response functions over the box's acceleration, and coherence
:mod:`.psd`             power spectral densities
:mod:`.orders`          amplitude and phase of the orders of a swept sine
:mod:`.harmonics`       orders over the first one, and total harmonic distortion
:mod:`.spectrogram`     amplitude spectra over the time
:mod:`.shock_spectrum`  the largest response of single oscillators
:mod:`.density`         how often which acceleration occurs, skewness and kurtosis
======================  ===========================================================================
"""
