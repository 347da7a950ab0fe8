"""The model-free signs of the literature: formula, source, and what else moves them."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Indicator:
    """A number that differs between a sound structure and one whose faces open and strike."""

    long_name: str
    formula: str
    source: str  # in the literature
    moved_by: str  # what else than delamination moves it


BOVSUNOVSKY = "Bovsunovsky and Surace, Mech. Syst. Signal Process. 62-63 (2015) 129-148"
WORDEN = "Worden and Tomlinson, Nonlinearity in Structural Dynamics, IoP, 2001"
BENDAT = "Bendat and Piersol, Random Data, 4th ed., Wiley, 2010"
DYER = "Dyer and Stewart, J. Mech. Design 100 (1978) 229-235"
DELLA = "Della and Shu, Appl. Mech. Rev. 60 (2007) 1-20"
SHAW = "Shaw and Holmes, J. Sound Vib. 90 (1983) 129-155"
NAYFEH = "Nayfeh and Mook, Nonlinear Oscillations, Wiley, 1979"
PAPER = "A vibro-impacting model for the detection of delamination, Figure 2"
BAND = "rattling clamps and bolts, a sensor that is loose, overload; a bandwidth that hides impacts"

INDICATORS = {
    "order_2": Indicator(
        "order 2 over order 1",
        "rms of |A_2| over rms of |A_1|, over the windows of the sweep",
        BOVSUNOVSKY,
        "a shaker or a sensor whose characteristic is bent to one side, a clamp that opens",
    ),
    "order_3": Indicator(
        "order 3 over order 1",
        "rms of |A_3| over rms of |A_1|, over the windows of the sweep",
        WORDEN,
        "hardening or softening, friction, a sensor near the end of its range: of sound beams too",
    ),
    "order_half": Indicator(
        "order 1/2 over order 1",
        "rms of |A_1/2| over rms of |A_1|, over the windows of the sweep",
        SHAW,
        "a fast sweep: the free vibration lies at any order; a rattling clamp",
    ),
    "distortion": Indicator(
        "total harmonic distortion",
        "root of the sum of |A_n|^2, n = 2 to 5, over |A_1|, each summed over the windows",
        WORDEN,
        "all that moves orders 2 and 3, and the distortion of the shaker, which is in the box too",
    ),
    "coherence_loss": Indicator(
        "coherence loss",
        "mean of 1 - c over the lines that the box excites; c: coherence with the box",
        BENDAT,
        "noise, leakage at a light damping or in a fast sweep, a second source of vibration",
    ),
    "level_dependence": Indicator(
        "level dependence of the response",
        "rms of H' - H over rms of H, H and H' at two levels; H: response over the box",
        WORDEN,
        "hardening, friction, warming between the records. A delamination whose faces touch "
        "without gap or preload does not move it at all",
    ),
    "direction_difference": Indicator(
        "difference between up and down",
        "rms of H' - H over rms of H, H up and H' down the frequencies; H: response over the box",
        NAYFEH,
        "a fast sweep, hardening or softening, warming between the records",
    ),
    "kurtosis": Indicator(
        "kurtosis",
        "fourth moment of the acceleration over the square of the second",
        DYER,
        "every passage through a resonance: compare with the sound structure, not with 3",
    ),
    "skewness": Indicator(
        "skewness",
        "size of the third moment of the acceleration over the second one to the power 3/2",
        WORDEN,
        "a shaker or a sensor whose characteristic is bent to one side, drift",
    ),
    "kurtosis_high": Indicator(
        "kurtosis at high frequencies",
        "the kurtosis of what is above the band of the excitation and its low orders",
        DYER,
        BAND,
    ),
    "skewness_high": Indicator(
        "skewness at high frequencies",
        "the skewness of what is above the band of the excitation and its low orders",
        DYER,
        BAND,
    ),
    "sensor_difference": Indicator(
        "difference between two sensors",
        "least rms of A - g A' over rms of A, over all complex gains g; A, A': order 1 of both",
        DELLA,
        "a second mode in the band, a delay of one sensor; its gain does not move it",
    ),
    "jump_voltage_fall": Indicator(
        "fall of the jump voltage",
        "1 - U over U', the voltages at which the speed of the motor jumps, U' of the sound beam",
        PAPER,
        "a warmer motor, another friction of the box, another rate of the voltage",
    ),
    "extra_power": Indicator(
        "motor power above a sound beam's",
        "mean of P over mean of P', less 1, at the same speeds up to the jump; P': sound beam",
        PAPER,
        "a warmer motor, another damping of the box or of the clamp",
    ),
}
