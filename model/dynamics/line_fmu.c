/* Line as Functional Mock-up Unit for co-simulation, FMI 2.0 and 3.0: the core, and the interface around it.
 *
 * The file `line.bin` of the resources is an image of the memory of one instance (`line_image.py`): its addresses count
 * from its start, and a table lists their places. Everything that a step changes is one block, so that a state is a copy
 * of this block. The value of a variable stands in `values` at its value reference.
 *
 * A head whose height is given has no mobility. A head whose force is given is nearly free of mass, and its motion is
 * begun anew in each step, so that it does not ring.
 */

#include "time_step.c"
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>

_Static_assert(sizeof(void *) == sizeof(int64_t), "the image has addresses of 64 bits");

typedef struct { Array values, heights, unloaded, start; int64_t force_given; } LineInterface;
typedef struct {
    int64_t bytes;
    KernelArrays kernel;
    Motion motion;
    Train train;
    Workspace work;
    Recording recording;
    LineInterface interface;
} LineArguments;
typedef struct {
    char token[64];
    int64_t mark, bytes, state, state_bytes, relocations, number;
    LineArguments line;
} Image;

typedef void (*LogOf2)(void *, const char *, int, const char *, const char *, ...);
typedef void (*LogOf3)(void *, int, const char *, const char *);
typedef struct { LogOf2 log; void *allocate, *release, *finished, *environment; } CallbacksOf2;
typedef struct {
    char name[128];
    void *environment, *memory;
    LogOf2 log_2;
    LogOf3 log_3;
    char *initial;
    Image *image;
    bool running; /* after the initialisation, when parameters are fixed */
} Model;
enum { OK = 0, ERROR = 3, TIME = 0, SPEED = 1, START = 2 };
static const int64_t MARK = 0x31454e494c544e50;

static int fail(const Model *m, const char *format, ...)
{
    char text[300];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (m->log_2)
        m->log_2(m->environment, m->name, ERROR, "logStatusError", "%s", text);
    if (m->log_3)
        m->log_3(m->environment, ERROR, "logStatusError", text);
    return ERROR;
}

/* Value references: those of start, travel and position of each pantograph, of height and force of each strip. */
static int64_t pantographs(const LineArguments *a) { return a->train.position.n[0]; }
static int64_t travel(const LineArguments *a) { return START + pantographs(a); }
static int64_t heights(const LineArguments *a) { return START + 3 * pantographs(a); }
static int64_t forces(const LineArguments *a) { return heights(a) + a->train.owner.n[0]; }
static int64_t given(const LineArguments *a) { return a->interface.force_given ? forces(a) : heights(a); }

static void write_outputs(LineArguments *a)
{
    double *values = a->interface.values.at;
    int64_t strips = a->train.owner.n[0], uplifts = forces(a) + strips;
    for (int64_t p = 0; p < pantographs(a); p++)
        values[START + 2 * pantographs(a) + p] = a->train.position.at[p];
    for (int64_t c = 0; c < strips; c++) {
        if (a->interface.force_given)
            values[heights(a) + c] = a->recording.height.at[c];
        else
            values[forces(a) + c] = a->recording.contact.at[c];
    }
    for (int64_t u = 0; u < a->recording.row.n[0]; u++)
        values[uplifts + u] = AT3(a->recording.motion, 0, u, 0);
}

static char *state_of(const Model *m) { return (char *)m->image + m->image->state; }

/* Begin anew with the present parameters and inputs; at another start than that of the image, the line is unloaded. */
static void place(Model *m)
{
    LineArguments *a = &m->image->line;
    const double *values = a->interface.values.at;
    int64_t kept = (char *)a->motion.w.at - state_of(m); /* the values are the first part of the state */
    bool moved = false;
    memcpy(state_of(m) + kept, m->initial + kept, (size_t)(m->image->state_bytes - kept));
    for (int64_t p = 0; p < pantographs(a); p++) {
        a->train.position.at[p] = values[START + p];
        moved = moved || a->train.position.at[p] != a->interface.start.at[p];
    }
    Array *cleared[] = {&a->motion.w, &a->motion.r, &a->train.contact, &a->recording.contact, &a->recording.motion};
    for (size_t k = 0; moved && k < sizeof cleared / sizeof *cleared; k++) {
        const int64_t *n = cleared[k]->n;
        memset(cleared[k]->at, 0, (size_t)(n[0] * n[1] * n[2] * n[3]) * sizeof(double));
    }
    if (moved)
        memcpy(a->motion.force.at, a->interface.unloaded.at, (size_t)a->motion.force.n[0] * sizeof(double));
    for (int64_t c = 0; c < a->train.owner.n[0] && !a->interface.force_given; c++)
        AT2(a->interface.heights, 0, c) = AT2(a->interface.heights, 1, c) = values[heights(a) + c];
    write_outputs(a);
}

