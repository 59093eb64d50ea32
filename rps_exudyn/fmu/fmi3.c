/* FMI 3.0: co-simulation and model exchange of the reduced gear. */
#include "fmi3Functions.h"
#include "instance.h"

#define I fmi3Instance instance
#define R const fmi3ValueReference r[], size_t n
#define ONE ((Instance *)instance)
#define GEAR (&ONE->gear)
static fmi3Status ended(I, int status) {
    if (!status) return fmi3OK;
    if (ONE->log) ((fmi3LogMessageCallback)ONE->log)(ONE->environment, fmi3Error, "error", sentence_of(ONE, status));
    return fmi3Error;
}
const char *fmi3GetVersion(void) { return fmi3Version; }
#define NAMES fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible, fmi3Boolean logging
#define CALLER fmi3InstanceEnvironment environment, fmi3LogMessageCallback log
fmi3Instance fmi3InstantiateModelExchange(NAMES, CALLER) {
    fmi3Instance instance = new_instance(name, token, environment, (void (*)(void))log);
    if (instance) ONE->exchanges = 1;
    if (!instance && log) log(environment, fmi3Error, "error", "no memory, or the instantiation token of another model");
    return instance;
}
fmi3Instance fmi3InstantiateCoSimulation(NAMES, fmi3Boolean events, fmi3Boolean early, const fmi3ValueReference r[],
                                         size_t n, CALLER, fmi3IntermediateUpdateCallback update) {
    fmi3Instance instance = fmi3InstantiateModelExchange(name, token, resources, visible, logging, environment, log);
    if (instance) ONE->exchanges = 0;
    return instance;
}
fmi3Instance fmi3InstantiateScheduledExecution(NAMES, CALLER, fmi3ClockUpdateCallback update,
                                               fmi3LockPreemptionCallback lock, fmi3UnlockPreemptionCallback unlock) {
    return NULL;
}
void fmi3FreeInstance(I) { free(instance); }
fmi3Status fmi3Reset(I) { gear_reset(GEAR); return fmi3OK; }
fmi3Status fmi3ExitInitializationMode(I) { return ended(instance, started(ONE)); }
fmi3Status fmi3EnterInitializationMode(I, fmi3Boolean tolerant, fmi3Float64 tolerance, fmi3Float64 start,
                                       fmi3Boolean stops, fmi3Float64 stop) {
    ONE->starts = 1;
    return ended(instance, gear_set(GEAR, TIME, start));
}
/* modes that change nothing */
#define MODE(name) fmi3Status name(I) { return fmi3OK; }
MODE(fmi3EnterEventMode) MODE(fmi3Terminate) MODE(fmi3EnterConfigurationMode) MODE(fmi3ExitConfigurationMode)
MODE(fmi3EvaluateDiscreteStates) MODE(fmi3EnterContinuousTimeMode) MODE(fmi3EnterStepMode)
/* --- values: of two types, and of those that no variable has --- */
#define TYPE(name, type, get, set)                                                                           \
    fmi3Status fmi3Get##name(I, R, type v[], size_t m) { return ended(instance, m == n ? get : -1); }        \
    fmi3Status fmi3Set##name(I, R, const type v[], size_t m) { return ended(instance, m == n ? set : -1); }
#define NO_TYPE(type) TYPE(type, fmi3##type, n ? -1 : FINE, n ? -1 : FINE)
TYPE(Float64, fmi3Float64, get_values(ONE, r, n, v), set_values(ONE, r, n, v))
TYPE(Int32, fmi3Int32, get_choices(ONE, r, n, v), set_choices(ONE, r, n, v))
NO_TYPE(Float32) NO_TYPE(Int8) NO_TYPE(UInt8) NO_TYPE(Int16) NO_TYPE(UInt16) NO_TYPE(UInt32) NO_TYPE(Int64)
NO_TYPE(UInt64) NO_TYPE(Boolean) NO_TYPE(String)
/* functions of what the model does not have */
#define NONE(name, ...) fmi3Status name(I, __VA_ARGS__) { return ended(instance, -1); }
NONE(fmi3GetBinary, R, size_t s[], fmi3Binary v[], size_t m)
NONE(fmi3SetBinary, R, const size_t s[], const fmi3Binary v[], size_t m)
NONE(fmi3GetClock, R, fmi3Clock v[])
NONE(fmi3SetClock, R, const fmi3Clock v[])
NONE(fmi3GetNumberOfVariableDependencies, fmi3ValueReference r, size_t *n)
NONE(fmi3GetVariableDependencies, fmi3ValueReference r, size_t a[], fmi3ValueReference b[], size_t c[],
     fmi3DependencyKind d[], size_t n)
