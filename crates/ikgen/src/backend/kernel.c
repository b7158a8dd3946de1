/* == sqrt == */
/* Square root; 0 for negative arguments. Without the C library: Newton steps on the inverse root, then one on the root with the
   square taken exactly. */
#ifdef IK_FREESTANDING
static double ik_sqrt(double x)
{
    union { double number; uint64_t bits; } inverse, top;
    double root, half, low, rest, below;
    int i, again;
    if (!(x > 1e-300)) return 0.0;
    if (x > 1.7976931348623157e308) return x;
    inverse.number = x;
    inverse.bits = UINT64_C(0x5fe6eb50c7b537a9) - (inverse.bits >> 1);
    half = 0.5 * x;
    for (i = 0; i < 4; i++) inverse.number *= 1.5 - half * inverse.number * inverse.number;
    root = x * inverse.number;
    for (again = 0; again < 2; again++) {
        top.number = root;
        top.bits &= UINT64_C(0xfffffffff8000000);
        low = root - top.number;
        rest = ((top.number * top.number - root * root) + top.number * low + low * top.number) + low * low;
        rest = (x - root * root) - rest;
        if (again == 0) root = root + 0.5 * inverse.number * rest;
    }
    /* Just below powers of four the sum is half way between two numbers: the lower one is nearer. */
    top.number = root;
    top.bits -= 1;
    below = top.number;
    return rest <= -root * (root - below) ? below : root;
}
#else
static double ik_sqrt(double x) { return x > 0.0 ? sqrt(x) : 0.0; }
#endif

/* == abs == */
static double ik_abs(double x) { return x < 0.0 ? -x : x; }

/* == finite == */
static int ik_finite(double x) { return x - x == 0.0; }

/* == min == */
static double ik_min(double a, double b) { return a < b ? a : b; }

/* == max == */
static double ik_max(double a, double b) { return a > b ? a : b; }

/* == cos_sin == */
/* Cosine and sine within one unit in the last place, for up to a million quarter turns. */
static void ik_cos_sin(double angle, double out[2])
{
    static const double sines[7] = { -1307674368000.0, 6227020800.0, -39916800.0, 362880.0, -5040.0, 120.0, -6.0 };
    static const double cosines[6] = { -87178291200.0, 479001600.0, -3628800.0, 40320.0, -720.0, 24.0 };
    double scaled = angle * 0.6366197723675814;
    double k, a, b, c, ab, x, shift, low, z, s, half, w;
    int64_t quarter = 0;
    int i;
    if (scaled > -1e15 && scaled < 1e15) quarter = (int64_t)(scaled < 0.0 ? scaled - 0.5 : scaled + 0.5);
    k = (double)quarter;
    /* pi/2 in three parts, of which the first two have 33 bits. */
    b = k * 6.077100506303966e-11;
    c = k * 2.0222662487959506e-21;
    a = angle - k * 1.5707963267341256;
    ab = a - b;
    x = ab - c;
    shift = ab - a;
    low = ((a - (ab - shift)) - (b + shift)) + ((ab - x) - c);
    z = x * x;
    s = 1.0 / 355687428096000.0;
    for (i = 0; i < 7; i++) s = 1.0 / sines[i] + z * s;
    half = 0.5 * z;
    s = x + (x * z * s + low * (1.0 - half));
    c = 1.0 / 20922789888000.0;
    for (i = 0; i < 6; i++) c = 1.0 / cosines[i] + z * c;
    w = 1.0 - half;
    c = w + (((1.0 - w) - half) + (z * z * c - x * low));
    switch (quarter & 3) {
    case 0: out[0] = c; out[1] = s; break;
    case 1: out[0] = -s; out[1] = c; break;
    case 2: out[0] = -c; out[1] = -s; break;
    default: out[0] = s; out[1] = -c; break;
    }
}

/* == sin == */
static double ik_sin(double x)
{
    double turn[2];
    ik_cos_sin(x, turn);
    return turn[1];
}

/* == cos == */
static double ik_cos(double x)
{
    double turn[2];
    ik_cos_sin(x, turn);
    return turn[0];
}

/* == angle_of == */
/* Angle with this sine and cosine in (-pi, pi]. Folded to the first octant and turned back by the nearest of the angles with sine
   k/16; what is left is a small sine. */
