/* Functions of vectors of WIDTH numbers: included by time_step.c once for each width; those of panels for 4 and 2.
 *
 * The lanes of a panel are LANES pieces of a row; PARTS vectors hold them. All results have the same bits for each width:
 * lanes do not influence each other, and sums over lanes have a fixed order.
 */

#define PARTS (LANES / WIDTH)
#define Vector WIDE(Vector)
#define Unaligned WIDE(Unaligned)
#define load WIDE(load)
#define store WIDE(store)
#define splat WIDE(splat)
#define Mask WIDE(Mask)
#define Element WIDE(Element)
#define deform WIDE(deform)
#define shift_up WIDE(shift_up)
#define shift_down WIDE(shift_down)
#define transpose WIDE(transpose)
#define copy_block WIDE(copy_block)
#define predict WIDE(predict)
#define eliminate_station WIDE(eliminate_station)
#define substitute_station WIDE(substitute_station)
#define part_of WIDE(part_of)
#define shift_lanes_up WIDE(shift_lanes_up)
#define shift_lanes_down WIDE(shift_lanes_down)
#define VECTOR_CODE static __attribute__((noinline))

#if WIDTH == 1
typedef double Vector;
typedef double Unaligned;
typedef int64_t Mask;
#else
typedef double Vector __attribute__((vector_size(8 * WIDTH)));
typedef double Unaligned __attribute__((vector_size(8 * WIDTH), aligned(8), may_alias));
typedef int64_t Mask __attribute__((vector_size(8 * WIDTH)));
#endif
#if defined(__clang__)
#define SHUFFLE(a, b, ...) __builtin_shufflevector(a, b, __VA_ARGS__)
#else
#define SHUFFLE(a, b, ...) __builtin_shuffle(a, b, (Mask){__VA_ARGS__})
#endif

INLINE Vector load(const double *from) { return *(const Unaligned *)from; }
INLINE void store(double *to, Vector v) { *(Unaligned *)to = v; }
INLINE Vector splat(double x) { return x - (Vector){0.0}; }

/* Forces of some elements between station 0 and 1 (`wire_step.py`): w, r and their rates v, u; those of stiffness are
 * given with damped w and r. */
typedef struct { Vector shear, drag, tilt, bend; } Element;

INLINE Element deform(const Vector entries[ENTRIES], Vector w0, Vector w1, Vector r0, Vector r1, Vector v0, Vector v1,
                      Vector u0, Vector u1)
{
    Vector difference = w0 - w1, total = r0 + r1, mass = entries[4], length = entries[5];
    Vector apart = v0 - v1, along = v0 + v1, alike = length * (u0 + u1), against = length * (u0 - u1);
    Vector moment = mass * length, shear = entries[0] * difference + entries[1] * total;
    Vector tilt = entries[1] * difference + entries[2] * total, bend = entries[3] * (r0 - r1);
    return (Element){
        .shear = shear + mass * (splat(51.0) * apart + splat(4.5) * alike),
        .drag = mass * (splat(105.0) * along + splat(17.5) * against),
        .tilt = tilt + moment * (splat(4.5) * apart + splat(0.5) * alike),
        .bend = bend + moment * (splat(17.5) * along + splat(3.5) * against),
    };
}

/* Predict displacement q and velocity v of some stations. */
INLINE void predict(double *field, int64_t plane, Vector delta, Vector square, Vector *q, Vector *v)
{
    Vector displacement = load(field), velocity = load(field + plane), acceleration = load(field + 2 * plane);
    *q = displacement + (delta * velocity + square * acceleration);
    *v = velocity + delta * acceleration;
    store(field, *q);
    store(field + plane, *v);
}

#if WIDTH == 2 || WIDTH == 4
/* Move every number up (down) by one; the first (last) one comes from the last (first) one of the other vector.
 * Transpose WIDTH vectors: number i of vector j becomes number j of vector i. */
