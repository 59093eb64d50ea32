/* An instance of the gear, as both versions of FMI have it. */
#include "gear_data.h"
#include "reduced_gear.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#define SAVED sizeof(Gear)
#define NO_MEMORY -2
#define TEXT 300
typedef struct {
    Gear gear;
    int starts, exchanges; /* being initialised, in model exchange: values read follow those set */
    void *environment;
    void (*log)(void);
    char name[TEXT], text[TEXT];
} Instance;
static void *new_instance(const char *name, const char *token, void *environment, void (*log)(void)) {
    Instance *one = token && !strcmp(token, TOKEN) ? calloc(1, sizeof *one) : NULL;
    if (!one) return NULL;
    gear_reset(&one->gear);
    one->environment = environment;
    one->log = log;
    snprintf(one->name, TEXT, "%s", name ? name : "");
    return one;
}
static const char *sentence_of(Instance *one, int status) {
    double most = gear_largest_load(&one->gear), degree = 57.29577951308232;
    if (status == BEYOND_TABLE)
        snprintf(one->text, TEXT, "the load on the rack is %.5g N at %.5g deg; the table has %.5g to %.5g N and %s"
                 "%.5g to %.5g deg", one->gear.beyond[0], one->gear.beyond[1] * degree, -most, most,
                 REPEATS ? "repeats " : "", FIRST_ANGLE * degree, (FIRST_ANGLE + CELLS * ANGLE_STEP) * degree);
    else snprintf(one->text, TEXT, "%s", status == NOT_FINITE ? "a value is not a finite number"
                  : status == NO_MEMORY ? "there is no memory for the state, or it is another model's"
                  : "the gear has no such variable, or not with this value");
    return one->text;
}
static int get_values(Instance *one, const unsigned r[], size_t n, double values[]) {
    double d[STATES];
    int status = one->starts ? gear_start(&one->gear) : one->exchanges ? gear_derivatives(&one->gear, d) : FINE;
    for (size_t k = 0; k < n && !status; k++)
        status = r[k] < PINION_INPUT ? gear_value(&one->gear, r[k], values + k) : -1;
    return status;
}
static int set_values(Instance *one, const unsigned r[], size_t n, const double values[]) {
    int status = FINE;
    for (size_t k = 0; k < n && !status; k++)
        status = r[k] < PINION_INPUT ? gear_set(&one->gear, r[k], values[k]) : -1;
    return status;
}
static int get_choices(Instance *one, const unsigned r[], size_t n, int values[]) {
    double value = 0;
    int status = FINE;
    for (size_t k = 0; k < n && !status; k++) {
        status = r[k] < PINION_INPUT ? -1 : gear_value(&one->gear, r[k], &value);
        values[k] = (int)value;
    }
    return status;
}
static int set_choices(Instance *one, const unsigned r[], size_t n, const int values[]) {
    int status = FINE;
    for (size_t k = 0; k < n && !status; k++)
        status = r[k] < PINION_INPUT ? -1 : gear_set(&one->gear, r[k], values[k]);
    return status;
}
static int started(Instance *one) { one->starts = 0; return gear_start(&one->gear); }
static int copied(void **to, const void *from, size_t size) {
    if (size != SAVED || (!*to && !(*to = malloc(SAVED)))) return NO_MEMORY;
    memcpy(*to, from, SAVED);
    return FINE;
}