static double ik_angle_of(double sine, double cosine)
{
    static const double sixteenths[12][2] = {
        { 1.0, 0.0 },
        { 0.998044963916957, 0.06254076179649139 },
        { 0.9921567416492215, 0.1253278311680654 },
        { 0.982264602843857, 0.1886163861754041 },
        { 0.9682458365518543, 0.25268025514207865 },
        { 0.9499177595981665, 0.31782370392788073 },
        { 0.9270248108869579, 0.3843967744956391 },
        { 0.899218410621135, 0.4528165947449256 },
        { 0.8660254037844386, 0.5235987755982989 },
        { 0.8267972847076845, 0.5974064166453502 },
        { 0.7806247497997998, 0.6751315329370317 },
        { 0.7261843774138906, 0.758040765426236 }
    };
    static const double octants[4][2] = {
        { 0.0, 1.0 }, { 1.5707963267948966, -1.0 }, { 3.141592653589793, -1.0 }, { 1.5707963267948966, 1.0 }
    };
    static const double coefficients[4] = { 105.0 / 3456.0, 15.0 / 336.0, 3.0 / 40.0, 1.0 / 6.0 };
    double ac = ik_abs(cosine), as = ik_abs(sine);
    double large = ac > as ? ac : as, small = ac > as ? as : ac;
    double x, z, p = 945.0 / 42240.0, octant, angle;
    const double *place;
    int k = small < 1.0 ? (int)(small * 16.0 + 0.5) : 11, i;
    if (k > 11) k = 11;
    x = small * sixteenths[k][0] - large * (k * 0.0625);
    z = x * x;
    for (i = 0; i < 4; i++) p = coefficients[i] + z * p;
    octant = sixteenths[k][1] + (x + x * z * p);
    place = octants[(as > ac) + 2 * (cosine < 0.0)];
    angle = place[0] + place[1] * octant;
    return sine < 0.0 && angle < 3.141592653589793 ? -angle : angle;
}

/* == opposite == */
/* The angle half a turn on. */
static double ik_opposite(double angle)
{
    double turned = angle > 0.0 ? angle - 3.141592653589793 : angle + 3.141592653589793;
    return turned > -3.141592653589793 ? turned : 3.141592653589793;
}

/* == mirrored == */
/* The angle with the other sign. */
static double ik_mirrored(double angle) { return angle < 3.141592653589793 ? -angle : angle; }

/* == roots == */
/* Below this a coefficient counts as zero: the equation then says nothing about its unknown. */
#define IK_VANISHING 1e-11

/* The roots of an equation, each cosine and sine of an angle, or a length. Of an unknown that is free later ones are tried only
   while none has led to a solution. */
typedef struct {
    double items[IK_MOST_ROOTS][2];
    int count;
    int is_free;
} ik_roots;

static void ik_push(ik_roots *roots, double x, double y)
{
    if (roots->count < IK_MOST_ROOTS) {
        roots->items[roots->count][0] = x;
        roots->items[roots->count][1] = y;
        roots->count++;
    }
}

static int ik_count(const ik_roots *roots) { return roots->is_free ? roots->count + 32 : roots->count; }

/* One of them; beyond those found, angles that divide the circle more and more finely, zero first. */
static void ik_get(const ik_roots *roots, int i, double out[2])
{
    int k, bit, reversed = 0;
    if (i < roots->count) {
        out[0] = roots->items[i][0];
        out[1] = roots->items[i][1];
        return;
    }
    k = i - roots->count;
    for (bit = 0; bit < 5; bit++) reversed |= (k >> bit & 1) << (4 - bit);
    ik_cos_sin((double)reversed * (6.283185307179586 / 32.0), out);
}

/* == apart == */
/* The sine at which two roots that nearly fall together are started: the equations say where they meet only up to `slack`. */
static double ik_apart(double sine, double slack)
{
    double least = ik_sqrt(2.0 * slack);
    if (sine < least) return least < 0.2 ? least : 0.2;
    return sine;
}

/* == align == */
/* The angle whose cosine and sine are proportional to x and y. */
static ik_roots ik_align(double x, double y, double slack)
{
    ik_roots roots = { { { 0.0, 0.0 } }, 0, 0 };
    double n = ik_sqrt(x * x + y * y);
    if (!ik_finite(x) || !ik_finite(y)) return roots;
    if (n < IK_VANISHING * IK_VANISHING) {
        roots.is_free = 1;
        return roots;
    }
    roots.is_free = n < IK_VANISHING || n < slack;
    ik_push(&roots, x / n, y / n);
    return roots;
}

/* == half == */
/* The angle along (x, |y|). */
static ik_roots ik_half(double x, double y, double slack)
{
    ik_roots roots = { { { 0.0, 0.0 } }, 0, 0 };
    double n = ik_sqrt(x * x + y * y);
    if (!ik_finite(x) || !ik_finite(y)) return roots;
    if (n < IK_VANISHING) {
        roots.is_free = 1;
        return roots;
    }
    ik_push(&roots, x / n, ik_apart(ik_abs(y) / n, slack / n));
    return roots;
}

