/* Parts of a time step for WIDTH runs on one line, each in one lane of a vector: included by time_step_vectors.h.
 *
 * The state of the runs is interleaved: value n of run l is at index n * WIDTH + l. A run does in its lane what it does
 * alone (WIDTH 1), operation by operation, so that its bits depend neither on the width nor on the other runs. The runs
 * share one sweep along the line; a station outside of the window of a run is held by a mask.
 */

#define any WIDE(any)
#define choose WIDE(choose)
#define inside WIDE(inside)
#define clear WIDE(clear)
#define clear_outside WIDE(clear_outside)
#define multiply_lanes WIDE(multiply_lanes)

#if WIDTH == 1
INLINE int any(Mask m) { return m != 0; }
INLINE Vector choose(Mask m, Vector a, Vector b) { return m ? a : b; }
INLINE Mask inside(const Windows *windows, int64_t station) { (void)windows, (void)station; return 1; }
#else
INLINE int any(Mask m)
{
    int64_t bits = 0;
    for (int l = 0; l < WIDTH; l++)
        bits |= m[l];
    return bits != 0;
}
INLINE Vector choose(Mask m, Vector a, Vector b) { return (Vector)((m & (Mask)a) | (~m & (Mask)b)); }
/* Whether a station is inside the window of each run. */
INLINE Mask inside(const Windows *windows, int64_t station)
{
    Mask first, last, here = station - (Mask){0};
    memcpy(&first, windows->first, sizeof first);
    memcpy(&last, windows->last, sizeof last);
    return (Mask)(first <= here) & (Mask)(here <= last);
}
#endif

VECTOR_CODE void WIDE(add_lumped_forces)(const WireArrays *wires, const Motion *motion, const Windows *windows)
{
    double *w = motion->w.at;
    int64_t plane = motion->w.n[1] * motion->w.n[2] * WIDTH;
    for (int64_t k = 0; k < wires->lumped_run.n[0] - 1; k++) {
        Window active = active_run(&wires->lumped_station, &wires->lumped_run, k, windows->all);
        for (int64_t n = active.first; n < active.last; n++) {
            double *at = w + wires->lumped_index.at[n] * WIDTH;
            Vector elastic = wires->lumped_stiffness.at[n] * load(at);
            Vector viscous = wires->lumped_damping.at[n] * load(at + plane);
            Mask moved = inside(windows, wires->lumped_station.at[n]);
            store(at + 2 * plane, load(at + 2 * plane) - choose(moved, elastic + viscous, splat(0.0)));
        }
    }
}

VECTOR_CODE void WIDE(predict_connectors)(const ConnectorArrays *connectors, const ScalarForces *forces,
                                          const Motion *motion, const ScalarWorkspace *work, const Windows *windows)
{
    const ScalarLaw *law = &forces->law;
    int64_t plane = motion->w.n[1] * motion->w.n[2] * WIDTH, ends = connectors->end_index.n[1];
    for (int64_t k = 0; k < connectors->run.n[0] - 1; k++) {
        Window active = active_run(&connectors->station, &connectors->run, k, windows->all);
        for (int64_t n = active.first; n < active.last; n++) {
            Vector elongation = splat(0.0), rate = splat(0.0);
            Vector change = choose(inside(windows, connectors->station.at[n]),
                                   load(motion->force.at + n * WIDTH) - law->preload.at[n], splat(0.0));
            for (int64_t e = 0; e < ends; e++) {
                double c = AT2(connectors->end_coefficient, n, e);
                double *at = motion->w.at + AT2(connectors->end_index, n, e) * WIDTH;
                elongation += c * load(at);
                rate += c * load(at + plane);
                store(at + 2 * plane, load(at + 2 * plane) - c * change);
            }
            store(work->predicted.at + n * WIDTH,
                  law->preload.at[n] + law->stiffness.at[n] * elongation + law->damping.at[n] * rate);
            store(work->change.at + n * WIDTH, splat(0.0));
        }
    }
}

VECTOR_CODE void WIDE(accelerate_ends)(const ConnectorArrays *connectors, const Array *node,
                                       const ScalarWorkspace *work, const Windows *windows)
{
    int64_t ends = connectors->end_node.n[1];
    for (int64_t k = 0; k < connectors->run.n[0] - 1; k++) {
        Window active = active_run(&connectors->station, &connectors->run, k, windows->all);
        for (int64_t n = active.first; n < active.last; n++) {
            Vector acceleration = splat(0.0);
            for (int64_t e = 0; e < ends; e++)
                acceleration += AT2(connectors->end_coefficient, n, e) *
                                load(node->at + AT2(connectors->end_node, n, e) * WIDTH);
            store(work->acceleration.at + n * WIDTH, acceleration);
        }
    }
}

