"""Coulomb friction, linear in the rate in a zone about zero."""

from rps_exudyn.base.compiled import kernel


@kernel
def coulomb(normal_force, friction, slip, zone):  # type: ignore[no-untyped-def]
    """Friction over slip speed [N s/m]: mu N / max(|v|, zone), Exudyn's regularisation."""
    return friction * normal_force / max(slip, zone)


@kernel
def constant_drag(size, rate, zone):  # type: ignore[no-untyped-def]
    """Friction of constant size, with the sign of the rate and linear in it below the zone."""
    return size * rate / max(abs(rate), zone)