/* == mirror == */
/* The angles along (x, y) and (x, -y). */
static ik_roots ik_mirror(double x, double y, double slack)
{
    ik_roots roots = ik_half(x, y, slack);
    if (roots.count > 0 && roots.items[0][1] > IK_VANISHING) ik_push(&roots, roots.items[0][0], -roots.items[0][1]);
    return roots;
}

/* == circle == */
/* The angles with a cos + b sin = d; where the line misses the circle by no more than 1e-9 and `slack`, the nearest. */
static ik_roots ik_circle(double a, double b, double d, double slack)
{
    ik_roots roots = { { { 0.0, 0.0 } }, 0, 0 };
    double n = ik_sqrt(a * a + b * b), miss = ik_abs(d) - n, x, y, c, s;
    if (!ik_finite(a) || !ik_finite(b)) return roots;
    if (n < IK_VANISHING) {
        roots.is_free = ik_abs(d) <= 1e-9 + slack;
        return roots;
    }
    if (!(miss <= 1e-9 + slack)) return roots;
    x = a / n;
    y = b / n;
    c = miss < 0.0 ? d / n : (d < 0.0 ? -1.0 : 1.0);
    s = ik_apart(ik_sqrt((1.0 - c) * (1.0 + c)), slack / n);
    ik_push(&roots, c * x - s * y, c * y + s * x);
    if (s > 0.0) ik_push(&roots, c * x + s * y, c * y - s * x);
    return roots;
}

/* == quadratic == */
/* The lengths with a t^2 + b t + c = 0. */
static ik_roots ik_quadratic(double a, double b, double c, double slack)
{
    ik_roots roots = { { { 0.0, 0.0 } }, 0, 0 };
    double half, product, discriminant, root, far;
    if (ik_abs(a) < IK_VANISHING) {
        if (ik_abs(b) >= IK_VANISHING) ik_push(&roots, -c / b, 0.0);
        else if (ik_abs(c) <= 1e-9 + slack) ik_push(&roots, 0.0, 0.0);
        return roots;
    }
    half = -0.5 * b / a;
    product = c / a;
    discriminant = half * half - product;
    if (!(discriminant >= -1e-9 - slack)) return roots;
    root = ik_sqrt(discriminant);
    far = half < 0.0 ? half - root : half + root;
    ik_push(&roots, far, 0.0);
    if (root > 0.0 && far < 0.0) ik_push(&roots, product / far, 0.0);
    else if (root > 0.0 && far > 0.0) ik_push(&roots, product / far, 0.0);
    return roots;
}

/* == conic == */
/* The real roots of t^3 + p t^2 + r t + u, the first repeated where there is only one. */
static void ik_cubic(double p, double r, double u, double out[3])
{
    double inflection = -p / 3.0, spread = ik_sqrt(p * p - 3.0 * r);
    double side = ((inflection + p) * inflection + r) * inflection + u > 0.0 ? -1.0 : 1.0;
    double t = inflection + side * (spread * 0.7 + 1e-9), b, c, half, discriminant, far;
    int i;
    /* Newton from outside of all roots: monotone. */
    while ((((t + p) * t + r) * t + u) * side < 0.0) t = inflection + 2.0 * (t - inflection);
    for (i = 0; i < 60; i++) {
        double slope = (3.0 * t + 2.0 * p) * t + r, next;
        if (!(slope < 0.0) && !(slope > 0.0)) break;
        next = t - (((t + p) * t + r) * t + u) / slope;
        if (!ik_finite(next) || ik_abs(next - t) <= 1e-16 * ik_abs(t)) break;
        t = next;
    }
    b = p + t;
    c = r + t * (p + t);
    half = -0.5 * b;
    discriminant = half * half - c;
    out[0] = out[1] = out[2] = t;
    if (discriminant < 0.0) {
        if (discriminant > -1e-12 * (half * half + ik_abs(c))) out[1] = out[2] = half;
        return;
    }
    far = half < 0.0 ? half - ik_sqrt(discriminant) : half + ik_sqrt(discriminant);
    out[1] = far;
    out[2] = far < 0.0 || far > 0.0 ? c / far : 0.0;
}

