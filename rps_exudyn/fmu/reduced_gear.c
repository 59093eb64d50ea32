/* The reduced gear: table, friction elements, steps. The steps are those of
   rps_exudyn/solvers/reduced_motion.py, which a test compares. SI units. */
#include "reduced_gear.h"
#include "gear_data.h"
#include <math.h>
#include <string.h>

#define THETA 0.6         /* of the speed's change that a step's turn has; above a half it damps */
#define SAME 1e-6         /* turn over which the mean of a slope is that in the middle [rad] */
#define PRECISE 1e-10     /* of the torques, that a step's balance leaves */
#define TRIALS 60
#define LOAD_TRIALS 100
#define SAME_TRAVEL 1e-10 /* of the rack, to which a load is found [m] */
#define MOST_STEPS 1e9     /* within a communication step */
#define ROUNDED 0.1       /* of an element's limit, over which it begins to slide in model exchange */

#define TRY(call) do { int status_ = (call); if (status_) return status_; } while (0)

enum { PHI, OMEGA, LOST, STRETCH };

typedef struct { double energy, torque, travel, bend, gain; } Potential; /* gain: of the perfect rack */
typedef struct { double load, energy, torque, stiffness; } Held;
typedef struct { double up[ELEMENTS], down[ELEMENTS]; } Limits;

static double parameter(const Gear *g, int reference) { return g->parameter[reference - PRELOAD]; }

/* --- what temperature, preload and friction make of the table ---------------------------------- */
static void operate(Gear *g) {
    /* rows: temperature, factor and summand of the preload, factor of the seat's friction, friction that
       no load changes, viscous drag */
    double warm = parameter(g, TEMPERATURE), row[6], mesh, seat;
    int i = 0, k;
    while (i < TEMPERATURES - 2 && warm > OPERATION[i + 1][0]) i++;
    double part = (warm - OPERATION[i][0]) / (OPERATION[i + 1][0] - OPERATION[i][0]);
    part = fmin(fmax(part, 0.0), 1.0);
    for (k = 0; k < 6; k++) row[k] = OPERATION[i][k] + part * (OPERATION[i + 1][k] - OPERATION[i][k]);
    g->press = fmax((row[1] * parameter(g, PRELOAD) + row[2]) / TABLE_PRELOAD, 1e-3);
    mesh = MESH_FRICTION_OF_TABLE > 0 ? parameter(g, MESH_FRICTION) / MESH_FRICTION_OF_TABLE : 1.0;
    seat = YOKE_FRICTION_OF_TABLE > 0 ? parameter(g, YOKE_FRICTION) * row[3] / YOKE_FRICTION_OF_TABLE : 1.0;
    g->rubbing = (1 - SEAT_SHARE) * mesh + SEAT_SHARE * seat;
    g->constant = row[4];
    g->drag = row[5];
}

double gear_largest_load(const Gear *g) { return -LEAST_LOAD * g->press; }

/* --- table ---------------------------------------------------------------------------------------- */
static int place(Gear *g, double angle, double load, double *x, double *y, int *i, int *j) {
    *x = (angle - FIRST_ANGLE) / ANGLE_STEP;
    if (REPEATS) *x -= CELLS * floor(*x / CELLS);
    *y = (load - LEAST_LOAD) / LOAD_STEP;
    if (!(*x > -1e-9 && *x < CELLS + 1e-9 && *y > -1e-9 && *y < ROWS + 1e-9)) {
        g->beyond[0] = load, g->beyond[1] = angle;
        return isfinite(angle) && isfinite(load) ? BEYOND_TABLE : NOT_FINITE;
    }
    *i = *x < 0 ? 0 : *x < CELLS ? (int)*x : CELLS - 1;
    *j = *y < 0 ? 0 : *y < ROWS ? (int)*y : ROWS - 1;
    *x -= *i, *y -= *j;
    return FINE;
}

