/* Time step of a line under pantographs: the core in C. C11 with the vector types of GCC and Clang, no other library.
 *
 * The theory is in the Python files of this folder: every function here has the name of its twin there, which is the
 * readable form and the oracle of the tests. The structures are the named tuples of these files, field by field.
 *
 * There is no state of its own: a caller owns all arrays. The state of a simulation is `Motion` and `Train`; who copies
 * their arrays saves it, and who writes them back restores it. `Workspace` is scratch memory of one simulation, so that
 * simulations in several threads do not touch each other. Nothing allocates memory.
 *
 * Products and sums are rounded one by one (no contraction), and vectors are added in a fixed order: the bits of a
 * result depend on the source and on cos() and pow() of the system, not on the vector instructions of a processor.
 */

#include <math.h>
#include <stdint.h>
#include <string.h>

#if defined(__clang__)
#pragma STDC FP_CONTRACT OFF
#elif defined(__GNUC__)
#pragma GCC optimize("fp-contract=off")
#else
#error "the core needs the vector types of GCC or Clang"
#endif

#define EXPORT __attribute__((visibility("default")))
/* ------------------------------------------------------------------------------------------------ arrays, structures */

typedef struct { double *at; int64_t n[4]; } Array;    /* contiguous; missing dimensions are 1 */
typedef struct { int64_t *at; int64_t n[4]; } Indices;
typedef struct { uint8_t *at; int64_t n[4]; } Flags;

#define AT2(a, i, j) ((a).at[(i) * (a).n[1] + (j)])
#define AT3(a, i, j, k) ((a).at[((i) * (a).n[1] + (j)) * (a).n[2] + (k)])
#define AT4(a, i, j, k, l) ((a).at[(((i) * (a).n[1] + (j)) * (a).n[2] + (k)) * (a).n[3] + (l)])

/* Value of a plane, row and station of a motion, whose runs are interleaved; a run alone has one lane. */
#define STATION(a, i, j, k) ((a).at[(((i) * (a).n[1] + (j)) * (a).n[2] + (k)) * (a).n[3]])
/* Scalar n of a run. */
#define SCALAR(a, n_) ((a).at[(n_) * (a).n[1]])

typedef struct { int64_t stations, width; } Layout;
typedef struct {
    Array position;
    double wave_speed, duration, kept_behind, kept_ahead, reach;
    int64_t whole_line;
    double guard;
} WindowArrays;
typedef struct { int64_t first, last; } Window;
typedef struct { int64_t piece, fade, panels; Array link, inverse; } PanelFactor;
typedef struct { Array force; Indices panel, start, first, last; Array follows; } PanelWorkspace;
typedef struct { Indices row, first, last; } Extents;
typedef struct {
    Extents extents;
    Array elements;
    Indices element_row;
    Array stiffness_coefficient;
    Indices lumped_run, lumped_station, lumped_index;
    Array lumped_stiffness, lumped_damping;
} WireArrays;
typedef struct {
    Indices first, row, station;
    Array column;
    Indices column_start, first_end, connector;
    Array coefficient;
} NodeArrays;
typedef struct {
    Indices run, station, end_node, end_index;
    Array end_coefficient;
    NodeArrays nodes;
} ConnectorArrays;
typedef struct {
    int64_t number;
    Indices force, row, station, first;
    Array coefficient, response;
} DistributedArrays;
typedef struct { Array preload, stiffness, damping; Flags unilateral; } ScalarLaw;
typedef struct {
    ScalarLaw law;
    Array per_acceleration, self_compliance, settling;
    Indices first, other;
    Array compliance;
} ScalarForces;
typedef struct { Array predicted, acceleration, change; } ScalarWorkspace;
typedef struct { Indices row, first, last; } ContactWires;
typedef struct { Indices first; Array position, polynomial; } IrregularityArrays;
typedef struct { Array inverse, link; } Factor;
typedef struct {
    double time_step;
    Array position;
    ContactWires wires;
    Indices lateral_row;
    Array rest, flexibility;
    IrregularityArrays irregularity;
    Factor factor;
    int64_t half_width;
} ContactArrays;
typedef struct {
    Array place;
    Indices element, above, number_above;
    Array shape, stiffness, damping, rate, overlap, pressing, joint, head, head_compliance, response;
    Indices start;
    Array wire_compliance, wire_acceleration, first_guess;
    Indices near;
    Array influence;
    Indices number_near;
} ContactWorkspace;
typedef struct { int64_t row, station; } Load;
typedef struct {
    double time_step;
    Layout layout;
    WindowArrays window;
    PanelFactor panels;
    WireArrays wires;
    ConnectorArrays connectors;
    DistributedArrays distributed;
    ScalarForces forces;
    ContactArrays contact;
    Load load;
} KernelArrays;
typedef struct { PanelWorkspace panels; ScalarWorkspace scalar; Array node; ContactWorkspace contact; } Workspace;
typedef struct { Array w, r, force, load; Indices active; } Motion;
typedef struct {
    Array position, speed, elapsed, ramp, held, inverse, damping, stiffness, force;
    Indices first_strip, owner;
    Array offset, head, lateral, contact_stiffness, contact_damping, hertz;
    Indices joint_owner;
    Array joint, joint_law, joint_gain, joint_compliance, joint_force, z, contact;
} Train;
typedef struct { Indices row, station; Array contact, height, motion; Indices slack; } Recording;

static const double FORCE_TOLERANCE = 1e-9, NEGLIGIBLE_FORCE = 1e-11, FADED = 1e-13, MIN_HALF_WIDTH = 30.0, QUIET = 1e-11;
static const double PI = 3.14159265358979323846;
enum { MAX_SWEEPS = 200, LANES = 8, ENTRIES = 6 };

static int64_t least(int64_t a, int64_t b) { return a < b ? a : b; }
static int64_t most(int64_t a, int64_t b) { return a > b ? a : b; }
static double smaller(double a, double b) { return a < b ? a : b; }
static double larger(double a, double b) { return a > b ? a : b; }
static double maximum(double a, double b) { return a >= b || isnan(a) ? a : b; } /* NaN if either is NaN */
static int64_t whole_vectors(int64_t station) { return station & ~(int64_t)(LANES - 1); } /* rounds down, also below 0 */

/* ----------------------------------------------------------------------------------------- search, window, extents */

/* First index from `first` on, before `end`, of increasing values that is not below a value; else `end`. */
#define SEARCH(name, type)                                                                                             \
    static int64_t name(const type *values, int64_t first, int64_t end, type value)                                    \
    {                                                                                                                  \
        while (first < end) {                                                                                          \
            int64_t middle = (first + end) / 2;                                                                        \
            if (values[middle] < value)                                                                                \
                first = middle + 1;                                                                                    \
            else                                                                                                       \
                end = middle;                                                                                          \
        }                                                                                                              \
        return first;                                                                                                  \
    }
SEARCH(search, int64_t)
SEARCH(search_place, double)

typedef struct { int64_t element; double length, share; } Place;

static Place find_element(const double *stations, int64_t size, double position)
{
    Place place;
    place.element = least(most(search_place(stations, 0, size, position) - 1, 0), size - 2);
    place.length = stations[place.element + 1] - stations[place.element];
    place.share = (position - stations[place.element]) / place.length;
    return place;
}

/* Whether some wire moves between two stations. */
static int moves(const Array *w, int64_t first, int64_t last)
{
    for (int64_t b = 0; b < w->n[1]; b++)
        for (int64_t s = first; s <= last; s++)
            if (!(fabs(STATION(*w, 1, b, s)) <= QUIET))
                return 1;
    return 0;
}