/* The two lines of a degenerate conic. */
static void ik_split(const double m[9], double out[2][3])
{
    double square[3][3], meeting[3] = { 0.0, 0.0, 0.0 }, lines[3][3], root;
    int i = 0, k, row = 0, column = 0;
    square[0][0] = m[5] * m[7] - m[4] * m[8];
    square[0][1] = m[1] * m[8] - m[2] * m[7];
    square[0][2] = m[2] * m[4] - m[1] * m[5];
    square[1][1] = m[2] * m[6] - m[0] * m[8];
    square[1][2] = m[0] * m[5] - m[2] * m[3];
    square[2][2] = m[1] * m[3] - m[0] * m[4];
    square[1][0] = square[0][1];
    square[2][0] = square[0][2];
    square[2][1] = square[1][2];
    for (k = 1; k < 3; k++) if (square[k][k] > square[i][i]) i = k;
    root = ik_sqrt(square[i][i]);
    if (root > 0.0) for (k = 0; k < 3; k++) meeting[k] = square[i][k] / root;
    lines[0][0] = m[0];
    lines[0][1] = m[1] - meeting[2];
    lines[0][2] = m[2] + meeting[1];
    lines[1][0] = m[3] + meeting[2];
    lines[1][1] = m[4];
    lines[1][2] = m[5] - meeting[0];
    lines[2][0] = m[6] - meeting[1];
    lines[2][1] = m[7] + meeting[0];
    lines[2][2] = m[8];
    for (i = 0; i < 3; i++)
        for (k = 0; k < 3; k++)
            if (ik_abs(lines[i][k]) > ik_abs(lines[row][column])) {
                row = i;
                column = k;
            }
    for (k = 0; k < 3; k++) {
        out[0][k] = lines[row][k];
        out[1][k] = lines[k][column];
    }
}

static double ik_conic_at(const double q[6], double c, double s)
{
    return (q[0] * c + q[1] * s + q[3]) * c + (q[2] * s + q[4]) * s + q[5];
}

/* The angles with q0 cos^2 + q1 cos sin + q2 sin^2 + q3 cos + q4 sin + q5 = 0: the pencil of the conic and the unit circle holds a
   pair of lines through their common points. Two Newton steps restore lost digits. */
static ik_roots ik_conic(double q0, double q1, double q2, double q3, double q4, double q5, double slack)
{
    ik_roots roots = { { { 0.0, 0.0 } }, 0, 0 };
    double q[6], size = 0.0, a, b, c, d, e, f, p, r, u, t[3], lines[2][3], lowest = 0.0;
    double best[9] = { 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0 };
    int i, k, line, none = 1;
    q[0] = q0;
    q[1] = q1;
    q[2] = q2;
    q[3] = q3;
    q[4] = q4;
    q[5] = q5;
    for (i = 0; i < 6; i++) {
        if (!ik_finite(q[i])) return roots;
        if (ik_abs(q[i]) > size) size = ik_abs(q[i]);
    }
    if (size < IK_VANISHING) {
        roots.is_free = 1;
        return roots;
    }
    for (i = 0; i < 6; i++) q[i] = q[i] / size;
    a = q[0];
    b = 0.5 * q[1];
    c = q[2];
    d = 0.5 * q[3];
    e = 0.5 * q[4];
    f = q[5];
    p = a + c - f;
    r = a * c - b * b - f * (a + c) + d * d + e * e;
    u = -(a * (c * f - e * e) - b * (b * f - e * d) + d * (b * e - c * d));
    ik_cubic(p, r, u, t);
    for (i = 0; i < 3; i++) {
        double m[9], product;
        m[0] = a + t[i];
        m[1] = m[3] = b;
        m[2] = m[6] = d;
        m[4] = c + t[i];
        m[5] = m[7] = e;
        m[8] = f - t[i];
        product = m[0] * m[4] - m[1] * m[1] + m[0] * m[8] - m[2] * m[2] + m[4] * m[8] - m[5] * m[5];
        if (none || product < lowest) {
            none = 0;
            lowest = product;
            for (k = 0; k < 9; k++) best[k] = m[k];
        }
    }
    ik_split(best, lines);
    for (line = 0; line < 2; line++) {
        const double *l = lines[line];
        double n = ik_sqrt(l[0] * l[0] + l[1] * l[1]);
        ik_roots met;
        if (n < IK_VANISHING) continue;
        met = ik_circle(l[0] / n, l[1] / n, -l[2] / n, slack > 1e-7 ? slack : 1e-7);
        for (i = 0; i < ik_count(&met); i++) {
            double at[2], error;
            ik_get(&met, i, at);
            error = ik_conic_at(q, at[0], at[1]);
            for (k = 0; k < 2; k++) {
                double cc = at[0], ss = at[1], next[2], next_error, norm, slope, step;
                slope = 2.0 * (q[2] - q[0]) * cc * ss + q[1] * (cc * cc - ss * ss) - q[3] * ss + q[4] * cc;
                step = -error / slope;
                if (!(ik_abs(step) < 1e-2)) break;
                next[0] = cc - ss * step;
                next[1] = ss + cc * step;
                norm = ik_sqrt(next[0] * next[0] + next[1] * next[1]);
                next[0] = next[0] / norm;
                next[1] = next[1] / norm;
                next_error = ik_conic_at(q, next[0], next[1]);
                if (ik_abs(next_error) >= ik_abs(error)) break;
                at[0] = next[0];
                at[1] = next[1];
                error = next_error;
            }
            ik_push(&roots, at[0], at[1]);
        }
    }
    return roots;
}