#if WIDTH == 4
INLINE Vector shift_up(Vector v, Vector before) { return SHUFFLE(before, v, 3, 4, 5, 6); }
INLINE Vector shift_down(Vector v, Vector after) { return SHUFFLE(v, after, 1, 2, 3, 4); }
INLINE void transpose(Vector v[WIDTH])
{
    for (int i = 0; i < 4; i += 2) {
        Vector a = v[i], b = v[i + 1];
        v[i] = SHUFFLE(a, b, 0, 4, 2, 6);
        v[i + 1] = SHUFFLE(a, b, 1, 5, 3, 7);
    }
    for (int i = 0; i < 2; i++) {
        Vector a = v[i], b = v[i + 2];
        v[i] = SHUFFLE(a, b, 0, 1, 4, 5);
        v[i + 2] = SHUFFLE(a, b, 2, 3, 6, 7);
    }
}
#else
INLINE Vector shift_up(Vector v, Vector before) { return SHUFFLE(before, v, 1, 2); }
INLINE Vector shift_down(Vector v, Vector after) { return SHUFFLE(v, after, 1, 2); }
INLINE void transpose(Vector v[WIDTH])
{
    Vector a = v[0], b = v[1];
    v[0] = SHUFFLE(a, b, 0, 2);
    v[1] = SHUFFLE(a, b, 1, 3);
}
#endif

/* Inner product of two rows of a pair, one after the other, with parts of two fields; `size` is a multiple of LANES. */
VECTOR_CODE double WIDE(inner_product)(const double *pair, int64_t size, const double *w, const double *r)
{
    Vector product[PARTS], other[PARTS];
    double lane[LANES];
    for (int k = 0; k < PARTS; k++)
        product[k] = other[k] = splat(0.0);
    for (int64_t i = 0; i < size; i += LANES)
        for (int k = 0; k < PARTS; k++) {
            int64_t at = i + k * WIDTH;
            product[k] = product[k] + load(pair + at) * load(w + at);
            other[k] = other[k] + load(pair + size + at) * load(r + at);
        }
    for (int k = 0; k < PARTS; k++)
        store(lane + k * WIDTH, product[k] + other[k]);
    return ((lane[0] + lane[4]) + (lane[2] + lane[6])) + ((lane[1] + lane[5]) + (lane[3] + lane[7]));
}

/* Add a value times a row to a field. */
VECTOR_CODE void WIDE(add_multiple)(double *field, double value, const double *row, int64_t size)
{
    Vector x = splat(value);
    for (int64_t i = 0; i < size; i += WIDTH)
        store(field + i, load(field + i) + x * load(row + i));
}

/* Predict the motion of one wire, and store its forces (`wire_step.py`). */
VECTOR_CODE void WIDE(predict_wire)(double dt, double coefficient, const double *elements, double *w, double *r,
                                    int64_t width, int64_t plane, int64_t first, int64_t last)
{
    Vector delta = splat(dt), square = splat(dt * dt), beta = splat(coefficient), zero = splat(0.0);
    Vector w0, v0, r0, u0, w_next, v_next, r_next, u_next, entries[ENTRIES];
    Element before = {zero, zero, zero, zero};
    int64_t start = first > 0 ? first - WIDTH : 0;
    predict(w + start, plane, delta, square, &w0, &v0);
    predict(r + start, plane, delta, square, &r0, &u0);
    for (int64_t s = start; s <= last; s += WIDTH) {
        /* Some stations, and those after each of them. */
        predict(w + s + WIDTH, plane, delta, square, &w_next, &v_next);
        predict(r + s + WIDTH, plane, delta, square, &r_next, &u_next);
        Vector damped_w = w0 + beta * v0, damped_r = r0 + beta * u0;
        for (int i = 0; i < ENTRIES; i++)
            entries[i] = load(elements + i * width + s);
        Element here = deform(entries, damped_w, shift_down(damped_w, w_next + beta * v_next), damped_r,
                              shift_down(damped_r, r_next + beta * u_next), v0, shift_down(v0, v_next), u0,
                              shift_down(u0, u_next));
        if (s >= first) {
            /* Reactions of the elements before and after each station. */
            store(w + 2 * plane + s, (shift_up(here.shear, before.shear) - here.shear) -
                                         (shift_up(here.drag, before.drag) + here.drag));
            store(r + 2 * plane + s,
                  (shift_up(here.bend, before.bend) - here.bend) - (shift_up(here.tilt, before.tilt) + here.tilt));
        }
        before = here;
        w0 = w_next, v0 = v_next, r0 = r_next, u0 = u_next;
    }
}