static int reset(Model *m)
{
    memcpy(state_of(m), m->initial, (size_t)m->image->state_bytes);
    m->running = false;
    return OK;
}

/* Prepare a strip for a step in which its height or force covers a share of its way to the given value. */
static void prepare_strip(LineArguments *a, int64_t c, double share)
{
    Train *train = &a->train;
    double dt = a->kernel.time_step, goal = a->interface.values.at[given(a) + c];
    double last = AT2(a->interface.heights, 0, c), before = AT2(a->interface.heights, 1, c), height = last;
    int64_t p = train->owner.at[c], i = c - train->first_strip.at[p];
    double *force = &AT2(train->force, p, i), rate = (last - before) / dt;
    if (a->interface.force_given) {
        *force += (goal - *force) * share;
        height = last + dt * rate;
    } else {
        height = last + (goal - last) * share;
        rate = (3 * height - 4 * last + before) / (2 * dt);
    }
    AT3(train->z, 0, p, i) = height - dt * rate;
    AT3(train->z, 1, p, i) = rate;
    AT3(train->z, 2, p, i) = 0.0;
}

static int advance(Model *m, double time, double length)
{
    LineArguments *a = &m->image->line;
    double *values = a->interface.values.at, dt = a->kernel.time_step, end = a->train.elapsed.at[0] + length;
    const Array *line = &a->kernel.contact.position;
    int64_t steps = llround(length / dt), strips = a->train.owner.n[0];
    if (steps < 1 || fabs((double)steps * dt - length) > 1e-6 * dt)
        return fail(m, "a step of %g s is no multiple of the time step of the line, %g s", length, dt);
    if (fabs(time - values[TIME]) > 1e-6 * dt)
        return fail(m, "a step begins at %g s, but the last one ended at %g s", time, values[TIME]);
    for (int64_t left = steps; left > 0; left--) {
        for (int64_t p = 0; p < pantographs(a); p++) {
            double goal = values[START + p] + values[SPEED] * end + values[travel(a) + p];
            double change = (goal - a->train.position.at[p]) / (double)left;
            if (p == 0)
                a->train.speed.at[0] = change / dt;
            a->train.position.at[p] += change - dt * a->train.speed.at[0];
        }
        for (int64_t c = 0; c < strips; c++) {
            double x = a->train.position.at[a->train.owner.at[c]] + a->train.offset.at[c] + dt * a->train.speed.at[0];
            if (!(line->at[0] <= x && x <= line->at[line->n[0] - 1]))
                return fail(m, "a strip leaves the line at %g m", x);
            prepare_strip(a, c, 1.0 / (double)left);
        }
        if (step(&a->kernel, &a->motion, &a->train, &a->work) == 0)
            return fail(m, "the forces of the step that ends at %g s did not converge", time + length);
        for (int64_t c = 0; c < strips; c++) {
            int64_t p = a->train.owner.at[c];
            AT2(a->interface.heights, 1, c) = AT2(a->interface.heights, 0, c);
            AT2(a->interface.heights, 0, c) = AT3(a->train.z, 0, p, c - a->train.first_strip.at[p]);
        }
    }
    values[TIME] = time + length;
    record(&a->kernel, &a->kernel.window, &a->motion, &a->train, &a->work, &a->recording, 0);
    write_outputs(a);
    return OK;
}

