"""Weighted least squares with weights that spikes do not move."""

import numpy as np

from exoid.identification.estimators import Fit, ols
from exoid.regression import joint_table, stack

MAD_TO_STD = 1.4826


def mad(problem):
    """Weigh each joint by the median absolute residual of an ordinary fit."""
    values = ols(problem).solution.values
    sizes = [[] for _ in problem.r_factors]
    for kind, rows, first in problem.blocks():
        for joint in range(rows.tau.shape[1]):
            _, table = joint_table(rows, joint)  # columns of the parameters that act on the joint, then its torque
            residual = table[-1] - values[problem.columns[first + joint]] @ table[:-1]
            sizes[problem.weight_index(kind, first + joint)].append(np.abs(residual))
    weights = [1.0 / max(MAD_TO_STD * np.median(np.concatenate(each)), 1e-9) for each in sizes]
    return Fit(problem.solve(stack(problem.r_factors, weights)), weights)