static Window active_window(const WindowArrays *limits, const Train *train, const Motion *motion)
{
    const double *position = limits->position.at, guard = limits->guard;
    int64_t end = limits->position.n[0] - 1, first = 0, last = end;
    if (train->position.n[0] > 0 && (guard > 0.0 || !limits->whole_line)) {
        double speed = train->speed.at[0], elapsed = train->elapsed.at[0];
        double front_wave = MIN_HALF_WIDTH + limits->wave_speed * elapsed;
        double behind = front_wave + speed * elapsed, ahead = larger(front_wave - speed * elapsed, MIN_HALF_WIDTH);
        double left = larger(limits->duration - elapsed, 0.0);
        double returning = larger(limits->wave_speed - speed, 0.0) * left;
        behind = smaller(behind, MIN_HALF_WIDTH + limits->kept_behind + returning);
        ahead = smaller(ahead, MIN_HALF_WIDTH + limits->kept_ahead + (limits->wave_speed + speed) * left);
        behind = smaller(behind, limits->reach);
        ahead = smaller(ahead, limits->reach);
        double rear = train->position.at[0], front = train->position.at[0];
        for (int64_t p = 1; p < train->position.n[0]; p++) {
            rear = smaller(rear, train->position.at[p]);
            front = larger(front, train->position.at[p]);
        }
        if (guard > 0.0) {
            behind = ahead = 2 * guard;
            if (motion->active.at[0] <= motion->active.at[1]) {
                first = motion->active.at[0];
                last = least(motion->active.at[1], end);
                rear = position[first];
                front = position[last];
                behind = moves(&motion->w, first, search_place(position, first, end, rear + guard)) ? guard : 0.0;
                ahead = moves(&motion->w, search_place(position, 0, end, front - guard), last) ? guard : 0.0;
            }
        }
        first = search_place(position, 0, end, rear - behind);
        last = search_place(position, first, end, front + ahead);
    }
    return (Window){whole_vectors(first), whole_vectors(last) + LANES - 1};
}

static Window clip_extent(const Extents *extents, int64_t n, Window window)
{
    return (Window){most(extents->first.at[n], window.first), least(extents->last.at[n], window.last)};
}

/* First part of run k at a station inside the window, and one after the last. */
static Window active_run(const Indices *station, const Indices *run, int64_t k, Window window)
{
    int64_t start = run->at[k], end = run->at[k + 1];
    if (station->at[end - 1] < window.first || station->at[start] > window.last)
        return (Window){start, start};
    int64_t first = search(station->at, start, end, window.first);
    return (Window){first, search(station->at, first, end, window.last + 1)};
}

/* Windows of the runs of some lanes: their hull and their intersection; first and last station of each; whether the
 * forces of each still change. A run that does not move has no station, and does not count for the intersection. */
typedef struct { Window all, common; int64_t first[LANES], last[LANES], running[LANES]; } Windows;

/* ----------------------------------------------------------------------------------------------------------- vectors
 *
 * The functions of vectors exist for registers of four and of two numbers; a call takes the widest registers that the
 * processor has, up to WIDEST. Their results have the same bits. Registers of eight numbers are not faster.
 */

#define INLINE static inline __attribute__((always_inline))
#define JOIN(name, width) name##_##width
#define NAMED(name, width) JOIN(name, width)
#define WIDE(name) NAMED(name, WIDTH)
#ifndef WIDEST
#define WIDEST 8
#endif

typedef struct { double *force; const double *link, *inverse; } Panel;

#if defined(__x86_64__) && !defined(__clang__)
#pragma GCC push_options
#pragma GCC target("avx512f")
#define WIDTH 8
#include "time_step_vectors.h"
#undef WIDTH
#pragma GCC pop_options
#pragma GCC push_options
#pragma GCC target("avx2")
#define WIDTH 4
#include "time_step_vectors.h"
#undef WIDTH
#pragma GCC pop_options
#define CHOOSE(name) (WIDEST >= 4 && __builtin_cpu_supports("avx2") ? name##_4 : name##_2)
#else
#define CHOOSE(name) name##_2
#endif
#define WIDTH 2
#include "time_step_vectors.h"
#undef WIDTH
#define WIDTH 1
#include "time_step_vectors.h"
#undef WIDTH

static double inner_product(const double *pair, int64_t size, const double *w, const double *r)
{
    return CHOOSE(inner_product)(pair, size, w, r);
}

/* The same for fields of one of several runs, whose values are some numbers apart, with the same bits. */
static double strided_product(const double *pair, int64_t size, const double *w, const double *r, int64_t stride)
{
    double product[LANES] = {0.0}, other[LANES] = {0.0};
    if (stride == 1)
        return inner_product(pair, size, w, r);
    for (int64_t i = 0; i < size; i += LANES)
        for (int k = 0; k < LANES; k++) {
            product[k] += pair[i + k] * w[(i + k) * stride];
            other[k] += pair[size + i + k] * r[(i + k) * stride];
        }
    for (int k = 0; k < LANES; k++)
        product[k] += other[k];
    return ((product[0] + product[4]) + (product[2] + product[6])) +
           ((product[1] + product[5]) + (product[3] + product[7]));
}

/* ------------------------------------------------------------------------------------------------------------ motion */

static void hold(double dt, const Array *field, int64_t row, int64_t station)
{
    STATION(*field, 0, row, station) += dt * dt / 4 * STATION(*field, 2, row, station);
    STATION(*field, 1, row, station) = 0.0;
    STATION(*field, 2, row, station) = 0.0;
}

static void hold_passed_stations(double dt, const Motion *motion, Window window)
{
    int64_t first = motion->active.at[0], last = motion->active.at[1];
    const Array *fields[2] = {&motion->w, &motion->r};
    motion->active.at[0] = window.first;
    motion->active.at[1] = window.last;
    for (int f = 0; f < 2; f++)
        for (int64_t b = 0; b < fields[f]->n[1]; b++) {
            for (int64_t s = first; s < least(window.first, last + 1); s++)
                hold(dt, fields[f], b, s);
            for (int64_t s = most(first, window.last + 1); s < last + 1; s++)
                hold(dt, fields[f], b, s);
        }
}

/* ------------------------------------------------------------------------------------------------------------- wires */

static void predict_wires(double dt, const WireArrays *wires, const Motion *motion, Window window)
{
    int64_t width = motion->w.n[2], plane = motion->w.n[1] * width;
    for (int64_t n = 0; n < wires->extents.row.n[0]; n++) {
        int64_t row = wires->extents.row.at[n];
        Window active = clip_extent(&wires->extents, n, window);
        if (active.first <= active.last)
            CHOOSE(predict_wire)(dt, wires->stiffness_coefficient.at[row],
                         wires->elements.at + wires->element_row.at[row] * ENTRIES * width,
                         motion->w.at + row * width, motion->r.at + row * width, width, plane, active.first,
                         active.last);
    }
}

/* ------------------------------------------------------------------------------------------- block factors of a row */

/* Solve A x = f in place for some stations of one row; station s is at index s + shift. */
static void solve_row(const Factor *factor, int64_t row, int64_t first, int64_t last, double *w, double *r,
                      int64_t shift)
{
    const double *L = &AT3(factor->link, row, 0, 0), *D = &AT3(factor->inverse, row, 0, 0);
    double force = 0.0, moment = 0.0, x = 0.0, y = 0.0;
    for (int64_t s = first; s <= last; s++) {
        double f = w[s + shift] - force, m = r[s + shift] - moment;
        w[s + shift] = f;
        r[s + shift] = m;
        force = L[4 * s] * f + L[4 * s + 1] * m;
        moment = L[4 * s + 2] * f + L[4 * s + 3] * m;
    }
    for (int64_t s = last; s >= first; s--) {
        double f = w[s + shift], m = r[s + shift];
        double deflection = D[3 * s] * f + D[3 * s + 1] * m - (L[4 * s] * x + L[4 * s + 2] * y);
        y = D[3 * s + 1] * f + D[3 * s + 2] * m - (L[4 * s + 1] * x + L[4 * s + 3] * y);
        x = deflection;
        w[s + shift] = x;
        r[s + shift] = y;
    }
}

/* ------------------------------------------------------------------------------------------------------------ panels */

static int64_t list_panels(const PanelFactor *factor, const Extents *extents, Window window, int64_t rows,
                           const PanelWorkspace *work)
{
    int64_t size = LANES * factor->piece, count = 0;
    for (int64_t n = 0; n < extents->row.n[0]; n++) {
        int64_t row = extents->row.at[n];
        Window active = clip_extent(extents, n, window);
        if (active.first > active.last)
            continue;
        for (int64_t panel = active.first / size; panel <= active.last / size; panel++) {
            int64_t plane = (2 * rows + row) * factor->panels * size;
            work->panel.at[count] = row * factor->panels + panel;
            work->start.at[count] = plane + panel * size;
            work->first.at[count] = plane + most(active.first, panel * size);
            work->last.at[count] = plane + least(active.last, panel * size + size - 1);
            work->follows.at[count] = panel > active.first / size ? 1.0 : 0.0;
            count++;
        }
    }
    work->panel.at[count] = rows * factor->panels;
    work->follows.at[count] = work->follows.at[count + 1] = 0.0;
    return count;
}

