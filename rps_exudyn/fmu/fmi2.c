/* FMI 2.0: co-simulation of the reduced gear. */
#include "fmi2Functions.h"
#include "instance.h"

#define C fmi2Component instance
#define R const fmi2ValueReference r[], size_t n
#define ONE ((Instance *)instance)
#define GEAR (&ONE->gear)
static fmi2Status ended(C, int status) {
    const fmi2CallbackFunctions *callback = ONE->environment;
    if (!status) return fmi2OK;
    if (callback && callback->logger)
        callback->logger(callback->componentEnvironment, ONE->name, fmi2Error, "error", "%s", sentence_of(ONE, status));
    return fmi2Error;
}
const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char *fmi2GetVersion(void) { return fmi2Version; }
fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions *callbacks, fmi2Boolean visible, fmi2Boolean logging) {
    return type == fmi2CoSimulation ? new_instance(name, guid, (void *)callbacks, NULL) : NULL;
}
void fmi2FreeInstance(C) { free(instance); }
fmi2Status fmi2Reset(C) { gear_reset(GEAR); return fmi2OK; }
fmi2Status fmi2Terminate(C) { return fmi2OK; }
fmi2Status fmi2EnterInitializationMode(C) { ONE->starts = 1; return fmi2OK; }
fmi2Status fmi2ExitInitializationMode(C) { return ended(instance, started(ONE)); }
fmi2Status fmi2SetupExperiment(C, fmi2Boolean tolerant, fmi2Real tolerance, fmi2Real start, fmi2Boolean stops,
                               fmi2Real stop) {
    return ended(instance, gear_set(GEAR, TIME, start));
}
fmi2Status fmi2SetDebugLogging(C, fmi2Boolean on, size_t n, const fmi2String categories[]) { return fmi2OK; }
fmi2Status fmi2GetReal(C, R, fmi2Real v[]) { return ended(instance, get_values(ONE, r, n, v)); }
fmi2Status fmi2SetReal(C, R, const fmi2Real v[]) { return ended(instance, set_values(ONE, r, n, v)); }
fmi2Status fmi2GetInteger(C, R, fmi2Integer v[]) { return ended(instance, get_choices(ONE, r, n, v)); }
fmi2Status fmi2SetInteger(C, R, const fmi2Integer v[]) { return ended(instance, set_choices(ONE, r, n, v)); }
/* what the model does not have */
#define NONE(name, ...) fmi2Status name(C, __VA_ARGS__) { return ended(instance, -1); }
NONE(fmi2GetBoolean, R, fmi2Boolean v[])
NONE(fmi2SetBoolean, R, const fmi2Boolean v[])
NONE(fmi2GetString, R, fmi2String v[])
NONE(fmi2SetString, R, const fmi2String v[])
NONE(fmi2SetRealInputDerivatives, R, const fmi2Integer o[], const fmi2Real v[])
NONE(fmi2GetRealOutputDerivatives, R, const fmi2Integer o[], fmi2Real v[])
NONE(fmi2GetStatus, const fmi2StatusKind k, fmi2Status *v)
NONE(fmi2GetRealStatus, const fmi2StatusKind k, fmi2Real *v)
NONE(fmi2GetIntegerStatus, const fmi2StatusKind k, fmi2Integer *v)
NONE(fmi2GetBooleanStatus, const fmi2StatusKind k, fmi2Boolean *v)
NONE(fmi2GetStringStatus, const fmi2StatusKind k, fmi2String *v)
fmi2Status fmi2CancelStep(C) { return ended(instance, -1); }
fmi2Status fmi2GetFMUstate(C, fmi2FMUstate *state) { return ended(instance, copied(state, GEAR, SAVED)); }
fmi2Status fmi2SetFMUstate(C, fmi2FMUstate state) { memcpy(GEAR, state, SAVED); return fmi2OK; }
fmi2Status fmi2FreeFMUstate(C, fmi2FMUstate *state) { free(*state); *state = NULL; return fmi2OK; }
fmi2Status fmi2SerializedFMUstateSize(C, fmi2FMUstate state, size_t *size) { *size = SAVED; return fmi2OK; }
fmi2Status fmi2SerializeFMUstate(C, fmi2FMUstate state, fmi2Byte bytes[], size_t size) {
    void *to = bytes;
    return ended(instance, copied(&to, state, size));
}
fmi2Status fmi2DeSerializeFMUstate(C, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state) {
    return ended(instance, copied(state, bytes, size));
}
fmi2Status fmi2GetDirectionalDerivative(C, R, const fmi2ValueReference known[], size_t m, const fmi2Real seed[],
                                        fmi2Real slope[]) {
    return ended(instance, gear_slope(GEAR, r, n, known, m, seed, slope));
}
fmi2Status fmi2DoStep(C, fmi2Real time, fmi2Real step, fmi2Boolean no_return) {
    int status = gear_set(GEAR, TIME, time);
    return ended(instance, status ? status : gear_step(GEAR, step));
}