static int get(const Model *m, const unsigned *references, size_t number, double *x)
{
    const Array *values = &m->image->line.interface.values;
    for (size_t i = 0; i < number; i++) {
        if (references[i] >= values->n[0])
            return fail(m, "there is no variable with the value reference %u", references[i]);
        x[i] = values->at[references[i]];
    }
    return OK;
}

static int set(Model *m, const unsigned *references, size_t number, const double *x)
{
    LineArguments *a = &m->image->line;
    for (size_t i = 0; i < number; i++) {
        int64_t r = references[i], first = m->running ? travel(a) : SPEED;
        bool is_input = given(a) <= r && r < given(a) + a->train.owner.n[0];
        if (!is_input && !(first <= r && r < travel(a) + pantographs(a)))
            return fail(m, "the variable with the value reference %u cannot be set now", references[i]);
        if (!isfinite(x[i]))
            return fail(m, "the variable with the value reference %u is set to %g", references[i], x[i]);
        a->interface.values.at[r] = x[i];
    }
    if (!m->running)
        place(m);
    return OK;
}

static int save(Model *m, void **state)
{
    if (!*state && !(*state = malloc((size_t)m->image->state_bytes)))
        return fail(m, "no memory for a state");
    memcpy(*state, state_of(m), (size_t)m->image->state_bytes);
    return OK;
}

static int restore(Model *m, const void *state)
{
    memcpy(state_of(m), state, (size_t)m->image->state_bytes);
    return OK;
}

static int release(void **state)
{
    free(*state);
    *state = NULL;
    return OK;
}

static int begin(Model *m, double time)
{
    m->image->line.interface.values.at[TIME] = time;
    return OK;
}

static void destroy(Model *m)
{
    if (m) {
        free(m->initial);
        free(m->memory);
    }
    free(m);
}

static const char *load_image(Model *m, const char *token, const char *path)
{
    Image head;
    FILE *file = fopen(path, "rb");
    if (!file)
        return "cannot be opened";
    bool valid = fread(&head, sizeof head, 1, file) == 1 && head.mark == MARK &&
                 head.line.bytes == (int64_t)sizeof head.line && token && strlen(token) == sizeof head.token &&
                 memcmp(token, head.token, sizeof head.token) == 0;
    if (valid && (m->memory = malloc((size_t)head.bytes + 64))) {
        m->image = (Image *)(((uintptr_t)m->memory + 63) & ~(uintptr_t)63);
        rewind(file);
        valid = fread(m->image, (size_t)head.bytes, 1, file) == 1;
    }
    fclose(file);
    if (!valid || !m->memory || !(m->initial = malloc((size_t)head.state_bytes)))
        return valid ? "does not fit into the memory" : "is not that of this model description";
    char *base = (char *)m->image;
    for (int64_t n = 0; n < head.number; n++) {
        int64_t place, address;
        memcpy(&place, base + head.relocations + 8 * n, 8);
        memcpy(&address, base + place, 8);
        address += (int64_t)(intptr_t)base;
        memcpy(base + place, &address, 8);
    }
    memcpy(m->initial, state_of(m), (size_t)head.state_bytes);
    return NULL;
}

static Model *instantiate(const char *name, const char *token, const char *folder, LogOf2 log_2, LogOf3 log_3,
                          void *environment)
{
    char path[4096];
    Model *m = calloc(1, sizeof *m);
    if (!m)
        return NULL;
    snprintf(m->name, sizeof m->name, "%s", name ? name : "");
    m->log_2 = log_2, m->log_3 = log_3, m->environment = environment;
    snprintf(path, sizeof path, "%s/line.bin", folder ? folder : ".");
    const char *reason = load_image(m, token, path);
    if (reason) {
        fail(m, "%.200s %s", path, reason);
        destroy(m);
        return NULL;
    }
    return m;
}

/* Path of a URI of a file: without scheme and host, and with its escaped characters. */
static void decode_uri(const char *uri, char *path, size_t size)
{
    size_t n = 0;
    if (strncmp(uri, "file:", 5) == 0)
        uri += 5;
    if (strncmp(uri, "//", 2) == 0)
        uri += 2 + strcspn(uri + 2, "/");
    if (uri[0] == '/' && uri[1] && uri[2] == ':')
        uri++; /* Windows: /C:/folder */
    for (; *uri && n + 1 < size; uri++) {
        unsigned code;
        if (*uri == '%' && sscanf(uri + 1, "%2x", &code) == 1) {
            path[n++] = (char)code;
            uri += 2;
        } else {
            path[n++] = *uri;
        }
    }
    path[n] = '\0';
}

