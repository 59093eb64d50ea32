"""What follows from measured curves for a gear: estimates with intervals, and what is not separable."""