/* weights of values and slopes at the ends of a cell, for the value, its slope and its curvature */
static void hermite(double x, double h, double value[4], double slope[4], double bend[4]) {
    double r = 1 - x;
    value[0] = (1 + 2 * x) * r * r; value[1] = x * x * (3 - 2 * x);
    value[2] = h * x * r * r; value[3] = -h * x * x * r;
    slope[0] = -6 * x * r / h; slope[1] = 6 * x * r / h;
    slope[2] = r * (1 - 3 * x); slope[3] = x * (3 * x - 2);
    bend[0] = (12 * x - 6) / (h * h); bend[1] = -bend[0];
    bend[2] = (6 * x - 4) / h; bend[3] = (6 * x - 2) / h;
}

/* W(phi, F) and its derivatives: torque dW/dphi, travel dW/dF, d2W/dF2. Under a preload p times that of the
   table the free gear's potential R is p R(phi), the integral D of what yields is p^2 D(phi, F/p). */
static int potential(Gear *g, double angle, double load, Potential *w) {
    double p = g->press, x, y, at[4], after[4], none[4], up[4], rise[4], bend[4], sum[4] = {0, 0, 0, 0};
    double mounts = parameter(g, MOUNT_STIFFNESS), soft = mounts > 0 ? 1 / mounts : 0.0;
    int i, j, k;
    TRY(place(g, angle, load / p, &x, &y, &i, &j));
    hermite(x, ANGLE_STEP, at, after, none);
    hermite(y, LOAD_STEP, up, rise, bend);
    for (k = 0; k < 2; k++) {
        const double *a = UNDER_LOAD[i][j + k], *b = UNDER_LOAD[i + 1][j + k];
        double value = at[0] * a[0] + at[1] * b[0] + at[2] * a[1] + at[3] * b[1];
        double by_load = at[0] * a[2] + at[1] * b[2] + at[2] * a[3] + at[3] * b[3];
        sum[0] += up[k] * value + up[k + 2] * by_load;
        sum[1] += up[k] * (after[0] * a[0] + after[1] * b[0] + after[2] * a[1] + after[3] * b[1])
                  + up[k + 2] * (after[0] * a[2] + after[1] * b[2] + after[2] * a[3] + after[3] * b[3]);
        sum[2] += rise[k] * value + rise[k + 2] * by_load;
        sum[3] += bend[k] * value + bend[k + 2] * by_load;
    }
    const double *a = FREE[i], *b = FREE[i + 1];
    /* the perfect rack's travel, which no preload changes */
    const double *c = COURSE[i], *d = COURSE[i + 1];
    double perfect = GAIN * angle + at[0] * c[0] + at[1] * d[0] + at[2] * c[1] + at[3] * d[1];
    w->gain = GAIN + after[0] * c[0] + after[1] * d[0] + after[2] * c[1] + after[3] * d[1];
    w->energy = perfect * load + p * (at[0] * a[0] + at[1] * b[0] + at[2] * a[1] + at[3] * b[1])
                + p * p * sum[0] - soft * load * load / 2;
    w->torque = w->gain * load + p * (after[0] * a[0] + after[1] * b[0] + after[2] * a[1] + after[3] * b[1])
                + p * p * sum[1];
    w->travel = perfect + p * sum[2] - soft * load;
    w->bend = sum[3] - soft;
    return FINE;
}

