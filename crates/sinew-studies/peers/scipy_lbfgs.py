"""What scipy's L-BFGS-B reaches on the standard problems of sinew-latent's tests, and on a GPLVM.

    python3 -m pip install scipy        # into an environment of its own; this script installs nothing
    python3 crates/sinew-studies/peers/scipy_lbfgs.py  # prints the rows

The rows are those of crates/sinew-latent/tests/program/standard_problems/reached_by_scipy.rs: name and dimension (of the
GPLVM the starts in turn), value at the start, value reached, evaluations.

The residuals are written here a second time, from Moré, Garbow & Hillstrom (1981); their derivatives are complex steps,
Im r(x + ih e) / h, exact to rounding. Memory is 10, as in ours; it runs until the gradient is below 1e-12 or no lower
value is found.
"""

import platform

import numpy as np
import scipy
from scipy.optimize import minimize

GAUSSIAN = [0.0009, 0.0044, 0.0175, 0.0540, 0.1295, 0.2420, 0.3521, 0.3989, 0.3521, 0.2420, 0.1295, 0.0540, 0.0175,
            0.0044, 0.0009]
BARD = [0.14, 0.18, 0.22, 0.25, 0.29, 0.32, 0.35, 0.39, 0.37, 0.58, 0.73, 0.96, 1.34, 2.10, 4.39]
MEYER = [34780, 28610, 23650, 19630, 16370, 13720, 11540, 9744, 8261, 7030, 6005, 5147, 4427, 3820, 3307, 2872]
KOWALIK = [0.1957, 0.1947, 0.1735, 0.1600, 0.0844, 0.0627, 0.0456, 0.0342, 0.0323, 0.0235, 0.0246]
OSBORNE = np.array([4, 2, 1, 0.5, 0.25, 0.167, 0.125, 0.1, 0.0833, 0.0714, 0.0625])


def counted(last):
    return np.arange(1, last + 1)


def join(*parts):
    return np.concatenate([np.atleast_1d(part) for part in parts])


def helical_valley(x):
    turns = np.arctan(x[1] / x[0]) / (2 * np.pi) + (0.5 if x[0].real < 0 else 0)
    return join(10 * (x[2] - 10 * turns), 10 * (np.sqrt(x[0] ** 2 + x[1] ** 2) - 1), x[2])


def bard(x):
    u = counted(15)
    return np.array(BARD) - (x[0] + u / ((16 - u) * x[1] + np.minimum(u, 16 - u) * x[2]))


def gulf(x):
    t = counted(99) / 100
    offset = 25 + (-50 * np.log(t)) ** (2 / 3) - x[1]
    offset = np.where(offset.real < 0, -offset, offset)
    return np.exp(-offset ** x[2] / x[0]) - t


def box_three(x):
    t = counted(10) / 10
    return np.exp(-t * x[0]) - np.exp(-t * x[1]) - x[2] * (np.exp(-t) - np.exp(-10 * t))


def wood(x):
    return join(10 * (x[1] - x[0] ** 2), 1 - x[0], np.sqrt(90) * (x[3] - x[2] ** 2), 1 - x[2],
                np.sqrt(10) * (x[1] + x[3] - 2), (x[1] - x[3]) / np.sqrt(10))


def kowalik_osborne(x):
    u = OSBORNE
    return np.array(KOWALIK) - x[0] * (u**2 + u * x[1]) / (u**2 + u * x[2] + x[3])


def brown_dennis(x):
    t = counted(20) / 5
    return (x[0] + t * x[1] - np.exp(t)) ** 2 + (x[2] + x[3] * np.sin(t) - np.cos(t)) ** 2


def biggs(x):
    t = counted(13) / 10
    y = np.exp(-t) - 5 * np.exp(-10 * t) + 3 * np.exp(-4 * t)
    return x[2] * np.exp(-t * x[0]) - x[3] * np.exp(-t * x[1]) + x[5] * np.exp(-t * x[4]) - y


def rosenbrock(x):
    return join(10 * (x[1::2] - x[::2] ** 2), 1 - x[::2])


def powell_singular(x):
    a, b, c, d = x[::4], x[1::4], x[2::4], x[3::4]
    return join(a + 10 * b, np.sqrt(5) * (c - d), (b - 2 * c) ** 2, np.sqrt(10) * (a - d) ** 2)


def watson(x):
    t, powers = counted(29) / 29, np.arange(len(x))
    sums = t[:, None] ** powers @ x
    slopes = (powers[1:] * t[:, None] ** powers[:-1]) @ x[1:]
    return join(slopes - sums**2 - 1, x[0], x[1] - x[0] ** 2 - 1)