static Panel panel_at(const PanelFactor *factor, const PanelWorkspace *work, int64_t n)
{
    int64_t piece = LANES * factor->piece, panel = work->panel.at[n];
    return (Panel){work->force.at + n * 2 * piece, factor->link.at + panel * 4 * piece,
                   factor->inverse.at + panel * 3 * piece};
}

static double solve_wires(const PanelFactor *factor, const Extents *extents, Window window, const Motion *motion,
                          const PanelWorkspace *work)
{
    int64_t count = list_panels(factor, extents, window, motion->w.n[1], work);
    int64_t piece = factor->piece, size = 2 * LANES * piece;
    double carried[2 * LANES] = {0.0}, *force = work->force.at;
    for (int64_t k = 0; k < count; k += 2) {
        for (int64_t n = k; n < least(k + 2, count); n++) {
            CHOOSE(gather)(piece, motion->w.at + work->start.at[n], force + n * size);
            CHOOSE(gather)(piece, motion->r.at + work->start.at[n], force + n * size + LANES);
        }
        CHOOSE(eliminate_pair)(panel_at(factor, work, k), panel_at(factor, work, k + 1), piece, factor->fade,
                       work->follows.at + k, carried);
    }
    memset(carried, 0, sizeof carried);
    for (int64_t k = (count - 1) / 2 * 2; k >= 0 && count; k -= 2) {
        CHOOSE(substitute_pair)(panel_at(factor, work, k), panel_at(factor, work, k + 1), piece, factor->fade,
                        work->follows.at + k, carried);
        for (int64_t n = k; n < least(k + 2, count); n++) {
            int64_t start = work->start.at[n], first = work->first.at[n], last = work->last.at[n];
            CHOOSE(scatter)(piece, motion->w.at, force + n * size, start, first, last);
            CHOOSE(scatter)(piece, motion->r.at, force + n * size + LANES, start, first, last);
        }
    }
    double total = 0.0;
    for (int64_t n = 0; n < count; n++)
        for (int lane = 0; lane < LANES; lane++)
            total += force[n * size + lane];
    return total;
}

/* ------------------------------------------------------------------------------------- connectors, distributed forces */

static void accelerate_nodes(const NodeArrays *nodes, const Motion *motion, const Array *node, Window window)
{
    int64_t width = motion->w.n[2], size = nodes->column.n[2];
    for (int64_t row = 0; row < nodes->first.n[0] - 1; row++) {
        int64_t first = search(nodes->station.at, nodes->first.at[row], nodes->first.at[row + 1], window.first);
        int64_t end = search(nodes->station.at, first, nodes->first.at[row + 1], window.last + 1);
        int64_t plane = (2 * motion->w.n[1] + row) * width;
        for (int64_t j = first; j < end; j++) {
            int64_t at = plane + nodes->column_start.at[j];
            node->at[j] = inner_product(nodes->column.at + 2 * j * size, size, motion->w.at + at, motion->r.at + at);
        }
    }
}

typedef struct { int64_t force, first, size, at, station; } Strip;

/* Scalar force of a strip, index of its first value, size, index in a flattened plane of rows, and first station. */
static Strip strip_of(const DistributedArrays *distributed, const Motion *motion, int64_t z)
{
    int64_t first = distributed->first.at[z], end = distributed->first.at[z + 1];
    return (Strip){motion->force.n[0] - distributed->number + distributed->force.at[z], first, (end - first) / 2,
                   distributed->row.at[z] * motion->w.n[2] + distributed->station.at[z], distributed->station.at[z]};
}

static int outside(Strip strip, Window window)
{
    return strip.station > window.last || strip.station + strip.size <= window.first;
}

static void load_strip(const DistributedArrays *distributed, const Motion *motion, Strip strip, double value,
                       Window window)
{
    int64_t start = most(0, window.first - strip.station);
    int64_t size = least(strip.size, window.last + 1 - strip.station) - start;
    int64_t at = strip.at + 2 * motion->w.n[1] * motion->w.n[2] + start;
    const double *coefficient = distributed->coefficient.at + strip.first + start;
    CHOOSE(add_multiple)(motion->w.at + at, value, coefficient, size);
    CHOOSE(add_multiple)(motion->r.at + at, value, coefficient + strip.size, size);
}

static void predict_distributed(const DistributedArrays *distributed, const ScalarForces *forces, const Motion *motion,
                                const ScalarWorkspace *work, Window window)
{
    const ScalarLaw *law = &forces->law;
    int64_t plane = motion->w.n[1] * motion->w.n[2];
    for (int64_t n = motion->force.n[0] - distributed->number; n < motion->force.n[0]; n++) {
        work->predicted.at[n] = law->preload.at[n];
        work->change.at[n] = 0.0;
    }
    for (int64_t z = 0; z < distributed->force.n[0]; z++) {
        Strip strip = strip_of(distributed, motion, z);
        const double *coefficient = distributed->coefficient.at + strip.first;
        const double *w = motion->w.at + strip.at, *r = motion->r.at + strip.at;
        int64_t n = strip.force;
        if (outside(strip, window)) {
            work->predicted.at[n] = motion->force.at[n];
            continue;
        }
        double elongation = inner_product(coefficient, strip.size, w, r);
        double rate = inner_product(coefficient, strip.size, w + plane, r + plane);
        work->predicted.at[n] += law->stiffness.at[n] * elongation + law->damping.at[n] * rate;
        load_strip(distributed, motion, strip, -motion->force.at[n], window);
    }
}

static void accelerate_distributed(const DistributedArrays *distributed, const Motion *motion,
                                   const ScalarWorkspace *work, Window window)
{
    int64_t plane = motion->w.n[1] * motion->w.n[2];
    for (int64_t n = motion->force.n[0] - distributed->number; n < motion->force.n[0]; n++)
        work->acceleration.at[n] = 0.0;
    for (int64_t z = 0; z < distributed->force.n[0]; z++) {
        Strip strip = strip_of(distributed, motion, z);
        if (!outside(strip, window))
            work->acceleration.at[strip.force] +=
                inner_product(distributed->response.at + strip.first, strip.size, motion->w.at + strip.at + 2 * plane,
                              motion->r.at + strip.at + 2 * plane);
    }
}

static void load_distributed(const DistributedArrays *distributed, const Motion *motion, const ScalarWorkspace *work,
                             Window window)
{
    for (int64_t z = 0; z < distributed->force.n[0]; z++) {
        Strip strip = strip_of(distributed, motion, z);
        load_strip(distributed, motion, strip, -work->change.at[strip.force], window);
    }
}

/* ----------------------------------------------------------------------------------------------- irregularity, joints */

static double height_of_irregularity(const IrregularityArrays *arrays, int64_t wire, double position)
{
    int64_t first = arrays->first.at[wire], size = arrays->first.at[wire + 1] - first;
    const double *points = arrays->position.at + first;
    double inside = smaller(larger(position, points[0]), points[size - 1]);
    Place place = find_element(points, size, inside);
    double distance = place.share * place.length;
    const double *c = arrays->polynomial.at + 4 * (first + place.element);
    return ((c[0] * distance + c[1]) * distance + c[2]) * distance + c[3];
}

static double slope_of_irregularity(const IrregularityArrays *arrays, int64_t wire, double position)
{
    int64_t first = arrays->first.at[wire], size = arrays->first.at[wire + 1] - first;
    const double *points = arrays->position.at + first;
    if (!(points[0] < position && position < points[size - 1]))
        return 0.0;
    Place place = find_element(points, size, position);
    double distance = place.share * place.length;
    const double *c = arrays->polynomial.at + 4 * (first + place.element);
    return (3 * c[0] * distance + 2 * c[1]) * distance + c[2];
}

static void predict_joints(const Train *train, const ContactWorkspace *work)
{
    for (int64_t k = 0; k < train->joint_owner.n[0]; k++) {
        int64_t p = train->joint_owner.at[k];
        double closing = -AT2(train->joint_law, k, 2), rate = 0.0;
        for (int64_t i = 0; i < train->z.n[2]; i++) {
            closing += AT2(train->joint, k, i) * AT3(train->z, 0, p, i);
            rate += AT2(train->joint, k, i) * AT3(train->z, 1, p, i);
        }
        work->joint.at[k] = AT2(train->joint_law, k, 0) * closing + AT2(train->joint_law, k, 1) * rate;
    }
}