/* Copy a block of WIDTH vectors, transposed; their distances are in numbers. */
INLINE void copy_block(double *to, int64_t to_distance, const double *from, int64_t from_distance)
{
    Vector v[WIDTH];
    for (int j = 0; j < WIDTH; j++)
        v[j] = load(from + j * from_distance);
    transpose(v);
    for (int j = 0; j < WIDTH; j++)
        store(to + j * to_distance, v[j]);
}

/* Copy the stations of a panel, from `field` on, to the lanes; the two values of a station are LANES numbers apart. */
VECTOR_CODE void WIDE(gather)(int64_t piece, const double *field, double *lanes)
{
    for (int64_t i = 0; i < piece; i += WIDTH)
        for (int k = 0; k < LANES; k += WIDTH)
            copy_block(lanes + 2 * LANES * i + k, 2 * LANES, field + i + k * piece, piece);
}

/* Copy the lanes of a panel to its stations, and zero to those outside of the active part. */
VECTOR_CODE void WIDE(scatter)(int64_t piece, double *field, const double *lanes, int64_t start, int64_t first,
                               int64_t last)
{
    for (int64_t i = 0; i < piece; i += WIDTH)
        for (int k = 0; k < LANES; k += WIDTH)
            copy_block(field + start + i + k * piece, piece, lanes + 2 * LANES * i + k, 2 * LANES);
    for (int64_t s = start; s < first; s += WIDTH)
        store(field + s, splat(0.0));
    for (int64_t s = last + 1; s < start + LANES * piece; s += WIDTH)
        store(field + s, splat(0.0));
}

/* Eliminate station s of some pieces: p, q are force and moment that the station before transfers. */
INLINE void eliminate_station(Panel panel, int64_t s, int keep, Vector *p, Vector *q)
{
    double *f = panel.force + 2 * LANES * s;
    const double *L = panel.link + 4 * LANES * s;
    Vector w = load(f) - *p, r = load(f + LANES) - *q;
    if (keep) {
        store(f, w);
        store(f + LANES, r);
    }
    *p = load(L) * w + load(L + LANES) * r;
    *q = load(L + 2 * LANES) * w + load(L + 3 * LANES) * r;
}

/* Substitute station s of some pieces back: x, y are deflection and slope of the station after it. */
INLINE void substitute_station(Panel panel, int64_t s, int keep, Vector *x, Vector *y)
{
    double *f = panel.force + 2 * LANES * s;
    const double *L = panel.link + 4 * LANES * s, *D = panel.inverse + 3 * LANES * s;
    Vector w = load(f), r = load(f + LANES), wr = load(D + LANES), x0 = *x, y0 = *y;
    *x = load(D) * w + wr * r - load(L) * x0 - load(L + 2 * LANES) * y0;
    *y = wr * w + load(D + 2 * LANES) * r - load(L + LANES) * x0 - load(L + 3 * LANES) * y0;
    if (keep) {
        store(f, *x);
        store(f + LANES, *y);
    }
}

INLINE Panel part_of(Panel panel, int k)
{
    return (Panel){panel.force + k * WIDTH, panel.link + k * WIDTH, panel.inverse + k * WIDTH};
}

/* Move the lanes up by one; the first one comes from the last lane of `before`. */
INLINE void shift_lanes_up(Vector v[PARTS], Vector before)
{
    for (int k = PARTS - 1; k > 0; k--)
        v[k] = shift_up(v[k], v[k - 1]);
    v[0] = shift_up(v[0], before);
}

