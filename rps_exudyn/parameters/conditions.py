"""State in which the gear is tested: temperature and wear, and what the materials make of them.

The gear's other parameters hold for a new gear at 20 degC; `solvers.temperature_and_wear` gives the others.
"""

from typing import Literal

from rps_exudyn.parameters.declaration import (
    DEG,
    Angle,
    Expansion,
    Length,
    Number,
    SpringRate,
    Stiffnesses,
    Table,
    Temperature,
    parameter,
)

REFERENCE_TEMPERATURE = 293.15  # at which all other parameters hold [K]
COLDEST, HOTTEST = 233.15, 373.15  # range of the laws over temperature [K]


class Conditions(Table):
    """Temperature of the whole gear, and the life behind it."""

    temperature: Temperature = parameter("20 degC", "temperature of the whole gear", ge=COLDEST, le=HOTTEST)
    steering_cycles: Number = parameter(
        0.0, "steering cycles behind the gear, each to both sides and back; 0: new", ge=0, le=1e8
    )
    cycle_angle: Angle = parameter("90 deg", "amplitude of these cycles at the pinion", gt=0, le=1080 * DEG)
    spring_set: Number = parameter(
        0.0, "share of its force that the yoke's spring has lost by setting", ge=0, le=0.5
    )


class Housing(Table):
    """The housing of the gear."""

    expansion: Expansion = parameter("23e-6 1/K", "linear thermal expansion (aluminium)", ge=0, le=3e-4)
    seat_stiffness: Stiffnesses = parameter(
        "none",
        "stiffness of the pinion's seat at mid mesh along and about e, Y, axis: 6 values, or 36; none: rigid",
    )

    mount_stiffness: SpringRate = parameter(
        0.0,
        "stiffness of the housing's mounts along the rack, which yield behind a steering column; 0: rigid",
        ge=0,
    )


class Grease(Table):
    """Lubricant of bush and plunger seat, as far as its viscosity drags."""

    base_oil: Literal["none", "PAO 32", "VG 68", "VG 100", "VG 150"] = parameter(
        "none", "base oil; none: no viscous drag"
    )
    film: Length = parameter("0.05 mm", "thickness of the sheared film", gt=0, le=1e-3)
    thickening: Number = parameter(3.0, "viscous drag of the grease over that of its base oil", ge=1, le=10)