static double sweep_joints(const Train *train, const ContactWorkspace *work)
{
    double largest = 0.0;
    int64_t unknowns = train->z.n[2];
    for (int64_t k = 0; k < train->joint_owner.n[0]; k++) {
        int64_t p = train->joint_owner.at[k];
        double old = train->joint_force.at[k], acceleration = 0.0, compliance = train->joint_compliance.at[k];
        for (int64_t i = 0; i < unknowns; i++)
            acceleration += AT2(train->joint, k, i) * AT3(train->z, 2, p, i);
        double force = work->joint.at[k] + train->joint_gain.at[k] * acceleration + compliance * old;
        force = smaller(larger(force / (1 + compliance), AT2(train->joint_law, k, 3)), AT2(train->joint_law, k, 4));
        double change = force - old;
        if (fabs(change) > NEGLIGIBLE_FORCE) {
            train->joint_force.at[k] = force;
            for (int64_t i = 0; i < unknowns; i++)
                for (int64_t j = 0; j < unknowns; j++)
                    AT3(train->z, 2, p, i) -= AT3(train->inverse, p, i, j) * AT2(train->joint, k, j) * change;
        }
        largest = maximum(largest, fabs(change));
    }
    return largest;
}

/* ----------------------------------------------------------------------------------------------------------- contact */

static double residual_flexibility(const double *coefficients, int64_t size, double s)
{
    double value = coefficients[size - 1];
    for (int64_t k = size - 2; k >= 0; k--)
        value = value * s + coefficients[k];
    return value;
}

/* Find the element and the contact wires above strip c; a wire that it has left presses no more. */
static void find_wires_above(const ContactArrays *contact, const Train *train, const ContactWorkspace *work, int64_t c)
{
    int64_t e = find_element(contact->position.at, contact->position.n[0], work->place.at[c]).element;
    work->element.at[c] = e;
    work->number_above.at[c] = 0;
    for (int64_t wire = 0; wire < train->contact.n[1]; wire++) {
        if (contact->wires.first.at[wire] <= e && e < contact->wires.last.at[wire]) {
            AT2(work->above, c, work->number_above.at[c]) = wire;
            work->number_above.at[c]++;
        } else {
            AT2(train->contact, c, wire) = AT2(work->first_guess, c, wire) = 0.0;
        }
    }
}

/* Predicted lateral position of a wire above strip c, and its rate as the strip moves [m, m/s]. */
static double lateral_motion(const ContactArrays *contact, const Motion *motion, const Train *train,
                             const ContactWorkspace *work, int64_t c, int64_t wire, double *rate)
{
    int64_t row = contact->lateral_row.at[wire];
    double y = 0.0;
    *rate = 0.0;
    if (row < 0)
        return 0.0;
    Place place = find_element(contact->position.at, contact->position.n[0], work->place.at[c]);
    double h = place.length, s = place.share;
    for (int i = 0; i < 2; i++) {
        /* Hermite functions and their derivatives along the track. */
        int64_t at = place.element + i;
        double n = i == 0 ? (1 - s) * (1 - s) * (1 + 2 * s) : s * s * (3 - 2 * s);
        double m = h * s * (1 - s) * (1 - i - s);
        double by_w = (12 * i - 6) * s * (1 - s) / h, by_r = (1 - i - s) * (1 - i - 3 * s + 2 * i);
        double w = AT3(contact->rest, row, at, 0) + STATION(motion->w, 0, row, at);
        double r = AT3(contact->rest, row, at, 1) + STATION(motion->r, 0, row, at);
        y += n * w + m * r;
        *rate += train->speed.at[0] * (by_w * w + by_r * r) + n * STATION(motion->w, 1, row, at) +
                 m * STATION(motion->r, 1, row, at);
    }
    return y;
}

/* Displacement of strip c per unknown below a wire, at its lateral position. */
static void shape_strip(const ContactArrays *contact, const Motion *motion, const Train *train,
                        const ContactWorkspace *work, int64_t c, int64_t wire)
{
    int64_t unknowns = train->head.n[1];
    for (int64_t i = 0; i < unknowns; i++)
        AT3(work->head, c, wire, i) = AT2(train->head, c, i);
    if (train->lateral.n[1] == 0)
        return;
    double rate, y = lateral_motion(contact, motion, train, work, c, wire, &rate), power = 1.0;
    for (int64_t k = 0; k < train->lateral.n[1]; k++) {
        power *= y;
        for (int64_t i = 0; i < unknowns; i++)
            AT3(work->head, c, wire, i) += power * AT3(train->lateral, c, k, i);
    }
}

/* Predicted rate of the overlap of strip c and a wire [m/s]: the contact moves along the slope of the wire. */
static double closing_rate(const ContactArrays *contact, const Motion *motion, const Train *train,
                           const ContactWorkspace *work, int64_t c, int64_t wire)
{
    int64_t row = contact->wires.row.at[wire], owner = train->owner.at[c], unknowns = train->z.n[2];
    const double *shape = &AT3(work->shape, c, wire, 0);
    Place place = find_element(contact->position.at, contact->position.n[0], work->place.at[c]);
    double h = place.length, s = place.share, rate = 0.0;
    double slope = slope_of_irregularity(&contact->irregularity, wire, work->place.at[c]);
    for (int i = 0; i < 2; i++) {
        /* Derivatives of the Hermite functions along the track. */
        int64_t at = place.element + i;
        double by_w = (12 * i - 6) * s * (1 - s) / h, by_r = (1 - i - s) * (1 - i - 3 * s + 2 * i);
        slope += by_w * (AT3(contact->rest, row, at, 0) + STATION(motion->w, 0, row, at));
        slope += by_r * (AT3(contact->rest, row, at, 1) + STATION(motion->r, 0, row, at));
        rate -= shape[2 * i] * STATION(motion->w, 1, row, at) + shape[2 * i + 1] * STATION(motion->r, 1, row, at);
    }
    for (int64_t i = 0; i < unknowns; i++)
        rate += AT3(work->head, c, wire, i) * AT3(train->z, 1, owner, i);
    if (train->lateral.n[1] > 0) {
        double moving, y = lateral_motion(contact, motion, train, work, c, wire, &moving), power = 1.0;
        for (int64_t k = 0; k < train->lateral.n[1]; k++) {
            for (int64_t i = 0; i < unknowns; i++)
                rate += moving * (k + 1) * power * AT3(train->lateral, c, k, i) * AT3(train->z, 0, owner, i);
            power *= y;
        }
    }
    return rate - train->speed.at[0] * slope;
}

/* Complete the overlap of strip c, so far its height, and load a wire with the contact force. */
static void predict_contact(const ContactArrays *contact, const Motion *motion, const Train *train,
                            const ContactWorkspace *work, int64_t c, int64_t wire)
{
    int64_t row = contact->wires.row.at[wire];
    double *n = &AT3(work->shape, c, wire, 0), penalty = train->contact_stiffness.at[c];
    double damping = train->contact_damping.at[c], force = AT2(train->contact, c, wire), height = 0.0;
    Place place = find_element(contact->position.at, contact->position.n[0], work->place.at[c]);
    double h = place.length, s = place.share;
    n[0] = (1 + 2 * s) * ((1 - s) * (1 - s));
    n[1] = h * s * ((1 - s) * (1 - s));
    n[2] = s * s * (3 - 2 * s);
    n[3] = h * s * s * (s - 1);
    AT2(work->first_guess, c, wire) = force;
    for (int i = 0; i < 2; i++) {
        int64_t at = place.element + i;
        height += n[2 * i] * (AT3(contact->rest, row, at, 0) + STATION(motion->w, 0, row, at));
        height += n[2 * i + 1] * (AT3(contact->rest, row, at, 1) + STATION(motion->r, 0, row, at));
        STATION(motion->w, 2, row, at) += n[2 * i] * force;
        STATION(motion->r, 2, row, at) += n[2 * i + 1] * force;
    }
    double flexibility =
        residual_flexibility(&AT3(contact->flexibility, row, place.element, 0), contact->flexibility.n[2], s);
    double stiffness = 1 / (1 / penalty + flexibility);
    AT2(work->stiffness, c, wire) = stiffness;
    AT2(work->overlap, c, wire) -= height + height_of_irregularity(&contact->irregularity, wire, work->place.at[c]);
    if (damping > 0.0) {
        double softening = stiffness / penalty;
        AT2(work->damping, c, wire) = softening * softening * damping;
    }
    if (damping > 0.0 || isinf(penalty))
        AT2(work->rate, c, wire) = closing_rate(contact, motion, train, work, c, wire);
}

