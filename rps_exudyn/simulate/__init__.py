"""Gear, fidelity and scene in; a result out, whatever its outcome."""