/* --------------------------------------------------------------------------------------------------------- interface
 *
 * Functions of FMI by name. Types of the headers of FMI appear as the types of C that they are.
 */

#define FMI EXPORT int
EXPORT const char *fmi2GetVersion(void) { return "2.0"; }
EXPORT const char *fmi3GetVersion(void) { return "3.0"; }
EXPORT const char *fmi2GetTypesPlatform(void) { return "default"; }
EXPORT Model *fmi2Instantiate(const char *name, int kind, const char *token, const char *uri, const CallbacksOf2 *calls,
                              int visible, int logging)
{
    char folder[4000];
    (void)visible, (void)logging;
    decode_uri(uri ? uri : "", folder, sizeof folder);
    return kind == 1 ? instantiate(name, token, folder, calls ? calls->log : NULL, NULL,
                                   calls ? calls->environment : NULL) : NULL;
}
EXPORT Model *fmi3InstantiateCoSimulation(const char *name, const char *token, const char *folder, bool visible,
                                          bool logging, bool events, bool early, const unsigned *intermediate,
                                          size_t number, void *environment, LogOf3 log, void *update)
{
    (void)visible, (void)logging, (void)events, (void)early, (void)intermediate, (void)number, (void)update;
    return instantiate(name, token, folder, NULL, log, environment);
}
#define OF_BOTH(name, arguments, ...)                                                                                  \
    FMI fmi2##name arguments { __VA_ARGS__ }                                                                           \
    FMI fmi3##name arguments { __VA_ARGS__ }
OF_BOTH(SetDebugLogging, (Model *m, int on, size_t n, const char **names), (void)m, (void)on, (void)n, (void)names;
        return OK;)
OF_BOTH(ExitInitializationMode, (Model *m), place(m); m->running = true; return OK;)
OF_BOTH(Terminate, (Model *m), (void)m; return OK;)
OF_BOTH(Reset, (Model *m), return reset(m);)
EXPORT void fmi2FreeInstance(Model *m) { destroy(m); }
EXPORT void fmi3FreeInstance(Model *m) { destroy(m); }
FMI fmi2SetupExperiment(Model *m, int tolerant, double tolerance, double time, int ends, double stop)
{
    (void)tolerant, (void)tolerance, (void)ends, (void)stop;
    return begin(m, time);
}
FMI fmi2EnterInitializationMode(Model *m) { (void)m; return OK; }
FMI fmi3EnterInitializationMode(Model *m, bool tolerant, double tolerance, double time, bool ends, double stop)
{
    (void)tolerant, (void)tolerance, (void)ends, (void)stop;
    return begin(m, time);
}
FMI fmi2GetReal(Model *m, const unsigned *r, size_t n, double *x) { return get(m, r, n, x); }
FMI fmi2SetReal(Model *m, const unsigned *r, size_t n, const double *x) { return set(m, r, n, x); }
FMI fmi3GetFloat64(Model *m, const unsigned *r, size_t n, double *x, size_t k) { (void)k; return get(m, r, n, x); }
FMI fmi3SetFloat64(Model *m, const unsigned *r, size_t n, const double *x, size_t k)
{
    (void)k;
    return set(m, r, n, x);
}
FMI fmi2DoStep(Model *m, double time, double length, int keep) { (void)keep; return advance(m, time, length); }
FMI fmi3DoStep(Model *m, double time, double length, bool keep, bool *event, bool *end, bool *early, double *last)
{
    (void)keep;
    *event = *end = *early = false;
    int status = advance(m, time, length);
    *last = m->image->line.interface.values.at[TIME];
    return status;
}
FMI fmi2GetFMUstate(Model *m, void **state) { return save(m, state); }
FMI fmi3GetFMUState(Model *m, void **state) { return save(m, state); }
FMI fmi2SetFMUstate(Model *m, void *state) { return restore(m, state); }
FMI fmi3SetFMUState(Model *m, void *state) { return restore(m, state); }
FMI fmi2FreeFMUstate(Model *m, void **state) { (void)m; return release(state); }
FMI fmi3FreeFMUState(Model *m, void **state) { (void)m; return release(state); }