/* == chain == */
/* The product of two transforms; `out` may not be one of them. */
static void ik_times(const ik_frame *a, const ik_frame *b, ik_frame *out)
{
    int i, j;
    for (i = 0; i < 3; i++) {
        const double *row = a->rotation[i];
        for (j = 0; j < 3; j++)
            out->rotation[i][j] = row[0] * b->rotation[0][j] + row[1] * b->rotation[1][j] + row[2] * b->rotation[2][j];
        out->position[i] = a->position[i] + (row[0] * b->position[0] + row[1] * b->position[1] + row[2] * b->position[2]);
    }
}

/* A frame after its joint has moved by cosine and sine, or by a length. */
static void ik_move(ik_frame *frame, int slides, const double step[2])
{
    int i;
    for (i = 0; i < 3; i++) {
        double *row = frame->rotation[i], x = row[0], y = row[1];
        if (slides) {
            frame->position[i] += step[0] * row[2];
        } else {
            row[0] = step[0] * x + step[1] * y;
            row[1] = step[0] * y - step[1] * x;
        }
    }
}

/* Distance of two poses: the larger of metres and Frobenius norm of the rotation difference. */
static double ik_distance(const ik_frame *a, const ik_frame *b)
{
    double rotation = 0.0, position = 0.0, d;
    int i, j;
    for (i = 0; i < 3; i++) {
        for (j = 0; j < 3; j++) {
            d = a->rotation[i][j] - b->rotation[i][j];
            rotation += d * d;
        }
        d = a->position[i] - b->position[i];
        position += d * d;
    }
    return ik_sqrt(rotation > position ? rotation : position) + 0.0 * (rotation + position);
}

/* The tip at these values, and where each axis is: direction, then a point. */
static void ik_reach(const ik_chain *chain, const double *values, ik_frame *tip, double axes[][6])
{
    ik_frame at = { { { 1.0, 0.0, 0.0 }, { 0.0, 1.0, 0.0 }, { 0.0, 0.0, 1.0 } }, { 0.0, 0.0, 0.0 } }, next;
    int i, k;
    for (i = 0; i < IK_LINKS; i++) {
        const ik_link *link = &chain->links[i];
        double value = link->ratio * values[link->variable], step[2] = { 0.0, 0.0 };
        ik_times(&at, &link->previous_from_joint, &next);
        for (k = 0; k < 3; k++) {
            axes[i][k] = next.rotation[k][2];
            axes[i][3 + k] = next.position[k];
        }
        if (link->slides) step[0] = value;
        else ik_cos_sin(value, step);
        ik_move(&next, link->slides, step);
        at = next;
    }
    ik_times(&at, &chain->last_from_tip, tip);
}

/* Mirrors rows from to end of a column; weight is 2 over the square of the mirror's normal. */
static void ik_mirror_rows(const double *mirror, double weight, int from, int end, double *column)
{
    double sum = 0.0;
    int r;
    for (r = from; r < end; r++) sum += mirror[r] * column[r];
    for (r = from; r < end; r++) column[r] -= weight * sum * mirror[r];
}

/* The step x of the variables that makes |columns x - error|^2 + damping |x|^2 least; held ones stay. */
static void ik_damped(double columns[IK_VARIABLES][6], const double error[6], double damping, const int *held, double step[IK_VARIABLES])
{
    double m[IK_VARIABLES][6 + IK_VARIABLES] = { { 0.0 } }, right[6 + IK_VARIABLES] = { 0.0 }, diagonal[IK_VARIABLES];
    double mirror[6 + IK_VARIABLES];
    int i, k, r;
    for (r = 0; r < 6; r++) right[r] = error[r];
    for (i = 0; i < IK_VARIABLES; i++) {
        for (r = 0; r < 6; r++) m[i][r] = held[i] ? 0.0 : columns[i][r];
        m[i][6 + i] = held[i] ? 1.0 : ik_sqrt(damping);
    }
    for (k = 0; k < IK_VARIABLES; k++) {
        int end = 7 + k;
        double square = 0.0, length, weight;
        for (r = 0; r < end; r++) mirror[r] = m[k][r];
        for (r = k; r < end; r++) square += mirror[r] * mirror[r];
        length = mirror[k] < 0.0 ? -ik_sqrt(square) : ik_sqrt(square);
        diagonal[k] = -length;
        weight = 1.0 / (square + ik_abs(mirror[k]) * ik_abs(length));
        mirror[k] += length;
        for (i = k + 1; i < IK_VARIABLES; i++) ik_mirror_rows(mirror, weight, k, end, m[i]);
        ik_mirror_rows(mirror, weight, k, end, right);
    }
    for (i = IK_VARIABLES - 1; i >= 0; i--) {
        double sum = right[i];
        for (k = i + 1; k < IK_VARIABLES; k++) sum -= m[k][i] * step[k];
        step[i] = held[i] ? 0.0 : sum / diagonal[i];
    }
}