VECTOR_CODE void WIDE(load_connectors)(const ConnectorArrays *connectors, const Motion *motion,
                                       const ScalarWorkspace *work, const Windows *windows)
{
    int64_t plane = motion->w.n[1] * motion->w.n[2], ends = connectors->end_index.n[1];
    for (int64_t k = 0; k < connectors->run.n[0] - 1; k++) {
        Window active = active_run(&connectors->station, &connectors->run, k, windows->all);
        for (int64_t n = active.first; n < active.last; n++)
            for (int64_t e = 0; e < ends; e++) {
                double *at = motion->w.at + (AT2(connectors->end_index, n, e) + 2 * plane) * WIDTH;
                store(at, load(at) - AT2(connectors->end_coefficient, n, e) * load(work->change.at + n * WIDTH));
            }
    }
}

/* Sweep over some scalar forces of the runs whose forces have not settled; `largest` becomes that of all changes. */
VECTOR_CODE void WIDE(sweep_forces)(const ScalarForces *forces, const ScalarWorkspace *work, double *force,
                                    const int64_t *station, int64_t first, int64_t end, const Windows *windows,
                                    double *largest)
{
    Vector maximum = load(largest);
    Mask running;
    memcpy(&running, windows->running, sizeof running);
    for (int64_t n = first; n < end; n++) {
        Vector old = load(force + n * WIDTH), zero = splat(0.0);
        Vector new = load(work->predicted.at + n * WIDTH) +
                     forces->per_acceleration.at[n] * load(work->acceleration.at + n * WIDTH) +
                     forces->self_compliance.at[n] * old;
        new *= forces->settling.at[n];
        if (forces->law.unilateral.at[n])
            new = choose(new < zero, zero, new);
        Mask swept = running & inside(windows, station ? station[n] : 0);
        Vector change = choose(swept, new - old, zero), size = choose(change < zero, -change, change);
        Mask changed = size > splat(NEGLIGIBLE_FORCE);
        if (any(changed)) {
            change = choose(changed, change, zero);
            store(force + n * WIDTH, choose(changed, new, old));
            store(work->change.at + n * WIDTH, load(work->change.at + n * WIDTH) + change);
            for (int64_t i = forces->first.at[n]; i < forces->first.at[n + 1]; i++) {
                double *at = work->acceleration.at + forces->other.at[i] * WIDTH;
                store(at, load(at) - forces->compliance.at[i] * change);
            }
        }
        /* NaN if either is NaN */
        maximum = choose((maximum >= size) | (maximum != maximum), maximum, size);
    }
    store(largest, maximum);
}

#if WIDTH > 1
/* Inner product of a pair and two fields of each run, summed like `inner_product`. */
INLINE Vector multiply_lanes(const double *pair, int64_t size, const double *w, const double *r)
{
    Vector sum[LANES];
    for (int k = 0; k < LANES; k++) {
        Vector product = splat(0.0), other = splat(0.0);
        for (int64_t i = k; i < size; i += LANES) {
            product = product + pair[i] * load(w + i * WIDTH);
            other = other + pair[size + i] * load(r + i * WIDTH);
        }
        sum[k] = product + other;
    }
    return ((sum[0] + sum[4]) + (sum[2] + sum[6])) + ((sum[1] + sum[5]) + (sum[3] + sum[7]));
}

VECTOR_CODE void WIDE(accelerate_nodes)(const NodeArrays *nodes, const Motion *motion, const Array *node, int64_t row,
                                        Window window)
{
    int64_t first = search(nodes->station.at, nodes->first.at[row], nodes->first.at[row + 1], window.first);
    int64_t end = search(nodes->station.at, first, nodes->first.at[row + 1], window.last + 1);
    int64_t size = nodes->column.n[2], plane = (2 * motion->w.n[1] + row) * motion->w.n[2];
    for (int64_t j = first; j < end; j++) {
        int64_t at = (plane + nodes->column_start.at[j]) * WIDTH;
        store(node->at + j * WIDTH,
              multiply_lanes(nodes->column.at + 2 * j * size, size, motion->w.at + at, motion->r.at + at));
    }
}

