"""The laboratory: how a shaker excites the structure, and what is recorded.

========================  =========================================================================
module                    idea
========================  =========================================================================
:mod:`.pieces`            an excitation as cubic pieces, which the FMU takes exactly
:mod:`.signals`           what every excitation is, and sums of them
:mod:`.swept_sine`        a sine of moving frequency
:mod:`.stepped_sine`      a sine that settles at one frequency after the other
:mod:`.random_vibration`  a power spectral density
:mod:`.pulses`            a classical shock, and a knock on a half
:mod:`.sampled`           a record played again
:mod:`.level_control`     a sine whose level a controller holds, on a shaker
:mod:`.shake`             time histories and impacts under any of these
:mod:`.reconstruction`    what the masses do between the samples of a history
:mod:`.analog_filter`     the exact response of an analogue filter
:mod:`.sensors`           what accelerometers read of a history
:mod:`.record`            the one dataset of channels, measured or simulated
:mod:`.record_checks`     saturated, dead and identical channels, implausible units and times
:mod:`.record_of_run`     the run of a weak drive as a record
:mod:`.headings`          what files call quantities and units: headings, split; names, texts
:mod:`.columns`           which columns of a file are its channels, units that lack, lost samples
:mod:`.stated_channels`   what a user states of a file's channels, as TOML or a mapping
:mod:`.channel_table`     the columns of a file as a dataset, and the setup that is written of it
:mod:`.conversion`        velocities, displacements and voltages made accelerations
:mod:`.time_base`         rounded and uneven times made equal
:mod:`.record_csv`        columns of numbers as text
:mod:`.record_uff`        universal files
:mod:`.record_mat`        MATLAB's files
:mod:`.record_labview`    LabVIEW's files
:mod:`.record_files`      records read and written; what may come from anybody is read elsewhere
:mod:`.resonance_curve`   a measured resonance curve: amplitudes of faces over the frequency
:mod:`.curve_files`       resonance curves read from files
:mod:`.analysis`          what an analyser shows of a record
========================  =========================================================================
"""