/* Distance to the pose, its six-vector (metres, radians), and the column of each variable. */
static double ik_linearise(const ik_chain *chain, const ik_frame *pose, const double *values, double error[6], double columns[IK_VARIABLES][6])
{
    double axes[IK_LINKS][6];
    ik_frame tip;
    int i, j, k;
    ik_reach(chain, values, &tip, axes);
    for (i = 0; i < 3; i++) {
        error[i] = pose->position[i] - tip.position[i];
        error[3 + i] = 0.0;
        for (k = 0; k < 3; k++) {
            int y = (i + 1) % 3, z = (i + 2) % 3;
            error[3 + i] += 0.5 * (tip.rotation[y][k] * pose->rotation[z][k] - tip.rotation[z][k] * pose->rotation[y][k]);
        }
    }
    for (j = 0; j < IK_VARIABLES; j++)
        for (i = 0; i < 6; i++) columns[j][i] = 0.0;
    for (j = 0; j < IK_LINKS; j++) {
        const ik_link *link = &chain->links[j];
        double *column = columns[link->variable], *z = axes[j], arm[3];
        for (i = 0; i < 3; i++) arm[i] = tip.position[i] - axes[j][3 + i];
        for (i = 0; i < 3; i++) {
            int y = (i + 1) % 3, x = (i + 2) % 3;
            column[i] += link->ratio * (link->slides ? z[i] : z[y] * arm[x] - z[x] * arm[y]);
            if (!link->slides) column[3 + i] += link->ratio * z[i];
        }
    }
    return ik_distance(&tip, pose);
}

/* Brings values onto the pose by Newton steps, but for those that are held; returns the smallest distance met. */
static double ik_polish(const ik_chain *chain, const ik_frame *pose, double values[IK_VARIABLES], const int *held)
{
    double at[IK_VARIABLES], best = HUGE_VAL, halved = HUGE_VAL;
    int round, i, since = 0, patience = 20;
    for (i = 0; i < IK_VARIABLES; i++) at[i] = values[i];
    for (round = 0; round < 50; round++) {
        double columns[IK_VARIABLES][6], error[6], step[IK_VARIABLES], longest = 0.0, scale;
        double distance = ik_linearise(chain, pose, at, error, columns);
        /* What starts near lacks digits alone. */
        if (round == 0 && distance < 1e-7) patience = 4;
        if (distance < best) {
            int converged = distance < 1e-13 && distance > 0.1 * best;
            best = distance;
            for (i = 0; i < IK_VARIABLES; i++) values[i] = at[i];
            if (best < 1e-14 || converged) break;
        } else if (best < 1e-13 || !ik_finite(distance)) {
            break;
        }
        since++;
        if (best <= 0.5 * halved) {
            halved = best;
            since = 0;
        } else if (since >= patience) {
            break;
        }
        ik_damped(columns, error, 1e-22 + 0.25 * distance * distance, held, step);
        for (i = 0; i < IK_VARIABLES; i++) if (ik_abs(step[i]) > longest) longest = ik_abs(step[i]);
        scale = longest > 0.3 ? 0.3 / longest : 1.0;
        for (i = 0; i < IK_VARIABLES; i++) at[i] += scale * step[i];
    }
    return best;
}

/* == candidate == */
/* Where candidates go. */
typedef struct {
    const ik_chain *chain;
    const ik_frame *pose;
    ik_solutions *out;
    int accepted;
    int misses;
    int doubt;
    int described;
} ik_sink;

/* Turns a candidate into values that reach the pose on the chain; says whether they do. */
static int ik_settle(const ik_sink *sink, double steps[IK_VARIABLES][2], double values[IK_VARIABLES])
{
    double axes[IK_LINKS][6], distance;
    ik_frame tip;
    int i;
    for (i = 0; i < IK_VARIABLES; i++) {
        if (!ik_finite(steps[i][0]) || !ik_finite(steps[i][1])) return 0;
        if (!ik_held[i]) values[i] = ik_slides[i] ? steps[i][0] : ik_angle_of(steps[i][1], steps[i][0]);
    }
    ik_reach(sink->chain, values, &tip, axes);
    distance = ik_distance(&tip, sink->pose);
    if (!ik_finite(distance)) return 0;
    if (distance <= 1e-13) return 1;
    if (!(ik_polish(sink->chain, sink->pose, values, ik_held) < 1e-9)) return 0;
    for (i = 0; i < IK_VARIABLES; i++) {
        if (!ik_round[i] || ik_held[i]) continue;
        while (values[i] > 3.141592653589793) values[i] -= 6.283185307179586;
        while (values[i] <= -3.141592653589793) values[i] += 6.283185307179586;
    }
    return 1;
}

