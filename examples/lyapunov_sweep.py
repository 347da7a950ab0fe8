"""Largest Lyapunov exponents along a sweep: each response is the one that the sweep found."""

import numpy as np

from orchestrate import Structure, lyapunov, plot, sweep
from orchestrate.show import figure_files

paper = Structure.nondimensional(e=0.7, D=0.005)
eta = np.arange(2.5, 3.8, 0.02)

responses = sweep(paper, eta=eta)
found = lyapunov(paper, eta=eta, start=responses, periods=500)

chaotic = found.eta[found.verdict == 1].values
print(f"chaotic at {len(chaotic)} of {len(eta)} frequency ratios, first at {chaotic[0]:.2f}")
figure_files.save(plot(found), "exponents")  # exponents.png