/* the load, and the potential of gear and rack's end, where the rack is at `travel` or under the load */
static int held(Gear *g, double angle, double travel, Held *h) {
    Potential w;
    double low = -gear_largest_load(g), high = -low, load = g->rack_input == LOADED ? g->in[FORCE_IN] : g->load;
    int k;
    TRY(potential(g, angle, load, &w));
    *h = (Held){load, w.energy, w.torque, 0};
    if (g->rack_input == LOADED) return FINE;
    for (k = 0; k < LOAD_TRIALS; k++) {
        /* the travel falls with the load; the middle, where Newton's method leaves the bracket */
        double next = h->load + (travel - w.travel) / fmin(w.bend, -LEAST_COMPLIANCE), last = h->load;
        *(travel < w.travel ? &low : &high) = last;
        if (!(low <= next && next <= high)) next = (low + high) / 2;
        h->load = next;
        TRY(potential(g, angle, next, &w));
        if (fabs(next - last) < 1e-12 * (1 + fabs(last))) break;
    }
    if (!(fabs(travel - w.travel) < SAME_TRAVEL)) { /* the load that it takes is none of the table's */
        g->beyond[0] = h->load + (travel - w.travel) / fmin(w.bend, -LEAST_COMPLIANCE);
        g->beyond[1] = angle;
        return BEYOND_TABLE;
    }
    *h = (Held){h->load, w.energy - h->load * travel, w.torque, w.gain * w.gain / fmax(-w.bend, LEAST_COMPLIANCE)};
    return FINE;
}

/* --- friction ------------------------------------------------------------------------------------- */
static double speed_factor(double speed) {
    int i = 1;
    if (SPEEDS < 2 || speed >= NODE_SPEED[SPEEDS - 1]) return SPEED_FACTOR[SPEEDS - 1];
    while (speed >= NODE_SPEED[i]) i++;
    return SPEED_FACTOR[i - 1]
           + (SPEED_FACTOR[i] - SPEED_FACTOR[i - 1]) * (speed - NODE_SPEED[i - 1]) / (NODE_SPEED[i] - NODE_SPEED[i - 1]);
}

/* stretch at which each element slides, either way */
static int limits(Gear *g, double angle, double speed, Limits *l) {
    double x, y, size[2], factor = speed_factor(fabs(speed));
    int i, j, k;
    TRY(place(g, angle, g->load / g->press, &x, &y, &i, &j));
    for (k = 0; k < 2; k++) {
        double of_table = (1 - x) * ((1 - y) * LIMIT[i][j][k] + y * LIMIT[i][j + 1][k])
                          + x * ((1 - y) * LIMIT[i + 1][j][k] + y * LIMIT[i + 1][j + 1][k]);
        double fixed = CONSTANT < of_table ? CONSTANT : of_table;
        size[k] = factor * (g->press * (of_table - fixed) * g->rubbing + fixed * g->constant);
    }
    for (k = 0; k < ELEMENTS; k++) {
        l->up[k] = SHARE[k] * size[0] / STIFFNESS[k];
        l->down[k] = SHARE[k] * size[1] / STIFFNESS[k];
    }
    return FINE;
}

static double within(double x, double least, double most) { return x < least ? least : x > most ? most : x; }

static void relax(Gear *g, const Limits *l) {
    double *stretch = g->state + STRETCH;
    for (int k = 0; k < ELEMENTS; k++) {
        double now = within(stretch[k], -l->down[k], l->up[k]);
        g->state[LOST] += STIFFNESS[k] * (stretch[k] * stretch[k] - now * now) / 2;
        stretch[k] = now;
    }
}

static double resisting(const Gear *g, double turn, double damped, const Limits *l, double *slope) {
    double torque = 0;
    *slope = 0;
    for (int k = 0; k < ELEMENTS; k++) {
        double x = g->state[STRETCH + k], stiff = STIFFNESS[k], end = x + turn;
        if (-l->down[k] <= end && end <= l->up[k]) {
            torque += stiff * (x + turn / 2 + damped * turn);
            *slope += stiff * (0.5 + damped);
        } else {
            double edge = end > l->up[k] ? l->up[k] : -l->down[k], yielded = edge - x;
            double mean = stiff * (yielded * (x + yielded / 2) + edge * (turn - yielded)) / turn;
            torque += mean + stiff * damped * yielded;
            *slope += (stiff * edge - mean) / turn;
        }
    }
    return torque;
}

static void slide(Gear *g, double turn, double damped, const Limits *l) {
    for (int k = 0; k < ELEMENTS; k++) {
        double *x = g->state + STRETCH + k, end = *x + turn, now = within(end, -l->down[k], l->up[k]);
        g->state[LOST] += STIFFNESS[k] * (now * (end - now) + damped * (now - *x) * turn);
        *x = now;
    }
}

