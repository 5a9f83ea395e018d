"""The minimax problems of crates/opt/tests/literature once more, in NumPy, for SciPy.

Each: name -> (start, functions, absolute, linear rows (a, low, high), lower, upper). Functions take complex
numbers, so that derivatives come by complex step, exact as ours are. Sources: see the Rust files.
"""

import numpy as np

INF = np.inf


def unit_row(n, **terms):
    row = np.zeros(n)
    for key, value in terms.items():
        row[int(key[1:]) - 1] = value
    return row


def cb2(x):
    return [x[0] ** 2 + x[1] ** 4, (2 - x[0]) ** 2 + (2 - x[1]) ** 2, 2 * np.exp(x[1] - x[0])]


def spiral(x):
    square = x[0] ** 2 + x[1] ** 2
    r = np.sqrt(square)
    return [
        (x[0] - r * np.cos(r)) ** 2 + 0.005 * square,
        (x[1] - r * np.sin(r)) ** 2 + 0.005 * square,
    ]


def rosen_suzuki(x):
    a, b, c, d = x
    f = a * a + b * b + 2 * c * c + d * d - 5 * (a + b) - 21 * c + 7 * d
    g1 = a * a + b * b + c * c + d * d + a - b + c - d - 8
    g2 = a * a + 2 * b * b + c * c + 2 * d * d - a - d - 10
    g3 = a * a + b * b + c * c + 2 * a - b - d - 5
    return [f, f + 10 * g1, f + 10 * g2, f + 10 * g3]


T_PBC3 = np.linspace(0, 10, 21)
Y_PBC3 = (
    0.15 * np.exp(-T_PBC3)
    + np.exp(-5 * T_PBC3) / 52
    - np.exp(-2 * T_PBC3) * (3 * np.sin(2 * T_PBC3) + 11 * np.cos(2 * T_PBC3)) / 65
)


def pbc3(x):
    return x[2] / x[1] * np.exp(-x[0] * T_PBC3) * np.sin(x[1] * T_PBC3) - Y_PBC3


U_KOWALIK = np.array([4, 2, 1, 0.5, 0.25, 0.167, 0.125, 0.1, 0.0833, 0.0714, 0.0625])
Y_KOWALIK = np.array(
    [0.1957, 0.1947, 0.1735, 0.16, 0.0844, 0.0627, 0.0456, 0.0342, 0.0323, 0.0235, 0.0246]
)


def kowalik_osborne(x):
    u = U_KOWALIK
    return Y_KOWALIK - x[0] * u * (u + x[1]) / ((u + x[2]) * u + x[3])


T_DAVIDON = 0.2 * np.arange(1, 21)


def davidon_2(x):
    t = T_DAVIDON
    return (x[0] + x[1] * t - np.exp(t)) ** 2 + (x[2] + x[3] * np.sin(t) - np.cos(t)) ** 2


T_OET5 = np.linspace(0.25, 1, 21)


def oet5(x):
    t = T_OET5
    return x[3] - ((x[0] * t + x[1]) * t + x[2]) ** 2 - np.sqrt(t)


T_EXP = np.linspace(-1, 1, 21)


def rational_exp(x):
    t = T_EXP
    return (x[0] + t * x[1]) / (1 + t * (x[2] + t * (x[3] + t * x[4]))) - np.exp(t)


T_EVD = 0.1 * np.arange(51)
Y_EVD = (
    0.5 * np.exp(-T_EVD)
    - np.exp(-2 * T_EVD)
    + 0.5 * np.exp(-3 * T_EVD)
    + 1.5 * np.exp(-1.5 * T_EVD) * np.sin(7 * T_EVD)
    + np.exp(-2.5 * T_EVD) * np.sin(5 * T_EVD)
)


def evd61(x):
    t = T_EVD
    return (
        x[0] * np.exp(-x[1] * t) * np.cos(x[2] * t + x[3]) + x[4] * np.exp(-x[5] * t) - Y_EVD
    )


Y_FILTER = np.concatenate(
    [
        0.01 * np.arange(6),
        0.07 + 0.03 * np.arange(14),
        [0.5],
        0.54 + 0.03 * np.arange(14),
        0.95 + 0.01 * np.arange(6),
    ]
)
C_FILTER, S_FILTER = np.cos(np.pi * Y_FILTER), np.sin(np.pi * Y_FILTER)


def filter_(x):
    def q(a, b):
        return (a + (1 + b) * C_FILTER) ** 2 + ((1 - b) * S_FILTER) ** 2

    gain = np.sqrt(q(x[0], x[1]) / q(x[2], x[3])) * np.sqrt(q(x[4], x[5]) / q(x[6], x[7]))
    return x[8] * gain - np.abs(1 - 2 * Y_FILTER)


def hs113(x):
    f = (
        x[0] ** 2 + x[1] ** 2 + x[0] * x[1] - 14 * x[0] - 16 * x[1] + (x[2] - 10) ** 2
        + 4 * (x[3] - 5) ** 2 + (x[4] - 3) ** 2 + 2 * (x[5] - 1) ** 2 + 5 * x[6] ** 2
        + 7 * (x[7] - 11) ** 2 + 2 * (x[8] - 10) ** 2 + (x[9] - 7) ** 2 + 45
    )  # fmt: skip
    curved = [
        3 * (x[0] - 2) ** 2 + 4 * (x[1] - 3) ** 2 + 2 * x[2] ** 2 - 7 * x[3] - 120,
        5 * x[0] ** 2 + 8 * x[1] + (x[2] - 6) ** 2 - 2 * x[3] - 40,
        0.5 * (x[0] - 8) ** 2 + 2 * (x[1] - 4) ** 2 + 3 * x[4] ** 2 - x[5] - 30,
        x[0] ** 2 + 2 * (x[1] - 2) ** 2 - 2 * x[0] * x[1] + 14 * x[4] - 6 * x[5],
        6 * x[1] - 3 * x[0] + 12 * (x[8] - 8) ** 2 - 7 * x[9],
    ]
    linear = [
        4 * x[0] + 5 * x[1] - 3 * x[6] + 9 * x[7] - 105,
        10 * x[0] - 8 * x[1] - 17 * x[6] + 2 * x[7],
        2 * x[1] - 8 * x[0] + 5 * x[8] - 2 * x[9] - 12,
    ]
    return f, curved, linear