/* Response of a wire to a unit force of strip c. */
static void solve_response(const ContactArrays *contact, const ContactWorkspace *work, int64_t c, int64_t wire)
{
    int64_t e = work->element.at[c], size = work->response.n[3], start = whole_vectors(e - contact->half_width);
    double *response = &AT4(work->response, c, wire, 0, 0);
    work->start.at[c] = start;
    memset(response, 0, 2 * (size_t)size * sizeof *response);
    for (int i = 0; i < 2; i++)
        for (int slope = 0; slope < 2; slope++)
            response[slope * size + e + i - start] = AT3(work->shape, c, wire, 2 * i + slope);
    int64_t first = most(0, e - contact->half_width);
    int64_t last = least(contact->position.n[0] - 1, e + 1 + contact->half_width);
    solve_row(&contact->factor, contact->wires.row.at[wire], first, last, response, response + size, -start);
}

/* Acceleration of a wire at the contact of another strip, or of c itself, per force of strip c. */
static double at_contact(const ContactWorkspace *work, int64_t c, int64_t other, int64_t wire)
{
    int64_t s = work->element.at[other] - work->start.at[c];
    double acceleration = 0.0;
    if (s < 0 || s + 1 >= work->response.n[3])
        return 0.0;
    for (int i = 0; i < 2; i++)
        for (int slope = 0; slope < 2; slope++)
            acceleration += AT3(work->shape, other, wire, 2 * i + slope) * AT4(work->response, c, wire, slope, s + i);
    return acceleration;
}

/* Accelerate the unknowns of pantograph p under all forces in its predicted state. */
static void accelerate_pantograph(const Train *train, const ContactWorkspace *work, int64_t p)
{
    int64_t unknowns = train->z.n[2];
    for (int64_t i = 0; i < unknowns; i++)
        AT3(train->z, 2, p, i) = 0.0;
    for (int64_t j = 0; j < unknowns; j++) {
        double force = AT2(train->force, p, j);
        for (int64_t c = train->first_strip.at[p]; c < train->first_strip.at[p + 1]; c++) {
            force -= AT2(train->head, c, j) * work->pressing.at[c];
            for (int64_t n = 0; n < work->number_above.at[c] && train->lateral.n[1] > 0; n++) {
                int64_t wire = AT2(work->above, c, n);
                force -= (AT3(work->head, c, wire, j) - AT2(train->head, c, j)) * AT2(train->contact, c, wire);
            }
        }
        for (int64_t k = 0; k < train->joint_owner.n[0]; k++)
            if (train->joint_owner.at[k] == p)
                force -= AT2(train->joint, k, j) * train->joint_force.at[k];
        for (int64_t m = 0; m < unknowns; m++)
            force -= AT3(train->damping, p, j, m) * AT3(train->z, 1, p, m) +
                     AT3(train->stiffness, p, j, m) * AT3(train->z, 0, p, m);
        for (int64_t i = 0; i < unknowns; i++)
            AT3(train->z, 2, p, i) += AT3(train->inverse, p, i, j) * force;
    }
}

static void predict_train(const ContactArrays *contact, const Motion *motion, const Train *train,
                          const ContactWorkspace *work)
{
    double dt = contact->time_step, holding = 0.0;
    int64_t unknowns = train->z.n[2];
    train->elapsed.at[0] += dt;
    /* Share of the static force that still holds the heads down: a half-cosine from 1 to 0. */
    if (train->elapsed.at[0] < train->ramp.at[0])
        holding = (1 + cos(PI * train->elapsed.at[0] / train->ramp.at[0])) / 2;
    for (int64_t p = 0; p < train->position.n[0]; p++) {
        train->position.at[p] += dt * train->speed.at[0];
        for (int64_t i = 0; i < unknowns; i++) {
            AT3(train->z, 0, p, i) += dt * AT3(train->z, 1, p, i) + dt * dt / 4 * AT3(train->z, 2, p, i);
            AT3(train->z, 1, p, i) += dt / 2 * AT3(train->z, 2, p, i);
        }
        for (int64_t c = train->first_strip.at[p]; c < train->first_strip.at[p + 1]; c++) {
            work->place.at[c] = train->position.at[p] + train->offset.at[c];
            find_wires_above(contact, train, work, c);
            work->pressing.at[c] = 0.0;
            for (int64_t n = 0; n < work->number_above.at[c]; n++) {
                work->pressing.at[c] += AT2(train->contact, c, AT2(work->above, c, n));
                shape_strip(contact, motion, train, work, c, AT2(work->above, c, n));
            }
            work->pressing.at[c] += holding * train->held.at[c];
        }
        accelerate_pantograph(train, work, p);
    }
    for (int64_t c = 0; c < train->owner.n[0]; c++) {
        int64_t p = train->owner.at[c];
        for (int64_t n = 0; n < work->number_above.at[c]; n++) {
            int64_t wire = AT2(work->above, c, n);
            double head = 0.0, compliance = 0.0;
            for (int64_t i = 0; i < unknowns; i++) {
                for (int64_t j = 0; j < unknowns; j++)
                    compliance +=
                        AT3(work->head, c, wire, i) * AT3(train->inverse, p, i, j) * AT3(work->head, c, wire, j);
                head += AT3(work->head, c, wire, i) * AT3(train->z, 0, p, i);
            }
            AT2(work->head_compliance, c, wire) = compliance;
            AT2(work->overlap, c, wire) = head;
            predict_contact(contact, motion, train, work, c, wire);
            solve_response(contact, work, c, wire);
            if (isinf(train->contact_stiffness.at[c])) {
                double mobility = compliance + at_contact(work, c, c, wire);
                AT2(work->damping, c, wire) = 2 * sqrt(AT2(work->stiffness, c, wire) / mobility);
            }
        }
    }
    predict_joints(train, work);
}

/* List the connectors with a node inside the response to a contact, and their accelerations. */
static void list_near_connectors(const ContactArrays *contact, const ConnectorArrays *connectors,
                                 const ContactWorkspace *work, int64_t c, int64_t wire, Window window)
{
    const NodeArrays *nodes = &connectors->nodes;
    int64_t row = contact->wires.row.at[wire], start = work->start.at[c], number = 0, last = nodes->first.at[row + 1];
    int64_t low = most(start, window.first), high = least(start + work->response.n[3], window.last + 1);
    for (int64_t j = search(nodes->station.at, nodes->first.at[row], last, low); j < last; j++) {
        if (nodes->station.at[j] >= high)
            break;
        double acceleration = AT4(work->response, c, wire, 0, nodes->station.at[j] - start);
        for (int64_t end = nodes->first_end.at[j]; end < nodes->first_end.at[j + 1]; end++) {
            AT3(work->near, c, wire, number) = nodes->connector.at[end];
            AT3(work->influence, c, wire, number) = nodes->coefficient.at[end] * acceleration;
            number++;
        }
    }
    AT2(work->number_near, c, wire) = number;
}

/* List the distributed forces whose response covers a contact, and their accelerations. */
static void list_near_distributed(const ContactArrays *contact, const DistributedArrays *distributed,
                                  const Motion *motion, const ContactWorkspace *work, int64_t c, int64_t wire)
{
    int64_t number = AT2(work->number_near, c, wire), e = work->element.at[c];
    const double *n = &AT3(work->shape, c, wire, 0);
    for (int64_t z = 0; z < distributed->force.n[0]; z++) {
        int64_t size = (distributed->first.at[z + 1] - distributed->first.at[z]) / 2;
        int64_t s = e - distributed->station.at[z];
        if (distributed->row.at[z] != contact->wires.row.at[wire] || s < 0 || s + 1 >= size)
            continue;
        const double *response = distributed->response.at + distributed->first.at[z] + s;
        AT3(work->near, c, wire, number) = motion->force.n[0] - distributed->number + distributed->force.at[z];
        AT3(work->influence, c, wire, number) =
            n[0] * response[0] + n[1] * response[size] + n[2] * response[1] + n[3] * response[size + 1];
        number++;
    }
    AT2(work->number_near, c, wire) = number;
}

static void accelerate_contacts(const KernelArrays *kernel, const Motion *motion, const ContactWorkspace *work,
                                Window window)
{
    const ContactArrays *contact = &kernel->contact;
    int64_t strips = work->element.n[0], size = work->response.n[3];
    for (int64_t c = 0; c < strips; c++)
        for (int64_t n = 0; n < work->number_above.at[c]; n++) {
            int64_t wire = AT2(work->above, c, n);
            const double *w = &STATION(motion->w, 2, contact->wires.row.at[wire], work->start.at[c]);
            const double *r = &STATION(motion->r, 2, contact->wires.row.at[wire], work->start.at[c]);
            AT2(work->wire_acceleration, c, wire) =
                strided_product(&AT4(work->response, c, wire, 0, 0), size, w, r, motion->w.n[3]);
            for (int64_t other = 0; other < strips; other++)
                AT3(work->wire_compliance, c, other, wire) = at_contact(work, c, other, wire);
            list_near_connectors(contact, &kernel->connectors, work, c, wire, window);
            list_near_distributed(contact, &kernel->distributed, motion, work, c, wire);
        }
}