/* Move the lanes down by one; the last one comes from the first lane of `after`. */
INLINE void shift_lanes_down(Vector v[PARTS], Vector after)
{
    for (int k = 0; k < PARTS - 1; k++)
        v[k] = shift_down(v[k], v[k + 1]);
    v[PARTS - 1] = shift_down(v[PARTS - 1], after);
}

/* Eliminate panels a and b; carried: force and moment that the panel before transfers, replaced by those of b. */
VECTOR_CODE void WIDE(eliminate_pair)(Panel a, Panel b, int64_t piece, int64_t fade, const double *follows,
                                      double *carried)
{
    Vector pa[PARTS], qa[PARTS], pb[PARTS], qb[PARTS];
    Vector p = load(carried + LANES - WIDTH), q = load(carried + 2 * LANES - WIDTH);
    Vector before = splat(follows[0]), middle = splat(follows[1]);
    for (int k = 0; k < PARTS; k++)
        pa[k] = qa[k] = pb[k] = qb[k] = splat(0.0);
    for (int64_t s = piece - fade; s < piece; s++)
        for (int k = 0; k < PARTS; k++) {
            eliminate_station(part_of(a, k), s, 0, &pa[k], &qa[k]);
            eliminate_station(part_of(b, k), s, 0, &pb[k], &qb[k]);
        }
    store(carried + LANES - WIDTH, pb[PARTS - 1]);
    store(carried + 2 * LANES - WIDTH, qb[PARTS - 1]);
    shift_lanes_up(pb, middle * pa[PARTS - 1]), shift_lanes_up(qb, middle * qa[PARTS - 1]);
    shift_lanes_up(pa, before * p), shift_lanes_up(qa, before * q);
    for (int64_t s = 0; s < piece; s++)
        for (int k = 0; k < PARTS; k++) {
            eliminate_station(part_of(a, k), s, 1, &pa[k], &qa[k]);
            eliminate_station(part_of(b, k), s, 1, &pb[k], &qb[k]);
        }
}

/* Substitute back panels b and a; carried: deflection and slope at the first stations of the panel after them. */
VECTOR_CODE void WIDE(substitute_pair)(Panel a, Panel b, int64_t piece, int64_t fade, const double *follows,
                                       double *carried)
{
    Vector xa[PARTS], ya[PARTS], xb[PARTS], yb[PARTS], x = load(carried), y = load(carried + LANES);
    Vector middle = splat(follows[1]), after = splat(follows[2]);
    for (int k = 0; k < PARTS; k++)
        xa[k] = ya[k] = xb[k] = yb[k] = splat(0.0);
    for (int64_t s = fade - 1; s >= 0; s--)
        for (int k = 0; k < PARTS; k++) {
            substitute_station(part_of(b, k), s, 0, &xb[k], &yb[k]);
            substitute_station(part_of(a, k), s, 0, &xa[k], &ya[k]);
        }
    store(carried, xa[0]);
    store(carried + LANES, ya[0]);
    shift_lanes_down(xa, middle * xb[0]), shift_lanes_down(ya, middle * yb[0]);
    shift_lanes_down(xb, after * x), shift_lanes_down(yb, after * y);
    for (int64_t s = piece - 1; s >= 0; s--)
        for (int k = 0; k < PARTS; k++) {
            substitute_station(part_of(b, k), s, 1, &xb[k], &yb[k]);
            substitute_station(part_of(a, k), s, 1, &xa[k], &ya[k]);
        }
}

#endif

#include "time_step_lanes.h"

#undef PARTS
#undef Vector
#undef Unaligned
#undef SHUFFLE
#undef load
#undef store
#undef splat
#undef Mask
#undef Element
#undef deform
#undef shift_up
#undef shift_down
#undef transpose
#undef copy_block
#undef predict
#undef eliminate_station
#undef substitute_station
#undef part_of
#undef shift_lanes_up
#undef shift_lanes_down
#undef VECTOR_CODE