NONE(fmi3GetIntervalDecimal, R, fmi3Float64 v[], fmi3IntervalQualifier q[])
NONE(fmi3GetIntervalFraction, R, fmi3UInt64 c[], fmi3UInt64 s[], fmi3IntervalQualifier q[])
NONE(fmi3GetShiftDecimal, R, fmi3Float64 v[])
NONE(fmi3GetShiftFraction, R, fmi3UInt64 c[], fmi3UInt64 s[])
NONE(fmi3SetIntervalDecimal, R, const fmi3Float64 v[])
NONE(fmi3SetIntervalFraction, R, const fmi3UInt64 c[], const fmi3UInt64 s[])
NONE(fmi3SetShiftDecimal, R, const fmi3Float64 v[])
NONE(fmi3SetShiftFraction, R, const fmi3UInt64 c[], const fmi3UInt64 s[])
NONE(fmi3GetAdjointDerivative, R, const fmi3ValueReference k[], size_t m, const fmi3Float64 s[], size_t a,
     fmi3Float64 v[], size_t b)
NONE(fmi3GetOutputDerivatives, R, const fmi3Int32 o[], fmi3Float64 v[], size_t m)
NONE(fmi3ActivateModelPartition, fmi3ValueReference r, fmi3Float64 t)
fmi3Status fmi3SetDebugLogging(I, fmi3Boolean on, size_t n, const fmi3String categories[]) { return fmi3OK; }
/* --- state and derivatives --- */
fmi3Status fmi3GetFMUState(I, fmi3FMUState *state) { return ended(instance, copied(state, GEAR, SAVED)); }
fmi3Status fmi3SetFMUState(I, fmi3FMUState state) { memcpy(GEAR, state, SAVED); return fmi3OK; }
fmi3Status fmi3FreeFMUState(I, fmi3FMUState *state) { free(*state); *state = NULL; return fmi3OK; }
fmi3Status fmi3SerializedFMUStateSize(I, fmi3FMUState state, size_t *size) { *size = SAVED; return fmi3OK; }
fmi3Status fmi3SerializeFMUState(I, fmi3FMUState state, fmi3Byte bytes[], size_t size) {
    void *to = bytes;
    return ended(instance, copied(&to, state, size));
}
fmi3Status fmi3DeserializeFMUState(I, const fmi3Byte bytes[], size_t size, fmi3FMUState *state) {
    return ended(instance, copied(state, bytes, size));
}
fmi3Status fmi3GetDirectionalDerivative(I, R, const fmi3ValueReference known[], size_t m, const fmi3Float64 seed[],
                                        size_t seeds, fmi3Float64 slope[], size_t slopes) {
    return ended(instance, seeds == m && slopes == n ? gear_slope(GEAR, r, n, known, m, seed, slope) : -1);
}
/* --- model exchange --- */
fmi3Status fmi3UpdateDiscreteStates(I, fmi3Boolean *again, fmi3Boolean *terminate, fmi3Boolean *nominals,
                                    fmi3Boolean *states, fmi3Boolean *next, fmi3Float64 *time) {
    *again = *terminate = *nominals = *states = *next = fmi3False;
    return fmi3OK;
}
fmi3Status fmi3CompletedIntegratorStep(I, fmi3Boolean no_return, fmi3Boolean *event, fmi3Boolean *terminate) {
    *event = *terminate = fmi3False;
    return fmi3OK;
}
fmi3Status fmi3SetTime(I, fmi3Float64 time) { return ended(instance, gear_set(GEAR, TIME, time)); }
fmi3Status fmi3SetContinuousStates(I, const fmi3Float64 x[], size_t n) {
    if (n == STATES) memcpy(GEAR->state, x, sizeof GEAR->state);
    return ended(instance, n == STATES ? FINE : -1);
}
fmi3Status fmi3GetContinuousStates(I, fmi3Float64 x[], size_t n) {
    if (n == STATES) memcpy(x, GEAR->state, sizeof GEAR->state);
    return ended(instance, n == STATES ? FINE : -1);
}
fmi3Status fmi3GetContinuousStateDerivatives(I, fmi3Float64 d[], size_t n) {
    return ended(instance, n == STATES ? gear_derivatives(GEAR, d) : -1);
}
fmi3Status fmi3GetEventIndicators(I, fmi3Float64 z[], size_t n) { return ended(instance, n ? -1 : FINE); }
fmi3Status fmi3GetNominalsOfContinuousStates(I, fmi3Float64 x[], size_t n) {
    for (size_t k = 0; k < n; k++) x[k] = gear_nominal(STATE + (unsigned)k);
    return ended(instance, n == STATES ? FINE : -1);
}
fmi3Status fmi3GetNumberOfEventIndicators(I, size_t *n) { *n = 0; return fmi3OK; }
fmi3Status fmi3GetNumberOfContinuousStates(I, size_t *n) { *n = STATES; return fmi3OK; }
/* --- co-simulation --- */
fmi3Status fmi3DoStep(I, fmi3Float64 time, fmi3Float64 step, fmi3Boolean no_return, fmi3Boolean *event,
                      fmi3Boolean *terminate, fmi3Boolean *early, fmi3Float64 *last) {
    int status = gear_set(GEAR, TIME, time);
    *event = *terminate = *early = fmi3False;
    if (!status) status = gear_step(GEAR, step);
    *last = GEAR->time;
    return ended(instance, status);
}