/* Force F with F + share F^(2/3) = linear, by Newton's method in the root of F, which descends from its start. */
static double reduce_by_hertz(double linear, double share)
{
    double root = smaller(pow(linear, 1.0 / 3), sqrt(linear / share));
    for (int i = 0; i < 60; i++) {
        double change = (root * root * (root + share) - linear) / (root * (3 * root + 2 * share));
        root -= change;
        if (change <= 1e-15 * root)
            break;
    }
    return root * root * root;
}

static double sweep_contacts(double dt, const Train *train, const ContactWorkspace *work,
                             const ScalarWorkspace *scalar)
{
    double largest = 0.0;
    int64_t strips = train->owner.n[0], unknowns = train->z.n[2];
    for (int64_t c = 0; c < strips; c++) {
        int64_t p = train->owner.at[c];
        for (int64_t number = 0; number < work->number_above.at[c]; number++) {
            int64_t wire = AT2(work->above, c, number), near = AT2(work->number_near, c, wire);
            double old = AT2(train->contact, c, wire), k = AT2(work->stiffness, c, wire);
            double damper = AT2(work->damping, c, wire), approach = -AT2(work->wire_acceleration, c, wire);
            for (int64_t i = 0; i < unknowns; i++)
                approach += AT3(work->head, c, wire, i) * AT3(train->z, 2, p, i);
            for (int64_t other = 0; other < strips; other++)
                approach -= AT3(work->wire_compliance, c, other, wire) *
                            (AT2(train->contact, other, wire) - AT2(work->first_guess, other, wire));
            for (int64_t i = 0; i < near; i++)
                approach += AT3(work->influence, c, wire, i) * SCALAR(scalar->change, AT3(work->near, c, wire, i));
            double gain = k * dt * dt / 4 + damper * dt / 2;
            double held = k * AT2(work->overlap, c, wire) + damper * AT2(work->rate, c, wire);
            double compliance = gain * (AT2(work->head_compliance, c, wire) + AT3(work->wire_compliance, c, c, wire));
            double force = (held + gain * approach + compliance * old) / (1 + compliance);
            if (force < 0.0)
                force = 0.0;
            if (train->hertz.at[c] > 0.0 && force > 0.0)
                force = reduce_by_hertz(force, train->hertz.at[c] * k / (1 + compliance));
            double change = force - old;
            if (fabs(change) > NEGLIGIBLE_FORCE) {
                AT2(train->contact, c, wire) = force;
                for (int64_t i = 0; i < near; i++)
                    SCALAR(scalar->acceleration, AT3(work->near, c, wire, i)) += AT3(work->influence, c, wire, i) * change;
                for (int64_t i = 0; i < unknowns; i++)
                    for (int64_t j = 0; j < unknowns; j++)
                        AT3(train->z, 2, p, i) -=
                            AT3(train->inverse, p, i, j) * AT3(work->head, c, wire, j) * change;
            }
            largest = maximum(largest, fabs(change));
        }
    }
    return largest;
}

static void load_contacts(const ContactArrays *contact, const Motion *motion, const Train *train,
                          const ContactWorkspace *work)
{
    for (int64_t c = 0; c < train->owner.n[0]; c++)
        for (int64_t number = 0; number < work->number_above.at[c]; number++) {
            int64_t wire = AT2(work->above, c, number), e = work->element.at[c], row = contact->wires.row.at[wire];
            double change = AT2(train->contact, c, wire) - AT2(work->first_guess, c, wire);
            for (int i = 0; i < 2; i++) {
                STATION(motion->w, 2, row, e + i) += AT3(work->shape, c, wire, 2 * i) * change;
                STATION(motion->r, 2, row, e + i) += AT3(work->shape, c, wire, 2 * i + 1) * change;
            }
        }
}

static void correct_train(double dt, const Train *train)
{
    for (int64_t p = 0; p < train->position.n[0]; p++)
        for (int64_t i = 0; i < train->z.n[2]; i++) {
            AT3(train->z, 0, p, i) += dt * dt / 4 * AT3(train->z, 2, p, i);
            AT3(train->z, 1, p, i) += dt / 2 * AT3(train->z, 2, p, i);
        }
}

/* -------------------------------------------------------------------------------------------------------------- step */

/* Sweep over contact forces and scalar forces until none of them changes; zero when they do not converge. */
static int64_t settle_forces(const KernelArrays *kernel, const Motion *motion, const Train *train,
                             const Workspace *work, const Windows *windows)
{
    const ConnectorArrays *connectors = &kernel->connectors;
    const int64_t *station = connectors->station.at;
    int64_t forces = motion->force.n[0], distributed = forces - kernel->distributed.number;
    double *force = motion->force.at;
    for (int64_t sweeps = 1; sweeps <= MAX_SWEEPS; sweeps++) {
        double largest = sweep_contacts(kernel->time_step, train, &work->contact, &work->scalar);
        largest = maximum(largest, sweep_joints(train, &work->contact));
        for (int64_t k = 0; k < connectors->run.n[0] - 1; k++) {
            Window active = active_run(&connectors->station, &connectors->run, k, windows->all);
            sweep_forces_1(&kernel->forces, &work->scalar, force, station, active.first, active.last, windows, &largest);
        }
        sweep_forces_1(&kernel->forces, &work->scalar, force, station, distributed, forces, windows, &largest);
        /* This comparison is false for NaN, too. */
        if (largest < FORCE_TOLERANCE)
            return sweeps;
    }
    return 0;
}

/* Advance line and pantographs by one time step; return the number of sweeps, zero without convergence. */
static int64_t step(const KernelArrays *kernel, const Motion *motion, const Train *train, const Workspace *work)
{
    double dt = kernel->time_step;
    Window window = active_window(&kernel->window, train, motion);
    Windows windows = {.all = window, .running = {1}};
    hold_passed_stations(dt, motion, window);
    predict_wires(dt, &kernel->wires, motion, window);
    add_lumped_forces_1(&kernel->wires, motion, &windows);
    predict_connectors_1(&kernel->connectors, &kernel->forces, motion, &work->scalar, &windows);
    predict_distributed(&kernel->distributed, &kernel->forces, motion, &work->scalar, window);
    predict_train(&kernel->contact, motion, train, &work->contact);
    STATION(motion->w, 2, kernel->load.row, kernel->load.station) += motion->load.at[0];
    accelerate_nodes(&kernel->connectors.nodes, motion, &work->node, window);
    accelerate_ends_1(&kernel->connectors, &work->node, &work->scalar, &windows);
    accelerate_distributed(&kernel->distributed, motion, &work->scalar, window);
    accelerate_contacts(kernel, motion, &work->contact, window);
    int64_t sweeps = settle_forces(kernel, motion, train, work, &windows);
    load_connectors_1(&kernel->connectors, motion, &work->scalar, &windows);
    load_distributed(&kernel->distributed, motion, &work->scalar, window);
    load_contacts(&kernel->contact, motion, train, &work->contact);
    double accelerated = solve_wires(&kernel->panels, &kernel->wires.extents, window, motion, &work->panels);
    correct_train(dt, train);
    return isnan(accelerated) ? 0 : sweeps;
}

/* Run in a lane: its limits of the window, motion in all lanes, and train; it moves from step `begin` on. */
typedef struct {
    WindowArrays window;
    Motion motion;
    Train train;
    ContactWorkspace contact;
    Recording recording;
    int64_t begin;
} Lane;

static int lanes_of_vectors(void)
{
#if defined(__x86_64__) && !defined(__clang__)
    if (WIDEST >= 8 && __builtin_cpu_supports("avx512f"))
        return 8;
    return WIDEST >= 4 && __builtin_cpu_supports("avx2") ? 4 : 2;
#else
    return 2;
#endif
}

