"""What measured curves tell of a gear: estimates with intervals, and what cannot be told apart."""