/* Functions that FMI demands, of capabilities that the model description denies. Their first argument is the instance. */
#define DENIED(name)                                                                                                   \
    FMI name(const Model *m) { return fail(m, "this line has no " #name); }
DENIED(fmi2GetInteger) DENIED(fmi2GetBoolean) DENIED(fmi2GetString) DENIED(fmi2SetInteger) DENIED(fmi2SetBoolean)
DENIED(fmi2SetString) DENIED(fmi2SerializedFMUstateSize) DENIED(fmi2SerializeFMUstate)
DENIED(fmi2DeSerializeFMUstate) DENIED(fmi2GetDirectionalDerivative) DENIED(fmi2SetRealInputDerivatives)
DENIED(fmi2GetRealOutputDerivatives) DENIED(fmi2CancelStep) DENIED(fmi2GetStatus) DENIED(fmi2GetRealStatus)
DENIED(fmi2GetIntegerStatus) DENIED(fmi2GetBooleanStatus) DENIED(fmi2GetStringStatus)
DENIED(fmi3GetFloat32) DENIED(fmi3GetInt8) DENIED(fmi3GetUInt8) DENIED(fmi3GetInt16) DENIED(fmi3GetUInt16)
DENIED(fmi3GetInt32) DENIED(fmi3GetUInt32) DENIED(fmi3GetInt64) DENIED(fmi3GetUInt64) DENIED(fmi3GetBoolean)
DENIED(fmi3GetString) DENIED(fmi3GetBinary) DENIED(fmi3GetClock) DENIED(fmi3SetFloat32) DENIED(fmi3SetInt8)
DENIED(fmi3SetUInt8) DENIED(fmi3SetInt16) DENIED(fmi3SetUInt16) DENIED(fmi3SetInt32) DENIED(fmi3SetUInt32)
DENIED(fmi3SetInt64) DENIED(fmi3SetUInt64) DENIED(fmi3SetBoolean) DENIED(fmi3SetString) DENIED(fmi3SetBinary)
DENIED(fmi3SetClock) DENIED(fmi3GetNumberOfVariableDependencies) DENIED(fmi3GetVariableDependencies)
DENIED(fmi3SerializedFMUStateSize) DENIED(fmi3SerializeFMUState) DENIED(fmi3DeserializeFMUState)
DENIED(fmi3GetDirectionalDerivative) DENIED(fmi3GetAdjointDerivative) DENIED(fmi3EnterConfigurationMode)
DENIED(fmi3ExitConfigurationMode) DENIED(fmi3GetIntervalDecimal) DENIED(fmi3GetIntervalFraction)
DENIED(fmi3GetShiftDecimal) DENIED(fmi3GetShiftFraction) DENIED(fmi3SetIntervalDecimal)
DENIED(fmi3SetIntervalFraction) DENIED(fmi3SetShiftDecimal) DENIED(fmi3SetShiftFraction)
DENIED(fmi3EvaluateDiscreteStates) DENIED(fmi3UpdateDiscreteStates) DENIED(fmi3EnterEventMode)
DENIED(fmi3EnterStepMode) DENIED(fmi3GetOutputDerivatives) DENIED(fmi3ActivateModelPartition)
EXPORT Model *fmi3InstantiateModelExchange(void) { return NULL; }
EXPORT Model *fmi3InstantiateScheduledExecution(void) { return NULL; }
/* Functions of model exchange, which importers of FMI 3.0 may look for. */
DENIED(fmi3EnterContinuousTimeMode) DENIED(fmi3CompletedIntegratorStep) DENIED(fmi3SetTime)
DENIED(fmi3SetContinuousStates) DENIED(fmi3GetContinuousStateDerivatives) DENIED(fmi3GetEventIndicators)
DENIED(fmi3GetContinuousStates) DENIED(fmi3GetNominalsOfContinuousStates) DENIED(fmi3GetNumberOfEventIndicators)
DENIED(fmi3GetNumberOfContinuousStates)