def penalty_one(x):
    return join(np.sqrt(1e-5) * (x - 1), np.sum(x**2) - 0.25)


def penalty_two(x):
    n = len(x)
    steps = np.exp(counted(n) / 10)
    pairs = np.exp(x[1:] / 10) + np.exp(x[:-1] / 10) - steps[1:] - steps[:-1]
    singles = np.exp(x[1:] / 10) - np.exp(-0.1)
    return join(x[0] - 0.2, np.sqrt(1e-5) * pairs, np.sqrt(1e-5) * singles, np.sum((n - np.arange(n)) * x**2) - 1)


def variably_dimensioned(x):
    total = np.sum(counted(len(x)) * (x - 1))
    return join(x - 1, total, total**2)


def trigonometric(x):
    return len(x) - np.sum(np.cos(x)) + counted(len(x)) * (1 - np.cos(x)) - np.sin(x)


def brown_almost_linear(x):
    return join(x[:-1] + np.sum(x) - (len(x) + 1), np.prod(x) - 1)


def discrete_boundary_value(x):
    n = len(x)
    around = join(0, x, 0)
    return 2 * x - around[:-2] - around[2:] + (x + counted(n) / (n + 1) + 1) ** 3 / (2 * (n + 1) ** 2)


def discrete_integral(x):
    n = len(x)
    t = counted(n) / (n + 1)
    cubes = (x + t + 1) ** 3
    before = np.array([np.sum(t[: i + 1] * cubes[: i + 1]) for i in range(n)])
    after = np.array([np.sum((1 - t[i + 1 :]) * cubes[i + 1 :]) for i in range(n)])
    return x + ((1 - t) * before + t * after) / (2 * (n + 1))


def broyden_tridiagonal(x):
    around = join(0, x, 0)
    return (3 - 2 * x) * x - around[:-2] - 2 * around[2:] + 1


def broyden_banded(x):
    near = [[j for j in range(max(0, i - 5), min(len(x), i + 2)) if j != i] for i in range(len(x))]
    return x * (2 + 5 * x**2) + 1 - np.array([np.sum(x[j] * (1 + x[j])) for j in near])


def linear_full_rank(x):
    common = -0.1 * np.sum(x) - 1
    return join(x + common, np.full(20 - len(x), common))


def linear_rank_one(x):
    return counted(20) * np.sum(counted(len(x)) * x) - 1


def chebyquad(x):
    k = counted(len(x))
    polynomials = [np.ones_like(x), 2 * x - 1]
    for _ in k[1:]:
        polynomials.append(2 * (2 * x - 1) * polynomials[-1] - polynomials[-2])
    means = np.array([0.0 if i % 2 else -1 / (i**2 - 1) for i in k])
    return np.array([np.mean(p) for p in polynomials[1:]]) - means


GRID = counted(10) / 11 * (counted(10) / 11 - 1)
PROBLEMS = [
    ("2 Freudenstein–Roth", [0.5, -2], lambda x: join(-13 + x[0] + ((5 - x[1]) * x[1] - 2) * x[1],
                                                      -29 + x[0] + ((x[1] + 1) * x[1] - 14) * x[1])),
    ("3 Powell badly scaled", [0, 1], lambda x: join(1e4 * x[0] * x[1] - 1, np.exp(-x[0]) + np.exp(-x[1]) - 1.0001)),
    ("4 Brown badly scaled", [1, 1], lambda x: join(x[0] - 1e6, x[1] - 2e-6, x[0] * x[1] - 2)),
    ("5 Beale", [1, 1], lambda x: np.array([1.5, 2.25, 2.625]) - x[0] * (1 - x[1] ** counted(3))),
    ("6 Jennrich–Sampson", [0.3, 0.4], lambda x: 2 + 2 * counted(10) - np.exp(counted(10) * x[0])
     - np.exp(counted(10) * x[1])),
    ("7 helical valley", [-1, 0, 0], helical_valley),
    ("8 Bard", [1, 1, 1], bard),
    ("9 Gaussian", [0.4, 1, 0], lambda x: x[0] * np.exp(-x[1] * ((8 - counted(15)) / 2 - x[2]) ** 2 / 2)
     - np.array(GAUSSIAN)),
    ("10 Meyer", [0.02, 4000, 250], lambda x: x[0] * np.exp(x[1] / (45 + 5 * counted(16) + x[2])) - np.array(MEYER)),
    ("11 Gulf research", [5, 2.5, 0.15], gulf),
    ("12 box three-dimensional", [0, 10, 20], box_three),
    ("14 Wood", [-3, -1, -3, -1], wood),
    ("15 Kowalik–Osborne", [0.25, 0.39, 0.415, 0.39], kowalik_osborne),
    ("16 Brown–Dennis", [25, 5, -5, -1], brown_dennis),
    ("18 Biggs EXP6", [1, 2, 1, 1, 1, 1], biggs),
    ("1 Rosenbrock", [-1.2, 1], rosenbrock),
    ("13 Powell singular", [3, -1, 0, 1], powell_singular),
    ("20 Watson", [0] * 6, watson),
    ("20 Watson", [0] * 9, watson),
    ("21 extended Rosenbrock", [-1.2, 1] * 50, rosenbrock),
    ("22 extended Powell singular", [3, -1, 0, 1] * 25, powell_singular),
    ("23 penalty I", counted(4), penalty_one),
    ("23 penalty I", counted(10), penalty_one),
    ("24 penalty II", [0.5] * 4, penalty_two),
    ("24 penalty II", [0.5] * 10, penalty_two),
    ("25 variably dimensioned", 1 - counted(10) / 10, variably_dimensioned),
    ("26 trigonometric", [0.1] * 10, trigonometric),
    ("27 Brown almost linear", [0.5] * 10, brown_almost_linear),
    ("28 discrete boundary value", GRID, discrete_boundary_value),
    ("29 discrete integral equation", GRID, discrete_integral),
    ("30 Broyden tridiagonal", [-1] * 10, broyden_tridiagonal),
    ("31 Broyden banded", [-1] * 10, broyden_banded),
    ("32 linear of full rank", [1] * 10, linear_full_rank),
    ("33 linear of rank one", [1] * 10, linear_rank_one),
    ("35 Chebyquad", counted(8) / 9, chebyquad),
    ("35 Chebyquad", counted(9) / 10, chebyquad),
]


