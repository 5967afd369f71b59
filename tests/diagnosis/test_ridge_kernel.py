"""The compiled least squares with a ridge are those of `ridge_inverse`."""

import numpy as np
import pytest

from cdia_pin.diagnosis.joint_gram import ridge_inverse
from cdia_pin.diagnosis.ridge_kernel import ridge_solve

RNG = np.random.default_rng(3)
COLUMNS = RNG.normal(size=(200, 3)) * (1.0, 1e-3, 50.0)


@pytest.mark.parametrize(
    "columns",
    [
        COLUMNS,
        np.hstack([COLUMNS, np.zeros((200, 1))]),  # never excited
        np.hstack([COLUMNS, 2.0 * COLUMNS[:, :1]]),  # repeats another one
    ],
    ids=["plain", "still", "repeated"],
)
def test_the_solution_is_that_of_the_inverse(columns: np.ndarray) -> None:
    gram, right = columns.T @ columns, columns.T @ RNG.normal(size=len(columns))
    np.testing.assert_allclose(
        ridge_solve(np.triu(gram), right), ridge_inverse(gram) @ right, rtol=1e-7, atol=1e-9
    )