static double elastic_torque(const Gear *g) {
    double torque = 0;
    for (int k = 0; k < ELEMENTS; k++) torque += STIFFNESS[k] * g->state[STRETCH + k];
    return torque;
}

/* --- steps ---------------------------------------------------------------------------------------- */
static int push(Gear *g, double torque, double resistance, double travel, double h, double *turned) {
    double *s = g->state, damped = DAMPING / h, mass = INERTIA / (THETA * h), drag = g->drag;
    double straight = mass / h + drag / h + resistance, low = -INFINITY, high = INFINITY, x = h * s[OMEGA];
    double slope, change, last = INFINITY;
    Held before, after; Limits l;
    TRY(held(g, s[PHI], travel, &before));
    g->load = before.load;
    TRY(limits(g, s[PHI] + x, s[OMEGA], &l));
    relax(g, &l);
    for (int trial = 0; trial < TRIALS; trial++) {
        double friction = resisting(g, x, damped, &l, &slope), mean, left;
        TRY(held(g, s[PHI] + (fabs(x) < SAME ? x / 2 : x), travel, &after));
        mean = fabs(x) < SAME ? after.torque : (after.energy - before.energy) / x;
        left = straight * x - mass * s[OMEGA] + mean + friction - torque;
        if (fabs(left) <= PRECISE * (fabs(friction) + fabs(mean) + fabs(torque) + fabs(mass * s[OMEGA]))) break;
        *(left < 0 ? &low : &high) = x;
        x -= left / (straight + slope + after.stiffness / 2);
        /* the middle, where Newton's method leaves the bracket or does not halve what is left */
        if (!(low < x && x < high) || (fabs(left) > last / 2 && isfinite(high - low))) x = (low + high) / 2;
        last = fabs(left);
        if (high - low < 1e-15 * (1 + fabs(x))) break;
    }
    slide(g, x, damped, &l);
    change = (x / h - s[OMEGA]) / THETA;
    s[LOST] += drag * x * x / h + (THETA - 0.5) * INERTIA * change * change;
    s[PHI] += *turned = x;
    s[OMEGA] += change;
    if (g->rack_input == MOVED) TRY(held(g, s[PHI], travel, &after));
    g->load = g->rack_input == MOVED ? after.load : before.load;
    return isfinite(x) ? FINE : NOT_FINITE;
}

static int follow(Gear *g, double angle, double speed, double travel, double h) {
    double *s = g->state, turn = angle - s[PHI];
    Held after; Limits l;
    TRY(held(g, angle, travel, &after));
    g->load = after.load;
    TRY(limits(g, angle, speed, &l));
    relax(g, &l);
    slide(g, turn, 0.0, &l);
    s[LOST] += h > 0 ? g->drag * turn * turn / h : 0.0;
    s[PHI] = angle;
    s[OMEGA] = speed;
    g->torque = after.torque + elastic_torque(g) + g->drag * speed + INERTIA * g->in[ACCELERATION_IN];
    return FINE;
}

int gear_step(Gear *g, double duration) {
    double begun = g->time, steps = fmax(ceil(duration / parameter(g, LONGEST_STEP) - 1e-9), 1), h = duration / steps;
    int status = duration >= 0 && steps < MOST_STEPS ? FINE : NOT_FINITE;
    if (duration == 0) return FINE;
    for (int i = 1; i <= steps && !status; i++) {
        double t = i * h, angle = g->in[ANGLE_IN] + t * (g->in[SPEED_IN] + t * g->in[ACCELERATION_IN] / 2);
        double travel = g->in[TRAVEL_IN] + t * g->in[RACK_SPEED_IN], turn;
        if (g->pinion_input == PUSHED) {
            status = push(g, g->in[TORQUE_IN], 0.0, travel, h, &turn);
            g->torque = g->in[TORQUE_IN];
        } else if (g->pinion_input == TURNED) {
            status = follow(g, angle, g->in[SPEED_IN] + t * g->in[ACCELERATION_IN], travel, h);
        } else {
            double stiff = parameter(g, COLUMN_STIFFNESS), damped = parameter(g, COLUMN_DAMPING) / h;
            double twist = g->wheel - g->state[PHI], wheel = angle - g->wheel, half = stiff / 2 + damped;
            status = push(g, stiff * twist + half * wheel, half, travel, h, &turn);
            g->wheel = angle;
            g->torque = stiff * (angle - g->state[PHI]) + damped * (wheel - turn);
        }
        g->time = begun + t;
    }
    return status;
}

