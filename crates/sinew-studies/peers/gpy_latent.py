"""What GPy says of the same latent models, and what LAPACK costs: numbers that tests and pages of sinew hold.

Needs Python 3.11 with numpy<2, scipy<1.12, matplotlib<3.9 and GPy 1.13 or later; `python gpy_latent.py oil DATA` for objectives,
trained objectives and errors of nearest neighbours (DATA: the folder of oil_flow), `python gpy_latent.py speed` for times on one thread.
"""

import os
import sys
import time

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(name, "1")

import GPy
import numpy as np
import scipy
from scipy.linalg import lapack


def model(rows, latents=None):
    kernel = GPy.kern.RBF(2) + GPy.kern.Bias(2) + GPy.kern.White(2)
    return GPy.models.GPLVM(rows, 2, X=latents, kernel=kernel)


def neighbours(latents, classes):
    squares = ((latents[:, None] - latents[None]) ** 2).sum(-1)
    np.fill_diagonal(squares, np.inf)
    return int((classes[squares.argmin(1)] != classes).sum())


def oil(folder):
    table = np.loadtxt(os.path.join(folder, "trn.csv"), delimiter=",", skiprows=1)
    for count in (100, 400):
        classes, rows = table[:count, 0], table[:count, 1:]
        rows = rows - rows.mean(0)
        n = np.arange(count)
        gp = model(rows, np.stack([np.sin(0.7 * n), np.cos(1.3 * n)], 1))
        gp.kern.rbf.variance, gp.kern.rbf.lengthscale = 0.3, 0.8
        gp.kern.bias.variance, gp.kern.white.variance = 0.05, 0.01
        gp.likelihood.variance = 0.002
        print(f"first {count}: log likelihood at stored parameters {gp.log_likelihood():.15g}")
        gp = model(rows)
        scores = np.array(gp.X)
        print(f"first {count}: nearest-neighbour errors of principal components {neighbours(scores, classes)}")
        gp.optimize("lbfgsb", max_iters=10000)
        print(f"first {count}: trained {float(gp.log_likelihood()):.2f}, errors {neighbours(np.array(gp.X), classes)}")


def least(function, repeats):
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        function()
        times.append(time.perf_counter() - start)
    return 1e3 * min(times)


def speed():
    draws = np.random.default_rng(1)
    print("| N | GPy, objective and gradient, ms | dpotrf, dpotri and the products with Y, ms |\n|--:|--:|--:|")
    for count in (200, 400, 1000):
        rows, latents = draws.normal(size=(count, 50)), draws.normal(size=(count, 3))
        kernel = GPy.kern.RBF(3) + GPy.kern.Bias(3) + GPy.kern.White(3)
        gp = GPy.models.GPLVM(rows, 3, X=latents, kernel=kernel)
        unknowns = gp.optimizer_array.copy()

        def whole():
            unknowns[0] += 1e-9
            gp._objective_grads(unknowns)

        squares = ((latents[:, None] - latents[None]) ** 2).sum(-1)
        gram = np.asfortranarray(np.exp(-0.5 * squares) + 0.1 * np.eye(count))

        def parts():
            factor, _ = lapack.dpotrf(gram, lower=1)
            inverse, _ = lapack.dpotri(factor, lower=1)
            weights = inverse @ rows
            weights @ weights.T

        repeats = max(5, 20000 // count)
        print(f"| {count} | {least(whole, repeats):.2f} | {least(parts, repeats):.2f} |")


if __name__ == "__main__":
    print(f"GPy {GPy.__version__}, numpy {np.__version__}, scipy {scipy.__version__}")
    if sys.argv[1:2] == ["oil"] and len(sys.argv) == 3:
        oil(sys.argv[2])
    elif sys.argv[1:] == ["speed"]:
        speed()
    else:
        sys.exit(__doc__)
