/* The reduced gear in C: its state, its inputs, its steps. Equations: rps_exudyn/solvers/reduced_gear.py. */
#ifndef REDUCED_GEAR_H
#define REDUCED_GEAR_H
#include <stddef.h>
#define MOST_ELEMENTS 4
#define STATES (3 + MOST_ELEMENTS) /* angle, speed, stretch of the elements, lost work */
enum { PUSHED, TURNED, BEHIND_COLUMN }; /* pinion_input */
enum { LOADED, MOVED };                 /* rack_input */
enum { FINE, BEYOND_TABLE, NOT_FINITE };
/* Value references of the FMU; rps_exudyn/fmu/variables.py has the same */
enum {
    TIME,
    TORQUE_IN, ANGLE_IN, SPEED_IN, ACCELERATION_IN, FORCE_IN, TRAVEL_IN, RACK_SPEED_IN,
    TORQUE = 10, ANGLE, SPEED, FORCE, TRAVEL, RACK_SPEED, FRICTION, STORED,
    STATE = 20,
    DERIVATIVE = 30,
    PRELOAD = 40, MESH_FRICTION, YOKE_FRICTION, TEMPERATURE, COLUMN_STIFFNESS, COLUMN_DAMPING,
    MOUNT_STIFFNESS, LONGEST_STEP, START_ANGLE,
    PINION_INPUT = 50, RACK_INPUT
};
/* No pointers: a copy of the bytes is a copy of the gear. */
typedef struct {
    double time, in[RACK_SPEED_IN + 1], parameter[START_ANGLE - PRELOAD + 1];
    int pinion_input, rack_input;
    double state[STATES];
    double load;   /* at the rack [N] */
    double wheel;  /* angle of the column's upper end that the last step reached [rad] */
    double torque; /* at the pinion's port [N m] */
    double press, rubbing, constant, drag; /* what temperature, preload and friction make of the table */
    double beyond[2]; /* load and angle outside the table, of the last call that was not fine */
} Gear;
void gear_reset(Gear *gear);
int gear_start(Gear *gear);
int gear_step(Gear *gear, double duration);
int gear_derivatives(Gear *gear, double derivative[STATES]);
int gear_value(Gear *gear, unsigned reference, double *value);
int gear_set(Gear *gear, unsigned reference, double value);
double gear_largest_load(const Gear *gear);
double gear_nominal(unsigned reference);
int gear_slope(Gear *gear, const unsigned *unknown, size_t unknowns, const unsigned *known, size_t knowns,
               const double *seed, double *slope);
#endif
