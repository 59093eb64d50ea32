"""The steel that the teeth are made of, and what its contact bears."""

import numpy as np

YOUNGS_MODULUS, POISSON_RATIO = 206e9, 0.3  # as in ISO 6336-2
EFFECTIVE_MODULUS = YOUNGS_MODULUS / (2 * (1 - POISSON_RATIO**2))  # E* of two bodies of it [Pa]
HERTZ = 2 * (1 - POISSON_RATIO**2) / (np.pi * YOUNGS_MODULUS)  # K of a line's flattening [m^2/N]
FLATTENED = POISSON_RATIO / (1 - POISSON_RATIO)  # what its logarithm is less by
BEARABLE_PRESSURE = 1.5e9  # Hertzian, of case-hardened steel, ISO 6336-5, quality MQ [Pa]
