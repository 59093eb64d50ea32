/* Random histories of the reduced gear's inputs, for tests/physics/test_fmu.py: the largest share of the work
   that is made, or missing in the balance of work. The works at the ports are found here, not by the gear. */
#include "reduced_gear.h"
#include <math.h>
#include <string.h>

static unsigned long long seed;
static int simpson_parts;

static double uniform(double a, double b) { /* xorshift64* */
    seed ^= seed >> 12; seed ^= seed << 25; seed ^= seed >> 27;
    return a + (b - a) * ((seed * 2685821657736338717ULL) >> 11) / 9007199254740992.0;
}

static double value(Gear *g, unsigned r) {
    double v = NAN;
    return gear_value(g, r, &v) ? NAN : v;
}

/* -int F dX of a load that changes while the pinion stands, by Simpson's rule over X(F) */
static double work_of_change(const Gear *gear, double from, double to) {
    const int PARTS = simpson_parts;
    Gear g = *gear;
    double sum = 0, first = 0, last = 0;
    if (from == to) return 0;
    g.rack_input = LOADED;
    for (int k = 0; k <= PARTS; k++) {
        double weight = k == 0 || k == PARTS ? 1 : k % 2 ? 4 : 2, x;
        g.in[FORCE_IN] = from + (to - from) * k / PARTS;
        x = value(&g, TRAVEL);
        if (k == 0) first = x;
        last = x;
        sum += weight * x;
    }
    return sum * (to - from) / PARTS / 3 - (to * last - from * first);
}

/* result: largest made, largest missing, smallest change of the lost work, histories that left the table,
   values that are not finite, steps */
void histories(int count, int steps, int parts, unsigned long long first_seed, double *result) {
    simpson_parts = parts;
    for (int k = 0; k < 6; k++) result[k] = 0;
    for (int n = 0; n < count; n++) {
        Gear g, moved;
        double h, work = 0, flow = 1e-9, angle = 0, rate = 0, most, start;
        int status = FINE;
        seed = first_seed + 7919ULL * (unsigned)n + 1;
        for (int k = 0; k < 8; k++) uniform(0, 1);
        gear_reset(&g);
        g.pinion_input = uniform(0, 1) < 0.5 ? PUSHED : BEHIND_COLUMN;
        g.rack_input = uniform(0, 1) < 0.7 ? LOADED : MOVED;
        gear_set(&g, PRELOAD, value(&g, PRELOAD) * uniform(0.7, 1.4));
        gear_set(&g, MESH_FRICTION, value(&g, MESH_FRICTION) * uniform(0.5, 1.5));
        gear_set(&g, TEMPERATURE, uniform(250, 360));
        gear_set(&g, MOUNT_STIFFNESS, uniform(0, 1) < 0.5 ? 0 : 2e7);
        h = pow(10, uniform(-5, -2));
        gear_set(&g, LONGEST_STEP, h);
        most = 0.5 * gear_largest_load(&g);
        gear_start(&g);
        start = value(&g, STORED);
        for (int k = 0; k < steps && !status; k++) {
            double load = value(&g, FORCE), lost = value(&g, STATE + 2), phi, x, twist, travel, turned, mean;
            if (uniform(0, 1) < 0.2) g.in[TORQUE_IN] = uniform(-1, 1) * pow(10, uniform(-2, 1));
            if (uniform(0, 1) < 0.2) rate = uniform(-3, 3);
            if (g.rack_input == LOADED && uniform(0, 1) < 0.2) g.in[FORCE_IN] = uniform(-most, most);
            phi = value(&g, ANGLE);
            /* a rack that is moved lags behind the pinion by some micrometres */
            g.in[TRAVEL_IN] = g.rack_input == MOVED ? value(&g, TRAVEL) + uniform(-2e-6, 2e-6) : 0;
            g.in[ANGLE_IN] = angle;
            g.in[SPEED_IN] = rate;
            moved = g; /* the same with the load that the new inputs bring */
            double derivative[STATES];
            if ((status = gear_derivatives(&moved, derivative))) break;
            double changed = work_of_change(&g, load, moved.load);
            travel = value(&moved, TRAVEL);
            twist = g.wheel - phi;
            if ((status = gear_step(&g, h))) break;
            turned = value(&g, ANGLE) - phi;
            x = g.wheel - value(&g, ANGLE);
            mean = g.pinion_input == PUSHED ? g.in[TORQUE_IN]
                 : g.parameter[COLUMN_STIFFNESS - PRELOAD] * (twist + x) / 2
                   + g.parameter[COLUMN_DAMPING - PRELOAD] * (x - twist) / h;
            work += mean * turned + changed;
            flow += fabs(mean * turned) + fabs(changed);
            if (g.rack_input == LOADED) {
                double given = -g.in[FORCE_IN] * (value(&g, TRAVEL) - travel);
                work += given;
                flow += fabs(given);
            }
            angle += rate * h;
            double stored = value(&g, STORED) - start, now = value(&g, STATE + 2);
            if (!isfinite(stored + now + work + g.torque) ) { result[4]++; break; }
            result[0] = fmax(result[0], (stored - work) / flow);
            result[1] = fmax(result[1], fabs(stored + now - work) / flow);
            result[2] = fmin(result[2], now - lost);
            result[5]++;
        }
        if (status == BEYOND_TABLE) result[3]++;
        if (status == NOT_FINITE) result[4]++;
    }
}
