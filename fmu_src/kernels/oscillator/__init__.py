"""The vibro-impact kernel: two masses in a shaken box, exact between and through impacts.

Standard library only, relative imports only, plain floats in one flat memory: the same source runs
in any Python 3.9+ and translates to C as it stands. Only ``+ - * /``, ``sqrt`` and ``floor``
touch the numbers, which IEEE 754 fixes to the last bit, so every build of it on every machine gives
the same bits.

Non-dimensional time ``tau = omega t`` (4) throughout; displacements stay in metres, because the
equations are linear in the amplitude: the paper's ``xi`` (3) is the displacement over ``a eta^2``.

========================  =====================================================================
module                    the paper's equations
========================  =====================================================================
:mod:`.memory`            the flat memory: what stands in which slot
`..numerics`              sine, cosine and exponential function, the same bits everywhere
:mod:`.parameters`        m, k, d <-> mu, kappa, D, omega_i                            (2) (7) (8)
:mod:`.excitation`        the box's motion over one step, right-hand side of            (6)
:mod:`.secular`           amplitudes that grow, at a resonance without damping              (11)
:mod:`.response`          closed-form oscillator                                   (9)-(11)
:mod:`.nodes`             the same by phasors, from node to node of a grid                  (10)
:mod:`.series`            short flights, relative to the gap itself                    (6)
:mod:`.event_function`    gap (13) and contact force (18) as one kind of signal, and its bounds
:mod:`.hermite`           a quintic between two nodes, and what it may miss         (13) (19)
:mod:`.roots`             certified first root                                      (13) (19)
:mod:`.impact`            restitution, end of chattering                          (15)-(17)
:mod:`.contact`           contact force, the side on which a state begins         (18)-(20)
:mod:`.motion`            the states and their sequence                    (1) (4) (5) (12) (14)
:mod:`.motion_signal`     displacements and accelerations as signals                          (6)
:mod:`.maximum`           the largest values of gap, displacements and accelerations over a step
:mod:`.outputs`           what an importer sees at a communication point
:mod:`.rates`             time derivatives of the outputs: the entry point ``differentiate``  (6)
:mod:`.stepper`           the other entry points: ``initialize``, ``advance`` and ``coast``
========================  =====================================================================
"""
