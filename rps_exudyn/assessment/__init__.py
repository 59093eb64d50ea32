"""Rows with a verdict: a gear against its requirements, simulations against data from outside."""
