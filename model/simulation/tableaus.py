"""The Runge–Kutta pairs: what their stages weigh, and their dense output."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np


class Tableau(NamedTuple):
    """An embedded explicit Runge–Kutta pair whose last stage is the first of the next step ("first same as last")."""

    order: int
    stages: int  # with the last, at the new state
    reach: float  # stable for h λ from −reach to 0
    time: np.ndarray  # (7,) of the stages, in steps
    stage: np.ndarray  # (7, 6) what the stages before weigh in the state of each; the last of them is the new state
    error: np.ndarray  # (7,) weights of the estimated error
    dense: np.ndarray  # (7,) weights of the quartic part of the dense output; without it, cubic Hermite


# Dormand & Prince 5(4) and its dense output, from Hairer, Nørsett & Wanner, "Solving ODEs I", tables II.5.2 and II.6
DORMAND_PRINCE = Tableau(
    order=5,
    stages=7,
    reach=3.3,
    time=np.array([0.0, 1 / 5, 3 / 10, 4 / 5, 8 / 9, 1.0, 1.0]),
    stage=np.array(
        [
            [0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            [1 / 5, 0.0, 0.0, 0.0, 0.0, 0.0],
            [3 / 40, 9 / 40, 0.0, 0.0, 0.0, 0.0],
            [44 / 45, -56 / 15, 32 / 9, 0.0, 0.0, 0.0],
            [19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729, 0.0, 0.0],
            [9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656, 0.0],
            [35 / 384, 0.0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84],
        ]
    ),
    error=np.array([71 / 57600, 0.0, -71 / 16695, 71 / 1920, -17253 / 339200, 22 / 525, -1 / 40]),
    dense=np.array(
        [
            -12715105075 / 11282082432,
            0.0,
            87487479700 / 32700410799,
            -10690763975 / 1880347072,
            701980252875 / 199316789632,
            -1453857185 / 822651844,
            69997945 / 29380423,
        ]
    ),
)

# Order 4(3) in five evaluations a step, found for this project: the contacts' and dampers' eigenvalues lie along the
# negative real axis (to about −370 1/s for the paper's vehicle) and, not accuracy, bound the steps of Dormand–Prince,
# which is stable to h λ = −3.3 in six evaluations. Here the stability polynomial's fifth coefficient is 1/218, which
# makes it stable to −5.1 (|R| below 0.33 from −2 to −4.6) and to ±3.2 along the imaginary axis; what this leaves free
# makes the other coefficients of the leading error small. The error's weights satisfy the conditions of order three,
# respond least to stiff modes, and are scaled so that a tolerance gives loads about as exact as it did before.
STRETCHED = Tableau(
    order=4,
    stages=6,
    reach=5.1,
    time=np.array([0.0, 0.2546496372109527, 0.6296352738329648, 0.03315519741332701, 0.9633427116723224, 1.0, 0.0]),
    stage=np.array(
        [
            [0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            [0.2546496372109527, 0.0, 0.0, 0.0, 0.0, 0.0],
            [-0.2500617678616517, 0.8796970416946165, 0.0, 0.0, 0.0, 0.0],
            [0.21742414625252235, -0.3543772189168813, 0.17010827007768595, 0.0, 0.0, 0.0],
            [0.006012796028761913, -0.8004980680593213, 0.9659101866749482, 0.7919177970279336, 0.0, 0.0],
            [-0.04870703601476091, 0.28117718804499864, 0.438499645274781, 0.17702383478384145, 0.15200636791113986, 0],
            [0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        ]
    ),
    error=1.4
    * np.array(
        [
            -0.0017162295794239991,
            0.007941195768782132,
            -0.004320763869619826,
            -0.0022320638515292745,
            -0.012123802026682326,
            0.012451663558473288,
            0.0,
        ]
    ),
    dense=np.zeros(7),
)
