"""The explicit Runge-Kutta formula of order 8 with 12 stages by Dormand and Prince.

With error estimates of order 5 and 3.

E. Hairer, S. P. Norsett and G. Wanner, Solving Ordinary Differential Equations I, 2nd edition,
section II.10 (DOP853). Written out, because a compiled kernel cannot look into a table by an index
that it computes: each function is a sum over rates of change of state ``s``.
"""

from .memory import RATES, STATES

NODE_1 = 0.05260015195876773
NODE_2 = 0.0789002279381516
NODE_3 = 0.1183503419072274
NODE_4 = 0.2816496580927726
NODE_5 = 0.3333333333333333
NODE_6 = 0.25
NODE_7 = 0.3076923076923077
NODE_8 = 0.6512820512820513
NODE_9 = 0.6
NODE_10 = 0.8571428571428571
NODE_11 = 1.0
K0 = RATES
K1 = RATES + 1 * STATES
K2 = RATES + 2 * STATES
K3 = RATES + 3 * STATES
K4 = RATES + 4 * STATES
K5 = RATES + 5 * STATES
K6 = RATES + 6 * STATES
K7 = RATES + 7 * STATES
K8 = RATES + 8 * STATES
K9 = RATES + 9 * STATES
K10 = RATES + 10 * STATES
K11 = RATES + 11 * STATES


def slope_1(m, s):
    """Return the mean rate of state ``s`` up to stage 1."""
    return 0.05260015195876773 * m[K0 + s]


def slope_2(m, s):
    """Return the mean rate of state ``s`` up to stage 2."""
    return 0.0197250569845379 * m[K0 + s] + 0.0591751709536137 * m[K1 + s]


def slope_3(m, s):
    """Return the mean rate of state ``s`` up to stage 3."""
    return 0.02958758547680685 * m[K0 + s] + 0.08876275643042054 * m[K2 + s]


def slope_4(m, s):
    """Return the mean rate of state ``s`` up to stage 4."""
    return (
        0.2413651341592667 * m[K0 + s]
        + -0.8845494793282861 * m[K2 + s]
        + 0.924834003261792 * m[K3 + s]
    )


def slope_5(m, s):
    """Return the mean rate of state ``s`` up to stage 5."""
    return (
        0.037037037037037035 * m[K0 + s]
        + 0.17082860872947386 * m[K3 + s]
        + 0.12546768756682242 * m[K4 + s]
    )


def slope_6(m, s):
    """Return the mean rate of state ``s`` up to stage 6."""
    return (
        0.037109375 * m[K0 + s]
        + 0.17025221101954405 * m[K3 + s]
        + 0.06021653898045596 * m[K4 + s]
        + -0.017578125 * m[K5 + s]
    )


def slope_7(m, s):
    """Return the mean rate of state ``s`` up to stage 7."""
    return (
        0.03709200011850479 * m[K0 + s]
        + 0.17038392571223998 * m[K3 + s]
        + 0.10726203044637328 * m[K4 + s]
        + -0.015319437748624402 * m[K5 + s]
        + 0.008273789163814023 * m[K6 + s]
    )


def slope_8(m, s):
    """Return the mean rate of state ``s`` up to stage 8."""
    return (
        0.6241109587160757 * m[K0 + s]
        + -3.3608926294469414 * m[K3 + s]
        + -0.868219346841726 * m[K4 + s]
        + 27.59209969944671 * m[K5 + s]
        + 20.154067550477894 * m[K6 + s]
        + -43.48988418106996 * m[K7 + s]
    )


def slope_9(m, s):
    """Return the mean rate of state ``s`` up to stage 9."""
    return (
        0.47766253643826434 * m[K0 + s]
        + -2.4881146199716677 * m[K3 + s]
        + -0.590290826836843 * m[K4 + s]
        + 21.230051448181193 * m[K5 + s]
        + 15.279233632882423 * m[K6 + s]
        + -33.28821096898486 * m[K7 + s]
        + -0.020331201708508627 * m[K8 + s]
    )


def slope_10(m, s):
    """Return the mean rate of state ``s`` up to stage 10."""
    return (
        -0.9371424300859873 * m[K0 + s]
        + 5.186372428844064 * m[K3 + s]
        + 1.0914373489967295 * m[K4 + s]
        + -8.149787010746927 * m[K5 + s]
        + -18.52006565999696 * m[K6 + s]
        + 22.739487099350505 * m[K7 + s]
        + 2.4936055526796523 * m[K8 + s]
        + -3.0467644718982196 * m[K9 + s]
    )


def slope_11(m, s):
    """Return the mean rate of state ``s`` up to stage 11."""
    return (
        2.273310147516538 * m[K0 + s]
        + -10.53449546673725 * m[K3 + s]
        + -2.0008720582248625 * m[K4 + s]
        + -17.9589318631188 * m[K5 + s]
        + 27.94888452941996 * m[K6 + s]
        + -2.8589982771350235 * m[K7 + s]
        + -8.87285693353063 * m[K8 + s]
        + 12.360567175794303 * m[K9 + s]
        + 0.6433927460157636 * m[K10 + s]
    )


def slope(m, s):
    """Return the mean rate of state ``s`` over the whole sub-step, order 8."""
    return (
        0.054293734116568765 * m[K0 + s]
        + 4.450312892752409 * m[K5 + s]
        + 1.8915178993145003 * m[K6 + s]
        + -5.801203960010585 * m[K7 + s]
        + 0.3111643669578199 * m[K8 + s]
        + -0.1521609496625161 * m[K9 + s]
        + 0.20136540080403034 * m[K10 + s]
        + 0.04471061572777259 * m[K11 + s]
    )


def deviation_5(m, s):
    """Return the difference of :func:`slope` to a formula of order 5."""
    return (
        0.01312004499419488 * m[K0 + s]
        + -1.2251564463762044 * m[K5 + s]
        + -0.4957589496572502 * m[K6 + s]
        + 1.6643771824549864 * m[K7 + s]
        + -0.35032884874997366 * m[K8 + s]
        + 0.3341791187130175 * m[K9 + s]
        + 0.08192320648511571 * m[K10 + s]
        + -0.022355307863886294 * m[K11 + s]
    )


def deviation_3(m, s):
    """Return the difference of :func:`slope` to a formula of order 3."""
    return (
        -0.18980075407240762 * m[K0 + s]
        + 4.450312892752409 * m[K5 + s]
        + 1.8915178993145003 * m[K6 + s]
        + -5.801203960010585 * m[K7 + s]
        + -0.4226823213237919 * m[K8 + s]
        + -0.1521609496625161 * m[K9 + s]
        + 0.20136540080403034 * m[K10 + s]
        + 0.02265179219836082 * m[K11 + s]
    )