/* Keeps a candidate if it is right and new: the step of each variable, its value, and the squares of how far the described chain is
   from the pose, rotation and position. */
static void ik_offer(ik_sink *sink, double steps[IK_VARIABLES][2], double values[IK_VARIABLES], const double misses[2])
{
    int i, k, exact = sink->described && misses[0] <= 1e-13 * 1e-13 && misses[1] <= 1e-13 * 1e-13;
    if (sink->misses >= 256) return;
    if (!exact && !ik_settle(sink, steps, values)) {
        sink->misses++;
        return;
    }
    for (i = IK_JOINTS; i < IK_VARIABLES; i++) if (values[i] < ik_least[i - IK_JOINTS] - 1e-9) return;
    sink->accepted++;
    for (k = 0; k < sink->out->count; k++) {
        const double *other = sink->out->values[k];
        for (i = 0; i < IK_JOINTS; i++) {
            double gap = ik_abs(values[i] - other[i]);
            if (gap >= 1e-7 && (!ik_round[i] || ik_abs(gap - 6.283185307179586) >= 1e-7)) break;
        }
        if (i == IK_JOINTS) return;
    }
    if (sink->out->count < IK_CAPACITY) {
        for (i = 0; i < IK_JOINTS; i++) sink->out->values[sink->out->count][i] = values[i];
        sink->out->count++;
    }
}

/* == family == */
/* The values after a step along a direction. */
static void ik_along(const double *values, const double *direction, double t, double out[IK_VARIABLES])
{
    int i;
    for (i = 0; i < IK_VARIABLES; i++) out[i] = values[i] + t * direction[i];
}

/* Follows a curve until the leading joint has moved by t; returns how far it came in steps of `least` or more. */
static double ik_follow(const ik_chain *chain, const ik_frame *pose, const ik_family *family, double values[IK_VARIABLES], double t, double least)
{
    double last[IK_VARIABLES], wanted[IK_VARIABLES], next[IK_VARIABLES];
    double gone = 0.0, step = 0.05, sign = t < 0.0 ? -1.0 : 1.0, rest, by;
    int held[IK_VARIABLES], i, near;
    for (i = 0; i < IK_VARIABLES; i++) {
        last[i] = family->direction[i];
        held[i] = ik_held[i] || i == family->leader;
    }
    while (gone < ik_abs(t) && step >= least) {
        rest = ik_abs(t) - gone;
        by = sign * (step < rest ? step : rest);
        ik_along(values, last, by, wanted);
        for (i = 0; i < IK_VARIABLES; i++) next[i] = wanted[i];
        near = ik_polish(chain, pose, next, held) < 1e-9;
        for (i = 0; i < IK_VARIABLES; i++) near = near && ik_abs(next[i] - wanted[i]) < 0.2;
        if (near) {
            for (i = 0; i < IK_VARIABLES; i++) {
                last[i] = (next[i] - values[i]) / by;
                values[i] = next[i];
            }
            gone = step < rest ? gone + step : ik_abs(t);
        } else {
            step *= 0.5;
        }
    }
    return sign * gone;
}

/* A basis of the directions in which joints move and the tip does not, each with its leading joint (1 there, 0 in the others);
   returns their number. */
