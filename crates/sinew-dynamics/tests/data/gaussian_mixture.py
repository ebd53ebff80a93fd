"""Writes gaussian_mixture.json: EM of scikit-learn from a fixed start, for a fixed number of iterations.

    pip install numpy scikit-learn
    python gaussian_mixture.py > gaussian_mixture.json
"""

import json
import sys
import warnings

import numpy as np
import sklearn
from sklearn.mixture import GaussianMixture

ITERATIONS = 30
RIDGE = 1e-6

rng = np.random.default_rng(20070101)
groups = [
    ([0.0, 0.0, 0.0], [[1.0, 0.5, 0.0], [0.5, 1.0, 0.2], [0.0, 0.2, 0.5]], 50),
    ([2.0, 1.0, -1.0], [[0.5, -0.2, 0.1], [-0.2, 0.4, 0.0], [0.1, 0.0, 0.3]], 40),
    ([-1.0, 2.0, 1.0], [[0.3, 0.0, 0.0], [0.0, 0.8, 0.3], [0.0, 0.3, 0.6]], 31),
]
points = np.vstack([rng.multivariate_normal(m, c, n) for m, c, n in groups]).round(6)
start = {
    "weights": [0.5, 0.2, 0.3],
    "means": [[0.5, 0.5, 0.5], [1.0, 0.0, -2.0], [-2.0, 1.0, 0.0]],
    "covariances": [np.diag(d).tolist() for d in ([1.0, 2.0, 1.5], [2.0, 1.0, 1.0], [1.0, 1.0, 3.0])],
}
mixture = GaussianMixture(
    3,
    tol=0.0,
    max_iter=ITERATIONS,
    reg_covar=RIDGE * np.trace(np.cov(points.T, bias=True)) / points.shape[1],
    weights_init=start["weights"],
    means_init=start["means"],
    precisions_init=np.linalg.inv(np.array(start["covariances"])),
)
warnings.simplefilter("ignore")
mixture.fit(points)
assert mixture.n_iter_ == ITERATIONS
json.dump(
    {
        "made_with": f"scikit-learn {sklearn.__version__}",
        "iterations": ITERATIONS,
        "ridge": RIDGE,
        "points": points.tolist(),
        "start": start,
        "weights": mixture.weights_.tolist(),
        "means": mixture.means_.tolist(),
        "covariances": mixture.covariances_.tolist(),
        "log_likelihood": float(mixture.score(points) * len(points)),
    },
    sys.stdout,
)
print()
