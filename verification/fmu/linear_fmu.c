/* Linear pantograph as FMU of FMI 2.0 and 3.0, for co-simulation and model exchange, with faults on request.
   model.h: UNKNOWNS, STRIPS, and z'' = rest + uplift*(lift + control) - k z - c v - drive F; heads z; start.
   control = -skyhook * velocity of the point of the uplift force, late by `delay` steps, at most `limit`. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "model.h"

typedef struct {
    double time, force[2], lift, fault, substeps, old[2][2], z[UNKNOWNS], v[UNKNOWNS];
    double skyhook, delay, limit, control, past[64];
} Model;
enum { FORCE = 0, LIFT = 2, FAULT = 3, SUBSTEPS = 4, HEIGHT = 5, STATE = 7, SKYHOOK = 900, LATE, LIMIT };
enum { SIGN = 1, DELAY, ENERGY, CRASH, HANG, NOT_A_NUMBER, NOISE, ABORT, MEMORY };

static void slope(const Model *m, const double *z, const double *v, double *a) {
    for (int i = 0; i < UNKNOWNS; i++) {
        a[i] = rest[i] + uplift[i] * (m->lift + m->control);
        for (int s = 0; s < STRIPS; s++) {
            double f = m->force[s] * (m->fault == SIGN ? -1 : 1);
            if (m->fault == ENERGY) for (int j = 0; j < UNKNOWNS; j++) f -= 150.0 * heads[s][j] * v[j];
            a[i] -= drive[i][s] * f;
        }
        for (int j = 0; j < UNKNOWNS; j++) a[i] -= stiffness[i][j] * z[j] + damping[i][j] * v[j];
    }
}

static void midpoint(Model *m, double h) {
    double matrix[UNKNOWNS][UNKNOWNS + 1], zero[UNKNOWNS] = {0}, a[UNKNOWNS];
    slope(m, m->z, zero, a);
    for (int i = 0; i < UNKNOWNS; i++) {
        for (int j = 0; j < UNKNOWNS; j++)
            matrix[i][j] = (i == j) + h / 2 * damping[i][j] + h * h / 4 * stiffness[i][j];
        if (m->fault == ENERGY)
            for (int j = 0; j < UNKNOWNS; j++)
                for (int s = 0; s < STRIPS; s++) matrix[i][j] -= h / 2 * 150.0 * drive[i][s] * heads[s][j];
        matrix[i][UNKNOWNS] = m->v[i] + h / 2 * a[i];
    }
    for (int i = 0; i < UNKNOWNS; i++)
        for (int k = 0; k < UNKNOWNS; k++)
            if (k != i) {
                double f = matrix[k][i] / matrix[i][i];
                for (int j = i; j <= UNKNOWNS; j++) matrix[k][j] -= f * matrix[i][j];
            }
    for (int i = 0; i < UNKNOWNS; i++) {
        double mean = matrix[i][UNKNOWNS] / matrix[i][i];
        m->z[i] += h * mean;
        m->v[i] = 2 * mean - m->v[i];
    }
}

static double head(const Model *m, int strip) {
    double height = 0;
    for (int i = 0; i < UNKNOWNS; i++) height += heads[strip][i] * m->z[i];
    return height;
}

static int advance(Model *m, double h) {
    for (int s = 0; s < STRIPS; s++) {
        m->old[1][s] = m->old[0][s];
        m->old[0][s] = head(m, s);
    }
    for (int k = 63; k > 0; k--) m->past[k] = m->past[k - 1];
    m->past[0] = 0;
    for (int i = 0; i < UNKNOWNS; i++) m->past[0] += point[i] * m->v[i];
    m->control = fmax(fmin(-m->skyhook * m->past[(int)m->delay & 63], m->limit), -m->limit);
    for (int k = 0; k < (int)m->substeps; k++) midpoint(m, h / m->substeps);
    m->time += h;
    if (m->time > 0.05) {
        if (m->fault == MEMORY) while (malloc(1 << 28)) {}
        if (m->fault == CRASH || m->fault == MEMORY) *(volatile int *)0 = 1;
        if (m->fault == ABORT) return 3;
        while (m->fault == HANG) {}
    }
    if (m->fault == NOISE) for (int i = 0; i < UNKNOWNS; i++) m->z[i] += 1e-7 * (rand() % 1000);
    return 0;
}

static int get(const Model *m, const unsigned *r, size_t n, double *x) {
    double a[UNKNOWNS];
    slope(m, m->z, m->v, a);
    for (size_t i = 0; i < n; i++) {
        int k = (int)r[i] - STATE, s = (int)r[i] - HEIGHT;
        if (r[i] == LIFT) x[i] = m->lift;
        else if (r[i] < LIFT) x[i] = m->force[r[i]];
        else if (r[i] == FAULT) x[i] = m->fault;
        else if (r[i] == SUBSTEPS) x[i] = m->substeps;
        else if (k < 0) x[i] = 1000 * (m->fault == DELAY ? m->old[0][s] : head(m, s));
        else if (k < UNKNOWNS) x[i] = m->z[k];
        else if (k < 2 * UNKNOWNS) x[i] = m->v[k - UNKNOWNS];
        else if (k < 3 * UNKNOWNS) x[i] = m->v[k - 2 * UNKNOWNS];
        else x[i] = a[k - 3 * UNKNOWNS];
        if (k < 0 && s >= 0 && m->fault == NOT_A_NUMBER && m->time > 0.05) x[i] = NAN;
    }
    return 0;
}

static int set(Model *m, const unsigned *r, size_t n, const double *x) {
    for (size_t i = 0; i < n; i++) {
        if (r[i] < LIFT) m->force[r[i]] = x[i];
        else if (r[i] == LIFT) m->lift = x[i];
        else if (r[i] == FAULT) m->fault = x[i];
        else if (r[i] == SUBSTEPS) m->substeps = x[i];
        else if (r[i] == SKYHOOK) m->skyhook = x[i];
        else if (r[i] == LATE) m->delay = x[i];
        else if (r[i] == LIMIT) m->limit = x[i];
        else return 3;
    }
    return 0;
}

static Model *create(void) {
    Model *m = calloc(1, sizeof(Model));
    m->lift = 120.0;
    m->substeps = 1;
    memcpy(m->z, start, sizeof start);
    for (int s = 0; s < STRIPS; s++) m->old[0][s] = m->old[1][s] = head(m, s);
    return m;
}

static int save(Model *m, void **state) {
    if (!*state) *state = malloc(sizeof(Model));
    memcpy(*state, m, sizeof(Model));
    return 0;
}

static int drop(void **state) {
    free(*state);
    *state = 0;
    return 0;
}

static int read_states(Model *m, double *x, size_t n) {
    memcpy(x, m->z, n / 2 * sizeof *x);
    memcpy(x + n / 2, m->v, n / 2 * sizeof *x);
    return 0;
}

static int write_states(Model *m, const double *x, size_t n) {
    memcpy(m->z, x, n / 2 * sizeof *x);
    memcpy(m->v, x + n / 2, n / 2 * sizeof *x);
    return 0;
}

static int derivatives(Model *m, double *x, size_t n) {
    memcpy(x, m->v, n / 2 * sizeof *x);
    slope(m, m->z, m->v, x + n / 2);
    return 0;
}

#define BOTH(name, arguments, ...) \
    int fmi2##name arguments { __VA_ARGS__ } \
    int fmi3##name arguments { __VA_ARGS__ }

BOTH(ExitInitializationMode, (Model *m), (void)m; return 0;)
BOTH(Terminate, (Model *m), (void)m; return 0;)
BOTH(SetTime, (Model *m, double t), m->time = t; return 0;)
BOTH(EnterEventMode, (Model *m), (void)m; return 0;)
BOTH(EnterContinuousTimeMode, (Model *m), (void)m; return 0;)
BOTH(GetContinuousStates, (Model *m, double *x, size_t n), return read_states(m, x, n);)
BOTH(SetContinuousStates, (Model *m, const double *x, size_t n), return write_states(m, x, n);)
void *fmi2Instantiate(const char *name, int kind, const char *id, const char *place, void *calls, int a, int b) {
    (void)name, (void)kind, (void)id, (void)place, (void)calls, (void)a, (void)b;
    return create();
}
void fmi2FreeInstance(Model *m) { free(m); }
int fmi2SetupExperiment(Model *m, int a, double b, double c, int d, double e) {
    (void)m, (void)a, (void)b, (void)c, (void)d, (void)e;
    return 0;
}
int fmi2EnterInitializationMode(Model *m) { (void)m; return 0; }
int fmi2GetReal(Model *m, const unsigned *r, size_t n, double *x) { return get(m, r, n, x); }
int fmi2SetReal(Model *m, const unsigned *r, size_t n, const double *x) { return set(m, r, n, x); }
int fmi2DoStep(Model *m, double t, double h, int keep) { (void)t, (void)keep; return advance(m, h); }
int fmi2GetFMUstate(Model *m, void **state) { return save(m, state); }
int fmi2SetFMUstate(Model *m, void *state) { memcpy(m, state, sizeof *m); return 0; }
int fmi2FreeFMUstate(Model *m, void **state) { (void)m; return drop(state); }
int fmi2GetDerivatives(Model *m, double *x, size_t n) { return derivatives(m, x, n); }
int fmi2NewDiscreteStates(Model *m, int *info) { (void)m; memset(info, 0, 5 * sizeof *info); return 0; }
int fmi2CompletedIntegratorStep(Model *m, int keep, int *event, int *end) {
    (void)m, (void)keep;
    *event = *end = 0;
    return 0;
}

void *fmi3InstantiateCoSimulation(const char *name) { (void)name; return create(); }
void *fmi3InstantiateModelExchange(const char *name) { (void)name; return create(); }
void fmi3FreeInstance(Model *m) { free(m); }
int fmi3EnterInitializationMode(Model *m) { (void)m; return 0; }
int fmi3GetFloat64(Model *m, const unsigned *r, size_t n, double *x, size_t k) { (void)k; return get(m, r, n, x); }
int fmi3SetFloat64(Model *m, const unsigned *r, size_t n, const double *x, size_t k) { (void)k; return set(m, r, n, x); }
int fmi3DoStep(Model *m, double t, double h, _Bool keep, _Bool *event, _Bool *end, _Bool *early, double *last) {
    (void)keep;
    *event = *end = *early = 0;
    *last = t + h;
    return advance(m, h);
}
int fmi3GetFMUState(Model *m, void **state) { return save(m, state); }
int fmi3SetFMUState(Model *m, void *state) { memcpy(m, state, sizeof *m); return 0; }
int fmi3FreeFMUState(Model *m, void **state) { (void)m; return drop(state); }
int fmi3GetContinuousStateDerivatives(Model *m, double *x, size_t n) { return derivatives(m, x, n); }
int fmi3GetNumberOfContinuousStates(Model *m, size_t *n) { (void)m; *n = 2 * UNKNOWNS; return 0; }
int fmi3GetNumberOfEventIndicators(Model *m, size_t *n) { (void)m; *n = 0; return 0; }
int fmi3UpdateDiscreteStates(Model *m, _Bool *a, _Bool *b, _Bool *c, _Bool *d, _Bool *e, double *next) {
    (void)m;
    *a = *b = *c = *d = *e = 0;
    *next = 0;
    return 0;
}
int fmi3CompletedIntegratorStep(Model *m, _Bool keep, _Bool *event, _Bool *end) {
    (void)m, (void)keep;
    *event = *end = 0;
    return 0;
}

/* Functions that importers load and do not call here. */
#define NONE(name) int name(void) { return 3; }
NONE(fmi2CancelStep) NONE(fmi2DeSerializeFMUstate) NONE(fmi2GetBoolean) NONE(fmi2GetBooleanStatus)
NONE(fmi2GetDirectionalDerivative) NONE(fmi2GetEventIndicators) NONE(fmi2GetInteger) NONE(fmi2GetIntegerStatus)
NONE(fmi2GetNominalsOfContinuousStates) NONE(fmi2GetRealOutputDerivatives) NONE(fmi2GetRealStatus)
NONE(fmi2GetStatus) NONE(fmi2GetString) NONE(fmi2GetStringStatus) NONE(fmi2GetTypesPlatform) NONE(fmi2GetVersion)
NONE(fmi2Reset) NONE(fmi2SerializeFMUstate) NONE(fmi2SerializedFMUstateSize) NONE(fmi2SetBoolean)
NONE(fmi2SetDebugLogging) NONE(fmi2SetInteger) NONE(fmi2SetRealInputDerivatives) NONE(fmi2SetString)
NONE(fmi3ActivateModelPartition) NONE(fmi3DeserializeFMUState) NONE(fmi3EnterConfigurationMode)
NONE(fmi3EnterStepMode) NONE(fmi3EvaluateDiscreteStates) NONE(fmi3ExitConfigurationMode)
NONE(fmi3GetAdjointDerivative) NONE(fmi3GetBinary) NONE(fmi3GetBoolean) NONE(fmi3GetClock)
NONE(fmi3GetDirectionalDerivative) NONE(fmi3GetEventIndicators) NONE(fmi3GetFloat32) NONE(fmi3GetInt16)
NONE(fmi3GetInt32) NONE(fmi3GetInt64) NONE(fmi3GetInt8) NONE(fmi3GetIntervalDecimal) NONE(fmi3GetIntervalFraction)
NONE(fmi3GetNominalsOfContinuousStates) NONE(fmi3GetNumberOfVariableDependencies) NONE(fmi3GetOutputDerivatives)
NONE(fmi3GetShiftDecimal) NONE(fmi3GetShiftFraction) NONE(fmi3GetString) NONE(fmi3GetUInt16) NONE(fmi3GetUInt32)
NONE(fmi3GetUInt64) NONE(fmi3GetUInt8) NONE(fmi3GetVariableDependencies) NONE(fmi3GetVersion)
NONE(fmi3InstantiateScheduledExecution) NONE(fmi3Reset) NONE(fmi3SerializeFMUState) NONE(fmi3SerializedFMUStateSize)
NONE(fmi3SetBinary) NONE(fmi3SetBoolean) NONE(fmi3SetClock) NONE(fmi3SetDebugLogging) NONE(fmi3SetFloat32)
NONE(fmi3SetInt16) NONE(fmi3SetInt32) NONE(fmi3SetInt64) NONE(fmi3SetInt8) NONE(fmi3SetIntervalDecimal)
NONE(fmi3SetIntervalFraction) NONE(fmi3SetShiftDecimal) NONE(fmi3SetShiftFraction) NONE(fmi3SetString)
NONE(fmi3SetUInt16) NONE(fmi3SetUInt32) NONE(fmi3SetUInt64) NONE(fmi3SetUInt8)
