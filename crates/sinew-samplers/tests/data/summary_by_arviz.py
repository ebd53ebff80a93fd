"""Makes summary_by_arviz.json: three chains of two quantities with the summary of ArviZ 0.21.0 (numpy 2.2.6). Run: python summary_by_arviz.py > summary_by_arviz.json"""
import json
import arviz as az
import numpy as np

rng = np.random.default_rng(46)
x = rng.normal(size=(3, 60, 2))
for t in range(1, 60):
    x[:, t, 0] += 0.8 * x[:, t - 1, 0]
x[:, :, 1] = 100 * np.exp(0.5 * x[:, :, 1])
x = np.round(x, 5)
energy = np.round(rng.normal(size=(3, 60)).cumsum(axis=1), 5)
data = az.from_dict(posterior={"slow": x[:, :, 0], "skew": x[:, :, 1]}, sample_stats={"energy": energy})
table = az.summary(data, round_to="none")
columns = ["mean", "sd", "mcse_mean", "ess_bulk", "ess_tail", "r_hat"]
print(json.dumps({
    "chains": x.tolist(),
    "energy": energy.tolist(),
    "summary": {name: {column: float(table.loc[name, column]) for column in columns} for name in ["slow", "skew"]},
    "bfmi": az.bfmi(data).tolist(),
}))
