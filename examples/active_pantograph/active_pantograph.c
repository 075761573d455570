/* Active pantograph as FMU for co-simulation, FMI 2.0: two masses, and a skyhook law on the frame.

       contact force          The actuator pushes the frame with -gain * (velocity of the frame), so that the frame is
            |                 damped as by a damper to the sky (Karnopp, Crosby and Harwood 1974,
          head   7.2 kg       doi:10.1115/1.3438373). It obeys a command `delay` seconds late, and gives `limit` newtons
      4200 N/m, 10 N s/m      at most.
          frame  15 kg
      50 N/m, 90 N s/m
     base, uplift force and actuator

   `build.py` makes the archive. Heights count from the working height, upwards. A step is divided into parts of at most
   PART_S; the actuator holds its force over each, and the midpoint rule moves both masses. */

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PART_S 0.25e-3
enum { PARTS = 512 }; /* the longest delay is 128 ms */
static const double mass[2] = {15.0, 7.2}, spring[2] = {50.0, 4200.0}, damper[2] = {90.0, 10.0};

/* Value references are the places of these members. */
typedef struct {
    double contact_force, uplift_force, gain, delay, limit, head_height, actuator_force;
    double z[2], v[2], commands[PARTS];
} Model;
enum { INPUTS = 5, VARIABLES = 7 };

static void advance_part(Model *m, double h)
{
    int late = (int)round(m->delay / PART_S);
    memmove(m->commands + 1, m->commands, sizeof m->commands - sizeof *m->commands);
    m->commands[0] = -m->gain * m->v[0];
    m->actuator_force = fmax(fmin(m->commands[late < PARTS ? late : PARTS - 1], m->limit), -m->limit);

    double k[2][2] = {{spring[0] + spring[1], -spring[1]}, {-spring[1], spring[1]}};
    double c[2][2] = {{damper[0] + damper[1], -damper[1]}, {-damper[1], damper[1]}};
    double force[2] = {m->uplift_force + m->actuator_force, -m->contact_force}, a[2][2], b[2], mean[2];
    for (int i = 0; i < 2; i++) {
        b[i] = mass[i] * m->v[i] + h / 2 * (force[i] - k[i][0] * m->z[0] - k[i][1] * m->z[1]);
        for (int j = 0; j < 2; j++)
            a[i][j] = (i == j) * mass[i] + h / 2 * c[i][j] + h * h / 4 * k[i][j];
    }
    double determinant = a[0][0] * a[1][1] - a[0][1] * a[1][0];
    mean[0] = (b[0] * a[1][1] - b[1] * a[0][1]) / determinant;
    mean[1] = (b[1] * a[0][0] - b[0] * a[1][0]) / determinant;
    for (int i = 0; i < 2; i++) {
        m->z[i] += h * mean[i];
        m->v[i] = 2 * mean[i] - m->v[i];
    }
}


Model *fmi2Instantiate(void)
{
    Model *m = calloc(1, sizeof *m);
    if (m) {
        m->uplift_force = 120.0;
        m->gain = 60.0;
        m->delay = 0.012;
        m->limit = 50.0;
    }
    return m;
}
void fmi2FreeInstance(Model *m) { free(m); }
int fmi2SetupExperiment(void) { return 0; }
int fmi2EnterInitializationMode(void) { return 0; }
int fmi2ExitInitializationMode(Model *m)
{
    m->z[0] = m->uplift_force / spring[1]; /* the head is at its working height, and presses on its spring */
    return 0;
}
int fmi2Terminate(void) { return 0; }

int fmi2SetReal(Model *m, const unsigned *number, size_t n, const double *value)
{
    for (size_t i = 0; i < n; i++) {
        if (number[i] >= INPUTS || !isfinite(value[i]))
            return 3;
        (&m->contact_force)[number[i]] = value[i];
    }
    return 0;
}

int fmi2GetReal(Model *m, const unsigned *number, size_t n, double *value)
{
    m->head_height = m->z[1];
    for (size_t i = 0; i < n; i++) {
        if (number[i] >= VARIABLES)
            return 3;
        value[i] = (&m->contact_force)[number[i]];
    }
    return 0;
}

int fmi2DoStep(Model *m, double time, double step, int keep)
{
    (void)time, (void)keep;
    int parts = (int)ceil(step / PART_S - 1e-9);
    for (int n = 0; n < parts; n++)
        advance_part(m, step / parts);
    return 0;
}

int fmi2GetFMUstate(Model *m, void **state)
{
    if (!*state && !(*state = malloc(sizeof *m)))
        return 3;
    memcpy(*state, m, sizeof *m);
    return 0;
}
int fmi2SetFMUstate(Model *m, const void *state)
{
    memcpy(m, state, sizeof *m);
    return 0;
}
int fmi2FreeFMUstate(Model *m, void **state)
{
    (void)m;
    free(*state);
    *state = NULL;
    return 0;
}

/* Functions of FMI 2.0 that this model does not need; importers may look for them. */
#define UNUSED(name) \
    int name(void) { return 3; }
UNUSED(fmi2Reset) UNUSED(fmi2SetDebugLogging) UNUSED(fmi2CancelStep) UNUSED(fmi2GetInteger) UNUSED(fmi2SetInteger)
UNUSED(fmi2GetBoolean) UNUSED(fmi2SetBoolean) UNUSED(fmi2GetString) UNUSED(fmi2SetString) UNUSED(fmi2GetStatus)
UNUSED(fmi2GetRealStatus) UNUSED(fmi2GetIntegerStatus) UNUSED(fmi2GetBooleanStatus) UNUSED(fmi2GetStringStatus)
UNUSED(fmi2SerializedFMUstateSize) UNUSED(fmi2SerializeFMUstate) UNUSED(fmi2DeSerializeFMUstate)
UNUSED(fmi2GetDirectionalDerivative) UNUSED(fmi2SetRealInputDerivatives) UNUSED(fmi2GetRealOutputDerivatives)
const char *fmi2GetTypesPlatform(void) { return "default"; }
const char *fmi2GetVersion(void) { return "2.0"; }