/* Set the values of all runs to zero from a station on, before another. */
INLINE void clear(double *field, int64_t first, int64_t end)
{
    for (int64_t s = first; s < end; s++)
        store(field + s * WIDTH, splat(0.0));
}

/* Set the values of each run to zero at the stations outside of its window; `field` begins with station 0. */
INLINE void clear_outside(double *field, const Windows *windows)
{
    for (int64_t s = windows->all.first; s <= windows->all.last; s++) {
        if (s == windows->common.first && (s = windows->common.last + 1) > windows->all.last)
            return;
        store(field + s * WIDTH, choose(inside(windows, s), load(field + s * WIDTH), splat(0.0)));
    }
}

/* Predict the motion of one wire in all runs, and store its forces. */
VECTOR_CODE void WIDE(predict_wire_lanes)(double dt, double coefficient, const double *elements, double *w, double *r,
                                          int64_t width, int64_t plane, const Windows *windows)
{
    Vector delta = splat(dt), square = splat(dt * dt), beta = splat(coefficient), zero = splat(0.0);
    Vector w0, v0, r0, u0, w1, v1, r1, u1, entries[ENTRIES];
    Element before = {zero, zero, zero, zero};
    int64_t first = windows->all.first, start = first > 0 ? first - 1 : 0;
    plane *= WIDTH;
    predict(w + start * WIDTH, plane, delta, square, &w0, &v0);
    predict(r + start * WIDTH, plane, delta, square, &r0, &u0);
    w0 = w0 + beta * v0, r0 = r0 + beta * u0;
    for (int64_t s = start; s <= windows->all.last; s++) {
        predict(w + (s + 1) * WIDTH, plane, delta, square, &w1, &v1);
        predict(r + (s + 1) * WIDTH, plane, delta, square, &r1, &u1);
        w1 = w1 + beta * v1, r1 = r1 + beta * u1;
        for (int i = 0; i < ENTRIES; i++)
            entries[i] = splat(elements[i * width + s]);
        Element here = deform(entries, w0, w1, r0, r1, v0, v1, u0, u1);
        if (s >= first) {
            store(w + 2 * plane + s * WIDTH, (before.shear - here.shear) - (before.drag + here.drag));
            store(r + 2 * plane + s * WIDTH, (before.bend - here.bend) - (before.tilt + here.tilt));
        }
        before = here;
        w0 = w1, v0 = v1, r0 = r1, u0 = u1;
    }
    clear_outside(w + 2 * plane, windows);
    clear_outside(r + 2 * plane, windows);
}

typedef struct { const double *link, *inverse; double *w, *r; } WIDE(Piece);
#define Piece WIDE(Piece)

INLINE Piece WIDE(piece_at)(const Factor *factor, int64_t row, double *w, double *r, int64_t s)
{
    return (Piece){&AT3(factor->link, row, s, 0), &AT3(factor->inverse, row, s, 0), w + s * WIDTH, r + s * WIDTH};
}

/* Eliminate station s of a piece, and substitute it back, as in a panel. */
INLINE void WIDE(eliminate)(const Piece *a, int64_t s, int keep, Vector *p, Vector *q)
{
    const double *L = a->link + 4 * s;
    Vector w = load(a->w + s * WIDTH) - *p, r = load(a->r + s * WIDTH) - *q;
    if (keep) {
        store(a->w + s * WIDTH, w);
        store(a->r + s * WIDTH, r);
    }
    *p = splat(L[0]) * w + splat(L[1]) * r;
    *q = splat(L[2]) * w + splat(L[3]) * r;
}

INLINE void WIDE(substitute)(const Piece *a, int64_t s, int keep, Vector *x, Vector *y)
{
    const double *L = a->link + 4 * s, *D = a->inverse + 3 * s;
    Vector w = load(a->w + s * WIDTH), r = load(a->r + s * WIDTH), x0 = *x, y0 = *y;
    *x = splat(D[0]) * w + splat(D[1]) * r - splat(L[0]) * x0 - splat(L[2]) * y0;
    *y = splat(D[1]) * w + splat(D[2]) * r - splat(L[1]) * x0 - splat(L[3]) * y0;
    if (keep) {
        store(a->w + s * WIDTH, *x);
        store(a->r + s * WIDTH, *y);
    }
}