int gear_derivatives(Gear *g, double d[STATES]) {
    double *s = g->state, damped = DAMPING, friction = 0, lost = 0, torque = g->in[TORQUE_IN], drag = g->drag;
    int turned = g->pinion_input == TURNED;
    double angle = turned ? g->in[ANGLE_IN] : s[PHI], speed = turned ? g->in[SPEED_IN] : s[OMEGA];
    Held h; Limits l;
    TRY(held(g, angle, g->in[TRAVEL_IN], &h));
    g->load = h.load;
    TRY(limits(g, angle, speed, &l));
    for (int k = 0; k < MOST_ELEMENTS; k++) d[STRETCH + k] = 0;
    for (int k = 0; k < ELEMENTS; k++) {
        double x = s[STRETCH + k], room = speed > 0 ? l.up[k] - x : l.down[k] + x, share, creep;
        double zone = ROUNDED * (speed > 0 ? l.up[k] : l.down[k]) + 1e-12;
        share = fmin(room / zone, 1.0);
        d[STRETCH + k] = speed * share;
        creep = turned ? 0.0 : damped * speed * fmax(share, 0.0);
        friction += STIFFNESS[k] * (x + creep);
        lost += STIFFNESS[k] * (x * speed * (1 - share) + creep * speed);
    }
    if (g->pinion_input == BEHIND_COLUMN)
        torque = parameter(g, COLUMN_STIFFNESS) * (g->in[ANGLE_IN] - angle)
                 + parameter(g, COLUMN_DAMPING) * (g->in[SPEED_IN] - speed);
    g->torque = turned ? h.torque + friction + drag * speed + INERTIA * g->in[ACCELERATION_IN] : torque;
    d[PHI] = turned ? 0.0 : speed;
    d[OMEGA] = turned ? 0.0 : (torque - h.torque - friction - drag * speed) / INERTIA;
    d[LOST] = lost + drag * speed * speed;
    return isfinite(d[OMEGA]) && isfinite(friction) ? FINE : NOT_FINITE;
}

/* --- values --------------------------------------------------------------------------------------- */
void gear_reset(Gear *g) {
    memset(g, 0, sizeof *g);
    memcpy(g->parameter, PARAMETERS, sizeof PARAMETERS);
    operate(g);
}

int gear_start(Gear *g) {
    double d[STATES];
    Held h;
    g->wheel = g->in[ANGLE_IN];
    g->state[PHI] = g->pinion_input == PUSHED ? parameter(g, START_ANGLE) : g->in[ANGLE_IN];
    g->state[OMEGA] = g->pinion_input == PUSHED ? 0.0 : g->in[SPEED_IN];
    g->load = g->rack_input == LOADED ? g->in[FORCE_IN] : 0.0;
    TRY(held(g, g->state[PHI], g->in[TRAVEL_IN], &h));
    g->load = h.load;
    return gear_derivatives(g, d);
}