static int ik_still(const ik_chain *chain, const ik_frame *pose, const double *values, double found[IK_VARIABLES][IK_VARIABLES], int leaders[IK_VARIABLES])
{
    double columns[IK_VARIABLES][6], error[6], swap;
    int joints[IK_VARIABLES], n = 0, rank = 0, count, i, k, c, r;
    ik_linearise(chain, pose, values, error, columns);
    for (i = 0; i < IK_VARIABLES; i++) {
        if (ik_held[i]) continue;
        for (r = 0; r < 6; r++) columns[n][r] = columns[i][r];
        joints[n++] = i;
    }
    /* Elimination with the largest entry of what is left as pivot. */
    while (rank < n && rank < 6) {
        int column = rank, row = rank, joint;
        for (c = rank; c < n; c++)
            for (r = rank; r < 6; r++)
                if (ik_abs(columns[c][r]) > ik_abs(columns[column][row])) {
                    column = c;
                    row = r;
                }
        if (ik_abs(columns[column][row]) < 1e-6) break;
        for (r = 0; r < 6; r++) {
            swap = columns[rank][r];
            columns[rank][r] = columns[column][r];
            columns[column][r] = swap;
        }
        joint = joints[rank];
        joints[rank] = joints[column];
        joints[column] = joint;
        for (c = 0; c < n; c++) {
            swap = columns[c][rank];
            columns[c][rank] = columns[c][row];
            columns[c][row] = swap;
        }
        for (r = rank + 1; r < 6; r++) {
            double factor = columns[rank][r] / columns[rank][rank];
            for (c = rank; c < n; c++) columns[c][r] -= factor * columns[c][rank];
        }
        rank++;
    }
    count = n - rank;
    for (k = 0; k < count; k++) {
        double x[IK_VARIABLES];
        for (c = 0; c < IK_VARIABLES; c++) x[c] = found[k][c] = 0.0;
        x[rank + k] = 1.0;
        for (r = rank - 1; r >= 0; r--) {
            double sum = 0.0;
            for (c = r + 1; c < n; c++) sum += columns[c][r] * x[c];
            x[r] = -sum / columns[r][r];
        }
        for (c = 0; c < n; c++) found[k][joints[c]] = x[c];
    }
    for (k = 0; k < count; k++) {
        /* The largest entry leads, of equal ones the last: dividing by it loses nothing. */
        double row[IK_VARIABLES], largest;
        int leader = 0, other;
        for (i = 0; i < IK_VARIABLES; i++) if (ik_abs(found[k][i]) >= ik_abs(found[k][leader]) * (1.0 - 1e-6)) leader = i;
        largest = found[k][leader];
        for (i = 0; i < IK_VARIABLES; i++) row[i] = found[k][i] / largest;
        for (other = 0; other < count; other++) {
            double factor = found[other][leader];
            for (i = 0; i < IK_VARIABLES; i++) found[other][i] -= factor * row[i];
        }
        for (i = 0; i < IK_VARIABLES; i++) found[k][i] = row[i];
        leaders[k] = leader;
    }
    for (k = 0; k < count; k++)
        for (i = 0; i < IK_VARIABLES; i++) {
            double x = found[k][i], whole = ik_abs(x) < 0.5 ? 0.0 : (x < 0.0 ? -1.0 : 1.0);
            if (ik_abs(x - whole) < 1e-7) found[k][i] = whole;
        }
    return count;
}

/* The families through a solution; returns their number. */
static int ik_families_of(const ik_chain *chain, const ik_frame *pose, const double *solution, ik_family out[IK_VARIABLES])
{
    static const double places[5] = { 0.05, -0.4, 1.1, -2.0, 2.9 };
    double still[IK_VARIABLES][IK_VARIABLES], at[IK_VARIABLES], axes[IK_LINKS][6];
    int leaders[IK_VARIABLES], count = ik_still(chain, pose, solution, still, leaders), found = 0, k, i;
    ik_frame tip;
    for (k = 0; k < count; k++) {
        ik_family family;
        family.leader = leaders[k];
        family.is_line = 1;
        family.interval[0] = -3.141592653589793;
        family.interval[1] = 3.141592653589793;
        for (i = 0; i < IK_VARIABLES; i++) {
            family.direction[i] = still[k][i];
            if (ik_slides[i] && (still[k][i] < 0.0 || still[k][i] > 0.0)) family.is_line = 0;
        }
        for (i = 0; i < 5; i++) {
            ik_along(solution, still[k], places[i], at);
            ik_reach(chain, at, &tip, axes);
            if (!(ik_distance(&tip, pose) < 1e-9)) family.is_line = 0;
        }
        for (i = 0; i < 2 && !family.is_line; i++) {
            ik_along(solution, still[k], 0.0, at);
            family.interval[i] = ik_follow(chain, pose, &family, at, family.interval[i], 1e-3);
        }
        if (family.is_line || family.interval[1] - family.interval[0] > 0.05) out[found++] = family;
    }
    return found;
}

/* Brings values from the solution to the member at t; says whether there is one. */
static int ik_member_of(const ik_chain *chain, const ik_frame *pose, const ik_family *family, double values[IK_VARIABLES], double t)
{
    const double low = family->interval[0], high = family->interval[1];
    /* Rounding at an end is not outside. */
    if (!(low - 1e-9 <= t && t <= high + 1e-9)) return 0;
    if (t < low) t = low;
    if (t > high) t = high;
    if (family->is_line) {
        ik_along(values, family->direction, t, values);
        return 1;
    }
    return !(ik_abs(ik_follow(chain, pose, family, values, t, 0.5e-3)) < ik_abs(t));
}