/* Eliminate `size` stations of piece a[0] and, in a pair, piece a[1] before it; warm: from the piece before the last. */
INLINE void WIDE(eliminate_pieces)(const Piece a[3], int64_t piece, int64_t fade, int64_t size, int pair, int warm)
{
    Vector p[2], q[2];
    for (int k = 0; k < 2; k++)
        p[k] = q[k] = splat(0.0);
    for (int64_t s = piece - fade; s < piece; s++)
        for (int k = 0; k < pair + warm; k++)
            WIDE(eliminate)(&a[k + 1], s, 0, &p[k], &q[k]);
    for (int64_t s = 0; s < size; s++)
        for (int k = 0; k < 1 + pair; k++)
            WIDE(eliminate)(&a[k], s, 1, &p[k], &q[k]);
    for (int64_t s = size; s < piece && pair; s++)
        WIDE(eliminate)(&a[1], s, 1, &p[1], &q[1]);
}

INLINE void WIDE(substitute_pieces)(const Piece a[3], const Mask follows[2], int64_t piece, int64_t fade, int pair)
{
    Vector x[2], y[2];
    for (int k = 0; k < 2; k++)
        x[k] = y[k] = splat(0.0);
    for (int64_t s = fade - 1; s >= 0; s--)
        for (int k = 0; k < 1 + pair; k++)
            WIDE(substitute)(&a[k + 1], s, 0, &x[k], &y[k]);
    for (int k = 0; k < 1 + pair; k++) {
        x[k] = choose(follows[k], x[k], splat(0.0));
        y[k] = choose(follows[k], y[k], splat(0.0));
    }
    for (int64_t s = piece - 1; s >= 0; s--)
        for (int k = 0; k < 1 + pair; k++)
            WIDE(substitute)(&a[k], s, 1, &x[k], &y[k]);
}

/* Solve A x = f in place for one wire, in the pieces and with the warm-ups of `solve_wires`; w, r: forces of the row.
 * Adds the accelerations at the first stations of the pieces: NaN if any force was NaN. */
VECTOR_CODE void WIDE(solve_wire_lanes)(const PanelFactor *panels, const Factor *factor, int64_t row, double *w,
                                        double *r, const Windows *windows, double *total)
{
    int64_t piece = panels->piece, fade = panels->fade;
    int64_t low = windows->all.first / piece, high = windows->all.last / piece;
    int64_t top = (high + 1) % LANES ? high + 1 : high; /* the piece after the window, in the same panel */
    Vector sum = load(total);
    for (int64_t j = top; j >= low; j -= 2) {
        int64_t size = j > high ? fade : piece;
        Piece a[3];
        for (int k = 0; k < 3; k++)
            a[k] = WIDE(piece_at)(factor, row, w, r, most(j - k, 0) * piece);
        if (j > low + 1)
            WIDE(eliminate_pieces)(a, piece, fade, size, 1, 1);
        else if (j > low)
            WIDE(eliminate_pieces)(a, piece, fade, size, 1, 0);
        else
            WIDE(eliminate_pieces)(a, piece, fade, size, 0, 0);
    }
    for (int64_t j = low; j <= high; j += 2) {
        Piece a[3];
        Mask follows[2];
        for (int k = 0; k < 3; k++)
            a[k] = WIDE(piece_at)(factor, row, w, r, least(j + k, top) * piece);
        for (int k = 0; k < 2; k++) {
            /* Some piece follows, and for runs whose last panel ends here none. */
            int64_t next = j + k + 1;
            follows[k] = (Mask){0};
            for (int l = 0; l < WIDTH; l++)
                follows[k][l] = -(next <= top && (next % LANES || windows->last[l] >= next * piece));
        }
        if (j < high)
            WIDE(substitute_pieces)(a, follows, piece, fade, 1);
        else
            WIDE(substitute_pieces)(a, follows, piece, fade, 0);
        for (int64_t k = j; k <= least(j + 1, high); k++)
            sum = sum + load(w + k * piece * WIDTH);
    }
    int64_t end = top * piece + (top > high ? fade : piece);
    double *fields[2] = {w, r};
    for (int f = 0; f < 2; f++) {
        clear(fields[f], low * piece, windows->all.first);
        clear(fields[f], windows->all.last + 1, end);
        clear_outside(fields[f], windows);
    }
    store(total, sum);
}
#undef Piece
#endif

#undef any
#undef choose
#undef inside
#undef clear
#undef clear_outside
#undef multiply_lanes