int gear_value(Gear *g, unsigned r, double *value) {
    double d[STATES];
    Potential w = {0, 0, 0, 0, 0};
    int status = FINE, moving = g->pinion_input != TURNED;
    double angle = moving ? g->state[PHI] : g->in[ANGLE_IN], speed = moving ? g->state[OMEGA] : g->in[SPEED_IN];
    double load = g->rack_input == LOADED ? g->in[FORCE_IN] : g->load;
    if (r == TIME) *value = g->time;
    else if (r <= RACK_SPEED_IN) *value = g->in[r];
    else if (r >= PRELOAD && r <= START_ANGLE) *value = parameter(g, (int)r);
    else if (r >= STATE && r < STATE + STATES) *value = g->state[r - STATE];
    else if (r >= DERIVATIVE && r < DERIVATIVE + STATES) {
        status = gear_derivatives(g, d);
        *value = d[r - DERIVATIVE];
    } else if (r == PINION_INPUT) *value = g->pinion_input;
    else if (r == RACK_INPUT) *value = g->rack_input;
    else if (r == ANGLE || r == SPEED) *value = r == ANGLE ? angle : speed;
    else if (r == TORQUE || r == FORCE) *value = r == TORQUE ? g->torque : load;
    else if (r == RACK_SPEED && g->rack_input == MOVED) *value = g->in[RACK_SPEED_IN];
    else if (r == FRICTION) *value = elastic_torque(g);
    else if (r == TRAVEL || r == STORED || r == RACK_SPEED) {
        status = potential(g, angle, load, &w);
        *value = r == RACK_SPEED ? w.gain * speed : w.travel;
        if (r == STORED) {
            *value = w.energy - load * w.travel + INERTIA * speed * speed / 2;
            for (int k = 0; k < ELEMENTS; k++)
                *value += STIFFNESS[k] * g->state[STRETCH + k] * g->state[STRETCH + k] / 2;
        }
    } else return -1;
    return status;
}

int gear_set(Gear *g, unsigned r, double value) {
    if (!isfinite(value)) return NOT_FINITE;
    if (r == TIME) g->time = value;
    else if (r <= RACK_SPEED_IN) g->in[r] = value;
    else if (r >= PRELOAD && r <= START_ANGLE) {
        g->parameter[r - PRELOAD] = value;
        operate(g);
    }
    else if (r >= STATE && r < STATE + STATES) g->state[r - STATE] = value;
    else if (r == PINION_INPUT && (int)value >= PUSHED && (int)value <= BEHIND_COLUMN) g->pinion_input = (int)value;
    else if (r == RACK_INPUT && (int)value >= LOADED && (int)value <= MOVED) g->rack_input = (int)value;
    else return -1;
    return FINE;
}

double gear_nominal(unsigned r) {
    if (r == FORCE_IN || r == PRELOAD) return 100.0;
    if (r == TRAVEL_IN) return 1e-5;
    if (r >= STATE + STRETCH && r < STATE + STATES) return 1e-5;
    return r == STATE + PHI || r == ANGLE_IN ? 1e-2 : 1.0;
}

/* directional derivatives, by central differences over a ten-thousandth of the nominal values */
int gear_slope(Gear *g, const unsigned *unknown, size_t unknowns, const unsigned *known, size_t knowns,
               const double *seed, double *slope) {
    double largest = 0, value, end[2];
    Gear moved;
    int status = FINE;
    for (size_t k = 0; k < knowns; k++) largest = fmax(largest, fabs(seed[k]) / gear_nominal(known[k]));
    for (size_t u = 0; u < unknowns && !status; u++) {
        double eps = largest > 0 ? 1e-4 / largest : 0.0, d[STATES];
        for (int side = 0; side < 2 && !status; side++) {
            moved = *g;
            for (size_t k = 0; k < knowns && !status; k++) {
                status = gear_value(&moved, known[k], &value);
                if (!status) status = gear_set(&moved, known[k], value + (side ? -eps : eps) * seed[k]);
            }
            if (!status) status = gear_derivatives(&moved, d);
            if (!status) status = gear_value(&moved, unknown[u], end + side);
        }
        slope[u] = eps > 0 ? (end[0] - end[1]) / (2 * eps) : 0.0;
    }
    return status;
}
