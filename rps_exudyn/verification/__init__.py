"""Independent methods, references, orders of convergence, speed and stability."""