def objective(residuals):
    """Sum of squares and its gradient."""

    def evaluate(x):
        tiny = 1e-30
        with np.errstate(all="ignore"):
            value = residuals(x + 0j).real
            steps = [residuals(x + 1j * tiny * unit).imag / tiny for unit in np.eye(len(x))]
            return np.sum(value**2), 2 * np.array(steps) @ value

    return evaluate


def gplvm_rows():
    """30 rows of six columns, centred."""
    n, d = np.meshgrid(np.arange(30), np.arange(6), indexing="ij")
    rows = np.sin(0.35 * n + 0.8 * d) + 0.3 * np.cos(0.7 * n - 0.8 * d) + 0.1 * np.sin(7.3 * n * d + n)
    return rows - rows.mean(0)


def gplvm_start(size):
    """Latents on a spiral, then the logarithms of v, b, w; g stays 1."""
    n = np.arange(30)
    latents = size * (1 + 0.02 * n[:, None]) * np.stack([np.cos(0.35 * n), np.sin(0.35 * n)], 1)
    return join(latents.ravel(), 0.0, -2.0, -2.0)


def gplvm(unknowns, rows=gplvm_rows()):
    """-log p of rows and latents, and its gradient."""
    latents, (v, b, w) = unknowns[:-3].reshape(-1, 2), np.exp(unknowns[-3:])
    count, columns = rows.shape
    apart = latents[:, None] - latents[None]
    radial = v * np.exp(-0.5 * (apart**2).sum(-1))
    gram = radial + b + w * np.eye(count)
    inverse = np.linalg.inv(gram)
    weights = inverse @ rows
    value = 0.5 * (columns * np.linalg.slogdet(gram)[1] + np.sum(weights * rows) + rows.size * np.log(2 * np.pi))
    pull = 0.5 * (columns * inverse - weights @ weights.T)
    slopes = -2 * ((pull * radial)[..., None] * apart).sum(1) + latents
    parameters = [np.sum(pull * radial), b * np.sum(pull), w * np.trace(pull)]
    return value + 0.5 * np.sum(latents**2), join(slopes.ravel(), parameters)


OPTIONS = {"maxcor": 10, "ftol": 0, "gtol": 1e-12, "maxiter": 15000, "maxfun": 15000}
RUNS = [(f"{name}, n = {len(start)}", objective(residuals), start) for name, start, residuals in PROBLEMS]
RUNS += [(f"GPLVM, {size}", gplvm, gplvm_start(size)) for size in (0.5, 1.0, 2.0)]
print(f"// scipy {scipy.__version__}, numpy {np.__version__}, Python {platform.python_version()}")
for name, evaluate, start in RUNS:
    start = np.array(start, dtype=float)
    run = minimize(evaluate, start, jac=True, method="L-BFGS-B", options=OPTIONS)
    print(f'    ("{name}", {float(evaluate(start)[0])!r}, {float(run.fun)!r}, {run.nfev}),')