def wong2(x):
    f, curved, linear = hs113(x)
    return [f] + [f + 10 * g for g in curved + linear]


def wong2_linear(x):
    f, curved, _ = hs113(x)
    return [f] + [f + 10 * g for g in curved]


WONG_START = [2, 3, 5, 5, 1, 2, 7, 3, 6, 10]
WONG_ROWS = [
    (unit_row(10, x1=4, x2=5, x7=-3, x8=9), -INF, 105),
    (unit_row(10, x1=10, x2=-8, x7=-17, x8=2), -INF, 0),
    (unit_row(10, x1=-8, x2=2, x9=5, x10=-2), -INF, 12),
]


def mad1(x):
    return [x[0] ** 2 + x[1] ** 2 + x[0] * x[1] - 1, np.sin(x[0]), -np.cos(x[1])]


def mad4(x):
    return [-np.exp(x[0] - x[1]), np.sinh(x[0] - 1) - 1, -np.log(x[1]) - 1]


def pentagon(x):
    pairs = [(0, 2), (2, 4), (4, 0)]
    return [-np.sqrt((x[i] - x[j]) ** 2 + (x[i + 1] - x[j + 1]) ** 2) for i, j in pairs]


PENTAGON_ROWS = []
for point in range(3):
    for side in range(5):
        row = np.zeros(6)
        row[2 * point] = np.sin(2 * np.pi * side / 5)
        row[2 * point + 1] = np.cos(2 * np.pi * side / 5)
        PENTAGON_ROWS.append((row, -INF, 1.0))

WAVES = 2 * np.pi * np.sin(np.radians(8.5 + 0.5 * np.arange(1, 164)))
ANTENNA_ROWS = [(unit_row(7, **{f"x{i}": -1, f"x{i + 1}": 1}), 0.4, INF) for i in range(1, 7)]
ANTENNA_ROWS.append((unit_row(7, x4=-1, x6=1), 1.0, 1.0))


def antenna(x):
    return (1 + 2 * np.cos(np.outer(WAVES, x)).sum(1)) / 15


I_POLAK = np.arange(1, 12)


def polak3(x):
    return [
        ((I_POLAK + k - 1) * np.exp((x - np.sin(2 * I_POLAK + k - 3)) ** 2)).sum()
        for k in range(1, 11)
    ]


def matlab_page(x):
    return [
        2 * x[0] ** 2 + x[1] ** 2 - 48 * x[0] - 40 * x[1] + 304,
        -x[0] ** 2 - 3 * x[1] ** 2,
        x[0] + 3 * x[1] - 18,
        -x[0] - x[1],
        x[0] + x[1] - 8,
    ]


def case(start, functions, absolute=False, rows=(), lower=None, upper=None):
    n = len(start)
    return {
        "start": np.array(start, float),
        "functions": lambda x: np.asarray(functions(x)),
        "absolute": absolute,
        "rows": list(rows),
        "lower": np.full(n, -INF) if lower is None else np.array(lower),
        "upper": np.full(n, INF) if upper is None else np.array(upper),
    }


PROBLEMS = {
    "CB2": case([2, 2], cb2),
    "SPIRAL": case([1.41831, -4.79462], spiral),
    "RosenSuzuki": case([0] * 4, rosen_suzuki),
    "PBC3": case([1] * 3, pbc3, True),
    "KowalikOsborne": case([0.25, 0.39, 0.415, 0.39], kowalik_osborne, True),
    "Davidon2": case([25, 5, -5, -1], davidon_2, True),
    "OET5": case([1] * 4, oet5, True),
    "EXP": case([0.5, 0, 0, 0, 0], rational_exp, True),
    "EVD61": case([2, 2, 7, 0, -2, 1], evd61, True),
    "Filter": case([0, 1, 0, -0.15, 0, -0.68, 0, -0.72, 0.37], filter_, True),
    "Wong2": case(WONG_START, wong2),
    "Wong2-LC": case(WONG_START, wong2_linear, rows=WONG_ROWS),
    "MAD1": case([1, 2], mad1, rows=[(np.array([1.0, 1.0]), 0.5, INF)]),
    "MAD4": case(
        [-1, 0.01], mad4, rows=[(np.array([0.05, -1.0]), -0.5, INF)], lower=[-INF, 0.01]
    ),
    "PENTAGON": case([-1, 0, 0, -1, 1, 0], pentagon, rows=PENTAGON_ROWS),
    "MAD6": case(
        0.5 * np.arange(1, 8),
        antenna,
        True,
        ANTENNA_ROWS,
        lower=[0.4] + [-INF] * 5 + [3.5],
        upper=[INF] * 6 + [3.5],
    ),
    "Polak3": case([1] * 11, polak3),
    "MATLAB-doc": case([0.1, 0.1], matlab_page),
}
