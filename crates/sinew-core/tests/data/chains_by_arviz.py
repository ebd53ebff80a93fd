"""Makes chains_by_arviz.json: chains with their diagnostics by ArviZ 0.21.0 (numpy 2.2.6, scipy 1.17.1). Run: python chains_by_arviz.py > chains_by_arviz.json"""
import json
import arviz as az
import numpy as np

rng = np.random.default_rng(20)
cases = {}


def autoregressive(chains, draws, phi, shift=0.0):
    x = rng.normal(size=(chains, draws))
    for t in range(1, draws):
        x[:, t] += phi * x[:, t - 1]
    x[-1] += shift
    return x


cases["independent"] = rng.normal(size=(4, 100))
cases["slow"] = autoregressive(4, 200, 0.9)
cases["antithetic"] = autoregressive(4, 100, -0.6)
cases["one chain elsewhere"] = autoregressive(4, 100, 0.3, shift=3.0)
cases["heavy tails"] = rng.standard_cauchy(size=(4, 151))
cases["one chain of odd length"] = autoregressive(1, 75, 0.5)
cases["ties"] = rng.integers(0, 5, size=(3, 60)).astype(float)
cases["other scale"] = rng.normal(size=(4, 80)) * np.array([1.0, 1.0, 1.0, 4.0])[:, None]
cases["short"] = rng.normal(size=(2, 9))



def number(x):
    """ArviZ gives no R-hat of one chain."""
    return float(x) if np.isfinite(x) else None


out = []
for name, x in cases.items():
    x = np.round(x, 6)
    out.append({
        "name": name,
        "chains": x.tolist(),
        "rank_r_hat": number(az.rhat(x, method="rank")),
        "split_r_hat": number(az.rhat(x, method="split")),
        "bulk_ess": number(az.ess(x, method="bulk")),
        "tail_ess": number(az.ess(x, method="tail")),
        "mcse_of_mean": number(az.mcse(x, method="mean")),
        "energy_fraction": az.bfmi(x).tolist(),
    })
print(json.dumps(out))
