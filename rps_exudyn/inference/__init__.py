"""Inference: measured curves read, gears fitted to them, and the uncertainty of inputs carried to results."""
