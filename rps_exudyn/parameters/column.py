"""The steering column between the driver's hand and the pinion: the parameters of the table `column`."""

from rps_exudyn.parameters.declaration import (
    DEG,
    Angle,
    Inertia,
    Table,
    Torsion,
    TorsionDamping,
    parameter,
)


class Column(Table):
    """Steering wheel, column and torsion bar; only scenes that move the wheel know them."""

    wheel_inertia: Inertia = parameter(
        "0.04 kg*m^2", "moment of inertia of the steering wheel", "estimate", gt=0
    )
    stiffness: Torsion = parameter(
        "120 N*m/rad", "torsional stiffness of column and torsion bar in series", "estimate", gt=0
    )
    damping: TorsionDamping = parameter(
        "0.02 N*m*s/rad", "damping torque per rate of the column's twist", "estimate", ge=0
    )
    joint_angle: Angle = parameter(
        0.0,
        "bend of the column in its universal joint between wheel and torsion bar; 0: no joint",
        "estimate",
        ge=0,
        le=60 * DEG,
    )
    joint_phase: Angle = parameter(
        0.0,
        "angle of the wheel-side yoke's axis from the bend's plane with the wheel straight ahead",
        "estimate",
    )