#if defined(__x86_64__) && !defined(__clang__)
#define IN_LANES(lanes, name, ...)                                                                                     \
    ((lanes) == 8 ? name##_8(__VA_ARGS__) : (lanes) == 4 ? name##_4(__VA_ARGS__) : name##_2(__VA_ARGS__))
#else
#define IN_LANES(lanes, name, ...) name##_2(__VA_ARGS__)
#endif

/* Add the window of a run to those of all. */
static void add_window(Windows *windows, int lane, Window window)
{
    int first = windows->all.first > windows->all.last;
    windows->first[lane] = window.first;
    windows->last[lane] = window.last;
    if (window.first > window.last)
        return;
    windows->all.first = first ? window.first : least(windows->all.first, window.first);
    windows->all.last = first ? window.last : most(windows->all.last, window.last);
    windows->common.first = first ? window.first : most(windows->common.first, window.first);
    windows->common.last = first ? window.last : least(windows->common.last, window.last);
}

/* Windows of all runs on one wire; without a common station, their intersection begins after their hull. */
static Windows clip_windows(const Extents *extents, int64_t n, const Windows *windows, int lanes)
{
    Windows clipped = {.all = {0, -1}};
    for (int l = 0; l < lanes; l++)
        add_window(&clipped, l, clip_extent(extents, n, (Window){windows->first[l], windows->last[l]}));
    if (clipped.common.first > clipped.common.last)
        clipped.common.first = clipped.all.last + 1;
    return clipped;
}

/* Advance the runs of all lanes by one step; `settle_forces` and `step` in lanes. Returns the number of sweeps. */
static int64_t step_lanes(const KernelArrays *kernel, const Lane *lane, const Workspace *work, int64_t n)
{
    const ConnectorArrays *connectors = &kernel->connectors;
    const Extents *extents = &kernel->wires.extents;
    const Motion *all = &lane[0].motion;
    int lanes = (int)all->w.n[3];
    int64_t width = all->w.n[2], plane = all->w.n[1] * width, sweeps = 0;
    double dt = kernel->time_step, largest[LANES] = {0.0}, total[LANES] = {0.0};
    Windows windows = {.all = {0, -1}};
    for (int l = 0; l < lanes; l++) {
        Window window = {0, -1};
        if (n >= lane[l].begin) {
            window = active_window(&lane[l].window, &lane[l].train, &lane[l].motion);
            hold_passed_stations(dt, &lane[l].motion, window);
        }
        add_window(&windows, l, window);
        windows.running[l] = -(window.first <= window.last);
    }
    for (int64_t k = 0; k < extents->row.n[0]; k++) {
        int64_t row = extents->row.at[k];
        Windows clipped = clip_windows(extents, k, &windows, lanes);
        if (clipped.all.first <= clipped.all.last)
            IN_LANES(lanes, predict_wire_lanes, dt, kernel->wires.stiffness_coefficient.at[row],
                     kernel->wires.elements.at + kernel->wires.element_row.at[row] * ENTRIES * width,
                     all->w.at + row * width * lanes, all->r.at + row * width * lanes, width, plane, &clipped);
    }
    IN_LANES(lanes, add_lumped_forces, &kernel->wires, all, &windows);
    IN_LANES(lanes, predict_connectors, connectors, &kernel->forces, all, &work->scalar, &windows);
    for (int l = 0; l < lanes; l++)
        if (windows.running[l])
            predict_train(&kernel->contact, &lane[l].motion, &lane[l].train, &lane[l].contact);
    for (int64_t row = 0; row < connectors->nodes.first.n[0] - 1; row++)
        IN_LANES(lanes, accelerate_nodes, &connectors->nodes, all, &work->node, row, windows.all);
    IN_LANES(lanes, accelerate_ends, connectors, &work->node, &work->scalar, &windows);
    for (int l = 0; l < lanes; l++)
        if (windows.running[l])
            accelerate_contacts(kernel, &lane[l].motion, &lane[l].contact,
                                (Window){windows.first[l], windows.last[l]});
    int left = 1;
    for (; left && sweeps < MAX_SWEEPS; sweeps++) {
        for (int l = 0; l < lanes; l++)
            if (windows.running[l]) {
                ScalarWorkspace scalar = work->scalar;
                scalar.change.at += l;
                scalar.acceleration.at += l;
                largest[l] = sweep_contacts(dt, &lane[l].train, &lane[l].contact, &scalar);
                largest[l] = maximum(largest[l], sweep_joints(&lane[l].train, &lane[l].contact));
            }
        for (int64_t k = 0; k < connectors->run.n[0] - 1; k++) {
            Window active = active_run(&connectors->station, &connectors->run, k, windows.all);
            IN_LANES(lanes, sweep_forces, &kernel->forces, &work->scalar, all->force.at, connectors->station.at,
                     active.first, active.last, &windows, largest);
        }
        left = 0;
        for (int l = 0; l < lanes; l++) {
            if (largest[l] < FORCE_TOLERANCE)
                windows.running[l] = 0;
            left |= windows.running[l] != 0;
        }
    }
    IN_LANES(lanes, load_connectors, connectors, all, &work->scalar, &windows);
    for (int l = 0; l < lanes; l++)
        if (windows.first[l] <= windows.last[l])
            load_contacts(&kernel->contact, &lane[l].motion, &lane[l].train, &lane[l].contact);
    for (int64_t k = 0; k < extents->row.n[0]; k++) {
        int64_t at = (2 * plane + extents->row.at[k] * width) * lanes;
        Windows clipped = clip_windows(extents, k, &windows, lanes);
        if (clipped.all.first <= clipped.all.last)
            IN_LANES(lanes, solve_wire_lanes, &kernel->panels, &kernel->contact.factor, extents->row.at[k],
                     all->w.at + at, all->r.at + at, &clipped, total);
    }
    for (int l = 0; l < lanes; l++) {
        if (windows.first[l] <= windows.last[l])
            correct_train(dt, &lane[l].train);
        left |= isnan(total[l]);
    }
    return left ? 0 : sweeps;
}

/* Height of strip c at the lateral positions of its wires above that below the axis, times their forces [N m]. */
static double rise_at_wires(const Train *train, const ContactWorkspace *contact, int64_t c)
{
    double rise = 0.0;
    for (int64_t n = 0; n < contact->number_above.at[c]; n++) {
        int64_t wire = AT2(contact->above, c, n);
        for (int64_t i = 0; i < train->z.n[2]; i++) {
            double lateral = AT3(contact->head, c, wire, i) - AT2(train->head, c, i);
            rise += AT2(train->contact, c, wire) * lateral * AT3(train->z, 0, train->owner.at[c], i);
        }
    }
    return rise;
}

static void record(const KernelArrays *kernel, const WindowArrays *limits, const Motion *motion, const Train *train,
                   const Workspace *work, const Recording *recording, int64_t n)
{
    const ConnectorArrays *connectors = &kernel->connectors;
    double dt = kernel->time_step;
    for (int64_t c = 0; c < train->owner.n[0]; c++) {
        double total = 0.0, head = 0.0;
        for (int64_t k = 0; k < train->contact.n[1]; k++)
            total += AT2(train->contact, c, k);
        for (int64_t i = 0; i < train->z.n[2]; i++)
            head += AT2(train->head, c, i) * AT3(train->z, 0, train->owner.at[c], i);
        if (train->lateral.n[1] > 0 && total > 0.0)
            head += rise_at_wires(train, &work->contact, c) / total;
        AT2(recording->contact, n, c) = total;
        AT2(recording->height, n, c) = head;
    }
    for (int64_t u = 0; u < recording->row.n[0]; u++) {
        int64_t b = recording->row.at[u], s = recording->station.at[u];
        double a = STATION(motion->w, 2, b, s);
        AT3(recording->motion, n, u, 0) = STATION(motion->w, 0, b, s) + dt * dt / 4 * a;
        AT3(recording->motion, n, u, 1) = STATION(motion->w, 1, b, s) + dt / 2 * a;
        AT3(recording->motion, n, u, 2) = a;
    }
    int64_t slack = 0;
    Window window = active_window(limits, train, motion);
    for (int64_t k = 0; k < connectors->run.n[0] - 1; k++) {
        Window active = active_run(&connectors->station, &connectors->run, k, window);
        for (int64_t c = active.first; c < active.last; c++)
            slack += kernel->forces.law.unilateral.at[c] && SCALAR(motion->force, c) == 0.0;
    }
    recording->slack.at[n] = slack;
}

/* ------------------------------------------------------------------------------------------------------- entry points
 *
 * Each takes the arguments of its twin in Python as one structure. Its first word is the size of the structure as the
 * caller knows it: with another size, nothing is done and -1 is returned.
 */

#define CHECK_SIZE(a)                                                                                                  \
    if ((a)->bytes != sizeof *(a))                                                                                     \
    return -1.0

typedef struct { int64_t bytes; KernelArrays kernel; Motion motion; Train train; Workspace work; } StepArguments;

EXPORT double pantocheck_step(const StepArguments *a)
{
    CHECK_SIZE(a);
    return (double)step(&a->kernel, &a->motion, &a->train, &a->work);
}

/* Advance by one step per value of the load and record; return the number of completed steps. */
typedef struct {
    int64_t bytes;
    KernelArrays kernel;
    Motion motion;
    Train train;
    Workspace work;
    Array load;
    Recording recording;
} AdvanceArguments;

EXPORT double pantocheck_advance(const AdvanceArguments *a)
{
    CHECK_SIZE(a);
    for (int64_t n = 0; n < a->load.n[0]; n++) {
        a->motion.load.at[0] = a->load.at[n];
        if (step(&a->kernel, &a->motion, &a->train, &a->work) == 0)
            return (double)n;
        record(&a->kernel, &a->kernel.window, &a->motion, &a->train, &a->work, &a->recording, n);
    }
    return (double)a->load.n[0];
}

/* Advance runs on one line, each in a lane, from a step to another, and record; return the number of the step that was
 * not completed, or the last. `lanes` holds the words of each `Lane`; `work` has no contacts. */
typedef struct {
    int64_t bytes;
    KernelArrays kernel;
    ScalarWorkspace scalar;
    Array node;
    Indices lanes;
    int64_t first, end;
} AdvanceLanesArguments;

EXPORT double pantocheck_advance_lanes(const AdvanceLanesArguments *a)
{
    CHECK_SIZE(a);
    Lane lane[LANES];
    int lanes = (int)a->lanes.n[0];
    if (a->lanes.n[1] * 8 != sizeof *lane || lanes > LANES)
        return -1.0;
    memcpy(lane, a->lanes.at, lanes * sizeof *lane);
    for (int l = 0; l < lanes; l++) {
        lane[l].motion.w.at += l;
        lane[l].motion.r.at += l;
        lane[l].motion.force.at += l;
    }
    Workspace work = {.scalar = a->scalar, .node = a->node};
    for (int64_t n = a->first; n < a->end; n++) {
        if (step_lanes(&a->kernel, lane, &work, n) == 0)
            return (double)n;
        for (int l = 0; l < lanes; l++)
            if (n >= lane[l].begin) {
                Workspace own = {.contact = lane[l].contact};
                record(&a->kernel, &lane[l].window, &lane[l].motion, &lane[l].train, &own, &lane[l].recording,
                       n - lane[l].begin);
            }
    }
    return (double)a->end;
}

/* Number of runs that the widest vectors of the processor hold. */
EXPORT double pantocheck_lanes(void) { return lanes_of_vectors(); }

/* Eliminate station by station; the diagonal blocks A_s become D_s. */
typedef struct { int64_t bytes; Array diagonal, below; Flags free; Factor factor; } EliminateArguments;

EXPORT double pantocheck_eliminate(const EliminateArguments *a)
{
    CHECK_SIZE(a);
    int64_t stations = a->diagonal.n[1];
    for (int64_t b = 0; b < a->diagonal.n[0]; b++)
        for (int64_t s = 0; s < stations; s++) {
            double *A = &AT4(a->diagonal, b, s, 0, 0), *D = &AT3(a->factor.inverse, b, s, 0);
            const uint8_t *free = &AT3(a->free, b, s, 0);
            if (s > 0) {
                const double *B = &AT4(a->below, b, s, 0, 0), *before = D - 3;
                double *L = &AT3(a->factor.link, b, s - 1, 0);
                for (int i = 0; i < 2; i++) {
                    L[2 * i] = B[2 * i] * before[0] + B[2 * i + 1] * before[1];
                    L[2 * i + 1] = B[2 * i] * before[1] + B[2 * i + 1] * before[2];
                }
                for (int i = 0; i < 2; i++)
                    for (int j = 0; j < 2; j++)
                        A[2 * i + j] -= L[2 * i] * B[2 * j] + L[2 * i + 1] * B[2 * j + 1];
            }
            double determinant = A[0] * A[3] - A[1] * A[2];
            /* Zero for fixed unknowns, where the block is the identity. */
            D[0] = free[0] ? A[3] / determinant : 0.0;
            D[1] = free[0] && free[1] ? -A[1] / determinant : 0.0;
            D[2] = free[1] ? A[0] / determinant : 0.0;
        }
    return 0.0;
}

typedef struct {
    int64_t bytes;
    Factor factor;
    int64_t row, first, last;
    Array w, r;
    int64_t shift;
} SolveStationsArguments;

EXPORT double pantocheck_solve_stations(const SolveStationsArguments *a)
{
    CHECK_SIZE(a);
    solve_row(&a->factor, a->row, a->first, a->last, a->w.at, a->r.at, a->shift);
    return 0.0;
}

/* Fill local columns of the inverse for unit forces. */
typedef struct { int64_t bytes; Factor factor; Indices rows, stations, starts; Array columns; } InverseColumnsArguments;

EXPORT double pantocheck_inverse_columns(const InverseColumnsArguments *a)
{
    CHECK_SIZE(a);
    int64_t size = a->columns.n[2], stations = a->factor.link.n[1];
    for (int64_t k = 0; k < a->rows.n[0]; k++) {
        int64_t start = a->starts.at[k];
        double *column = a->columns.at + 2 * size * k;
        column[a->stations.at[k] - start] = 1.0;
        solve_row(&a->factor, a->rows.at[k], most(0, start), least(stations, start + size) - 1, column, column + size,
                  -start);
    }
    return 0.0;
}

/* Largest size of a column of the inverse at a cut on either side of its load, relative to its peak. */
typedef struct {
    int64_t bytes;
    Factor factor;
    Indices rows, stations;
    int64_t half_width;
    Array column;
} LargestTailArguments;

EXPORT double pantocheck_largest_tail(const LargestTailArguments *a)
{
    CHECK_SIZE(a);
    int64_t half = a->half_width, size = 2 * half;
    double largest = 0.0, *w = a->column.at, *r = a->column.at + size;
    for (int64_t k = 0; k < a->rows.n[0]; k++) {
        int64_t station = a->stations.at[k];
        for (int slope = 0; slope < 2; slope++) {
            memset(w, 0, 2 * (size_t)size * sizeof *w);
            w[slope * size + half] = 1.0;
            solve_row(&a->factor, a->rows.at[k], most(0, station - half),
                      least(a->factor.link.n[1], station + half) - 1, w, r, half - station);
            double peak = 0.0;
            for (int64_t i = 0; i < size; i++)
                peak = larger(peak, fabs(w[i]) + fabs(r[i]));
            double tail = larger(fabs(w[0]) + fabs(r[0]), fabs(w[size - 1]) + fabs(r[size - 1]));
            if (peak > 0.0)
                largest = larger(largest, tail / peak);
        }
    }
    return largest;
}

/* Largest number of stations over which products of the factors L_s decay. */
typedef struct { int64_t bytes; Factor factor; Array position; } MeasureFadeArguments;

EXPORT double pantocheck_measure_fade(const MeasureFadeArguments *m)
{
    CHECK_SIZE(m);
    int64_t stations = m->factor.link.n[1], longest = 1;
    for (int64_t row = 0; row < m->factor.link.n[0]; row++)
        for (int64_t start = 0; start < stations - 1; start++) {
            double length = m->position.at[start + 1] - m->position.at[start];
            double a = 1.0, b = 0.0, c = 0.0, d = 1.0, size = 1.0;
            int64_t s = start;
            for (; s < stations - 1 && size > FADED; s++) {
                const double *L = &AT3(m->factor.link, row, s, 0);
                double a1 = L[0] * a + L[1] * c, b1 = L[0] * b + L[1] * d;
                c = L[2] * a + L[3] * c;
                d = L[2] * b + L[3] * d;
                a = a1, b = b1;
                size = larger(larger(larger(fabs(a), fabs(b) * length), fabs(c) / length), fabs(d));
            }
            longest = most(longest, s - start);
        }
    return (double)longest;
}

#ifndef SOURCE_DIGEST
#define SOURCE_DIGEST "not stated"
#endif
/* SHA-256 of this file, by which a caller recognises a library of another source; and the compiler. */
EXPORT const char pantocheck_source[] = SOURCE_DIGEST;
EXPORT const char pantocheck_compiler[] =
#if defined(__clang__)
    __VERSION__;
#else
    "GCC " __VERSION__;
#endif
