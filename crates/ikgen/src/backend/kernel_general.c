/* == eigen == */
/* Largest matrix. */
#define IK_SIZE 16

/* Eigenvalues of { { a, b }, { c, d } }, each real and imaginary part. */
static void ik_two_by_two(double a, double b, double c, double d, double out[2][2])
{
    double half = 0.5 * (a - d), middle = 0.5 * (a + d), square = half * half + b * c, far;
    if (square < 0.0) {
        out[0][0] = out[1][0] = middle;
        out[0][1] = ik_sqrt(-square);
        out[1][1] = -out[0][1];
        return;
    }
    far = half < 0.0 ? half - ik_sqrt(square) : half + ik_sqrt(square);
    out[0][0] = d + far;
    out[1][0] = far < 0.0 || far > 0.0 ? d - b * c / far : d;
    out[0][1] = out[1][1] = 0.0;
}

/* Reflects `n` rows and columns (two or three) from `k` on so that the vector comes to lie along the first of them; the columns from
   `first` to `size`, the rows from `start` to `end`. */
static void ik_reflect(double h[][IK_SIZE], int k, int n, const double vector[3], int first, int size, int start, int end)
{
    double x = vector[0], y = vector[1], z = n > 2 ? vector[2] : 0.0, norm = ik_sqrt(x * x + y * y + z * z);
    double v, w, beta, sum;
    int i;
    if (!(norm > 0.0)) return;
    if (x < 0.0) norm = -norm;
    v = y / (x + norm);
    w = z / (x + norm);
    beta = (x + norm) / norm;
    for (i = first; i < size; i++) {
        sum = h[k][i] + v * h[k + 1][i];
        if (n > 2) sum += w * h[k + 2][i];
        h[k][i] -= beta * sum;
        h[k + 1][i] -= beta * v * sum;
        if (n > 2) h[k + 2][i] -= beta * w * sum;
    }
    for (i = start; i < end; i++) {
        double *row = &h[i][k];
        sum = row[0] + v * row[1];
        if (n > 2) sum += w * row[2];
        row[0] -= beta * sum;
        row[1] -= beta * v * sum;
        if (n > 2) row[2] -= beta * w * sum;
    }
}

/* One implicit step on the rows from `start` to `size`, with the eigenvalues of the trailing two by two block as shifts; after some
   sweeps only the one nearer to the corner, twice, if they are real. */
static void ik_double_step(double h[][IK_SIZE], int start, int size, int sweep)
{
    int k = size - 2, l = size - 1, j = start + 1;
    double trace = h[k][k] + h[l][l], determinant = h[k][k] * h[l][l] - h[k][l] * h[l][k], vector[3];
    if (sweep % 10 == 0) {
        /* Breaks the rare cycles. */
        double s = ik_abs(h[l][k]) + ik_abs(h[k][k - 1]);
        trace = 1.5 * s;
        determinant = s * s;
    } else if (sweep > 8) {
        double values[2][2];
        ik_two_by_two(h[k][k], h[k][l], h[l][k], h[l][l], values);
        if (!(ik_abs(values[0][1]) > 0.0)) {
            double shift = values[ik_abs(values[0][0] - h[l][l]) < ik_abs(values[1][0] - h[l][l]) ? 0 : 1][0];
            trace = 2.0 * shift;
            determinant = shift * shift;
        }
    }
    /* The first column of (H - s1) (H - s2). */
    vector[0] = h[start][start] * (h[start][start] - trace) + determinant + h[start][j] * h[j][start];
    vector[1] = h[j][start] * (h[start][start] + h[j][j] - trace);
    vector[2] = h[j][start] * h[start + 2][j];
    for (k = start; k < size - 2; k++) {
        ik_reflect(h, k, 3, vector, k > start ? k - 1 : k, size, start, k + 4 < size ? k + 4 : size);
        if (k > start) h[k + 1][k - 1] = h[k + 2][k - 1] = 0.0;
        vector[0] = h[k + 1][k];
        vector[1] = h[k + 2][k];
        vector[2] = k + 3 < size ? h[k + 3][k] : 0.0;
    }
    ik_reflect(h, size - 2, 2, vector, size - 3, size, start, size);
    h[size - 1][size - 3] = 0.0;
}

/* Eigenvalues, real and imaginary part, of the leading n by n part of an upper Hessenberg matrix, which is destroyed; returns how many
   were found. Francis's double-shift QR iteration (Golub and Van Loan, Matrix Computations, section 7.5). */
static int ik_eigenvalues(double h[][IK_SIZE], int n, double found[][2])
{
    int count = 0, size = n, sweeps = 0, start, i, j;
    double norm = 0.0, least;
    for (i = 0; i < n; i++)
        for (j = 0; j < n; j++)
            if (ik_abs(h[i][j]) > norm) norm = ik_abs(h[i][j]);
    least = 0.01 * norm;
    while (size > 0) {
        /* The trailing block that no negligible subdiagonal entry cuts. */
        double negligible = 2.220446049250313e-16 * (double)(1 << (sweeps / 4));
        for (start = size - 1; start > 0; start--) {
            double scale = ik_abs(h[start - 1][start - 1]) + ik_abs(h[start][start]);
            if (!(scale > least)) scale = least;
            if (ik_abs(h[start][start - 1]) <= negligible * scale) {
                h[start][start - 1] = 0.0;
                break;
            }
        }
        if (start + 1 == size) {
            found[count][0] = h[start][start];
            found[count][1] = 0.0;
            count += 1;
        } else if (start + 2 == size) {
            ik_two_by_two(h[start][start], h[start][start + 1], h[start + 1][start], h[start + 1][start + 1], &found[count]);
            count += 2;
        } else {
            sweeps++;
            if (sweeps > 60) break;
            ik_double_step(h, start, size, sweeps);
            continue;
        }
        size = start;
        sweeps = 0;
    }
    return count;
}

/* == waves == */
/* Highest multiple of the angle, and the number of samples that determine such a polynomial. */
#define IK_DEGREE (IK_SIZE / 2)
#define IK_SAMPLES (2 * IK_DEGREE + 1)

/* A trigonometric polynomial by its waves: d[0] + 2 sum Re(d[k] e^(i k q)). */
typedef struct {
    double d[IK_DEGREE + 1][2];
    int degree;
    /* Largest sample in magnitude; `start` is half a turn before it. */
    double largest;
    double start;
} ik_waves;

/* Real part of an angle, and its imaginary part to first order. */
typedef struct {
    double angle;
    double imaginary;
} ik_root;

/* Coefficients of the powers of t = tan((angle - start) / 2) in the polynomial times (1 + t^2)^degree. With u = 1 + i t and its
   conjugate v that is a sum of u^j v^(2 degree - j), by Horner's scheme. */
static void ik_powers(const ik_waves *waves, double powers[IK_SIZE + 1])
{
    double sum[IK_SIZE + 1][2] = { { 0.0 } }, conjugate[IK_SIZE + 1][2] = { { 0.0 } };
    int n = waves->degree, m, i;
    conjugate[0][0] = 1.0;
    for (m = 0; m <= 2 * n; m++) {
        int k = m < n ? n - m : m - n;
        double turn[2], x, y;
        ik_cos_sin((double)k * waves->start, turn);
        x = waves->d[k][0] * turn[0] - waves->d[k][1] * turn[1];
        y = waves->d[k][0] * turn[1] + waves->d[k][1] * turn[0];
        /* From the highest wave down; those of negative number are conjugates. */
        if (m > n) y = -y;
        for (i = m; i >= 0; i--) {
            double below[2] = { 0.0, 0.0 }, a = conjugate[i][0], b = conjugate[i][1];
            if (i > 0) {
                below[0] = -sum[i - 1][1];
                below[1] = sum[i - 1][0];
            }
            /* The sum times u, and the wave times the power of v. */
            if (m > 0) {
                sum[i][0] = sum[i][0] + below[0];
                sum[i][1] = sum[i][1] + below[1];
            }
            sum[i][0] = sum[i][0] + x * a - y * b;
            sum[i][1] = sum[i][1] + x * b + y * a;
        }
        for (i = IK_SIZE; i > 0; i--) {
            conjugate[i][0] = conjugate[i][0] + conjugate[i - 1][1];
            conjugate[i][1] = conjugate[i][1] - conjugate[i - 1][0];
        }
    }
    for (i = 0; i <= IK_SIZE; i++) powers[i] = sum[i][0];
}

/* The polynomial of half the degree whose square this one is, but for its sign. */
static void ik_square_root(double powers[IK_SIZE + 1], int degree)
{
    double root[IK_SIZE + 1] = { 0.0 }, sign = powers[degree] < 0.0 ? -1.0 : 1.0, rest;
    int half = degree / 2, k, i;
    root[half] = ik_sqrt(ik_abs(powers[degree]));
    for (k = half - 1; k >= 0; k--) {
        rest = sign * powers[half + k];
        for (i = k + 1; i < half; i++) rest -= root[i] * root[half + k - i];
        root[k] = 0.5 * rest / root[half];
    }
    for (i = 0; i <= IK_SIZE; i++) powers[i] = root[i];
}

/* All roots; returns how many were found. Half a turn is moved to where the polynomial is largest, so that no root is at infinity in t;
   the powers of t are scaled by square roots of binomial coefficients, which balances the companion matrix. With `squared` the
   polynomial is known to be a square, and the roots are those of its root. */
static int ik_roots_of_waves(const ik_waves *waves, int squared, ik_root *found)
{
    double powers[IK_SIZE + 1], weight[IK_SIZE + 1], companion[IK_SIZE][IK_SIZE] = { { 0.0 } }, values[IK_SIZE][2];
    int size = 2 * waves->degree, count, k;
    ik_powers(waves, powers);
    if (squared) {
        ik_square_root(powers, size);
        size /= 2;
    }
    if (!(ik_abs(powers[size]) > 0.0 && ik_finite(powers[size]))) return 0;
    weight[0] = 1.0;
    for (k = 1; k <= size; k++) weight[k] = weight[k - 1] * ik_sqrt((double)(size + 1 - k) / (double)k);
    for (k = 0; k < size; k++) companion[k][size - 1] = -weight[size - 1] * powers[k] / (weight[k] * powers[size]);
    for (k = 1; k < size; k++) companion[k][k - 1] += weight[k - 1] / weight[k];
    count = ik_eigenvalues(companion, size, values);
    for (k = 0; k < count; k++) {
        double x = values[k][0], y = values[k][1], a = 1.0 - y, b = 1.0 + y;
        double m = ik_sqrt(x * x + a * a), n = ik_sqrt(x * x + b * b);
        found[k].angle = waves->start + (ik_angle_of(x / m, a / m) + ik_angle_of(x / n, b / n));
        found[k].imaginary = 2.0 * y / (1.0 + x * x);
    }
    return count;
}

/* == bends == */
/* Value and the first two derivatives at a turn. */
static void ik_bends(const ik_waves *waves, const double turn[2], double out[3])
{
    double x = 1.0, y = 0.0, along, across, next;
    int k;
    out[0] = waves->d[0][0];
    out[1] = out[2] = 0.0;
    for (k = 1; k <= waves->degree; k++) {
        next = x * turn[0] - y * turn[1];
        y = x * turn[1] + y * turn[0];
        x = next;
        along = 2.0 * (waves->d[k][0] * x - waves->d[k][1] * y);
        across = 2.0 * (waves->d[k][0] * y + waves->d[k][1] * x);
        out[0] += along;
        out[1] -= (double)k * across;
        out[2] -= (double)k * (double)k * along;
    }
}

/* == octic == */
/* The root near an angle, or the extremum where two roots fall together, as cosine and sine; returns the value there. Newton steps. */
static double ik_improved(const ik_waves *waves, double angle, int twice, double turn[2])
{
    double bends[3], step, x, y, n;
    int i;
    ik_cos_sin(angle, turn);
    ik_bends(waves, turn, bends);
    for (i = 0; i < (twice ? 4 : 2); i++) {
        step = twice ? -bends[1] / bends[2] : -bends[0] / bends[1];
        if (!(ik_abs(step) < 2e-2)) break;
        x = turn[0] - turn[1] * step;
        y = turn[1] + turn[0] * step;
        n = ik_sqrt(x * x + y * y);
        turn[0] = x / n;
        turn[1] = y / n;
        ik_bends(waves, turn, bends);
        if (ik_abs(step) < 1e-9) break;
    }
    return bends[0];
}

/* The angles with a[0] + a[1] cos q + a[2] sin q + a[3] cos 2q + ... + a[8] sin 4q = 0: eigenvalues of a companion matrix, improved by
   Newton steps. A pair of roots that rounding has split, or has moved off the real line, is where the sum has its extremum between
   them. With slack so are pairs that are farther off the real line. */
static ik_roots ik_octic(const double a[9], double slack)
{
    static const double side = 0.7071067811865476;
    const double eighths[8][2] = {
        { 1.0, 0.0 }, { side, side }, { 0.0, 1.0 }, { -side, side }, { -1.0, 0.0 }, { -side, -side }, { 0.0, -1.0 }, { side, -side }
    };
    ik_roots roots = { { { 0.0, 0.0 } }, 0, 0 };
    ik_waves waves = { { { 0.0 } }, 4, 0.0, 0.0 };
    ik_root found[IK_SIZE];
    int done[IK_SIZE] = { 0 }, count, i, j;
    double size = 0.0, bends[3], turn[2], most, value;
    for (i = 0; i < 9; i++) {
        if (!ik_finite(a[i])) return roots;
        if (ik_abs(a[i]) > size) size = ik_abs(a[i]);
    }
    if (size < IK_VANISHING) {
        roots.is_free = 1;
        return roots;
    }
    waves.d[0][0] = a[0] / size;
    for (i = 1; i < 5; i++) {
        waves.d[i][0] = 0.5 * (a[2 * i - 1] / size);
        waves.d[i][1] = -0.5 * (a[2 * i] / size);
    }
    for (i = 0; i < 8; i++) {
        ik_bends(&waves, eighths[i], bends);
        if (ik_abs(bends[0]) > waves.largest) {
            waves.largest = ik_abs(bends[0]);
            waves.start = (i - 4.0) * 0.7853981633974483;
        }
    }
    count = ik_roots_of_waves(&waves, 0, found);
    most = 5.0 * ik_sqrt(slack);
    if (most < 1e-2) most = 1e-2;
    for (i = 0; i < count; i++) {
        /* Of conjugate roots one is enough. */
        if (done[i] || found[i].imaginary < 0.0 || found[i].imaginary > most) continue;
        if (found[i].imaginary > 0.0) {
            value = ik_improved(&waves, found[i].angle, 1, turn);
            if (ik_abs(value) < 2e-14 || slack > 0.0) ik_push(&roots, turn[0], turn[1]);
            continue;
        }
        for (j = i + 1; j < count; j++) {
            /* Sine of half of the gap, of whichever half is within a quarter turn. */
            double half[2], gap;
            ik_cos_sin(0.5 * (found[j].angle - found[i].angle), half);
            gap = half[0] < 0.0 ? -half[1] : half[1];
            if (!done[j] && !(ik_abs(found[j].imaginary) > 0.0) && ik_abs(gap) < 5e-3) {
                value = ik_improved(&waves, found[i].angle + gap, 1, turn);
                if (ik_abs(value) < 2e-14) {
                    done[j] = 1;
                    break;
                }
            }
        }
        if (j == count) ik_improved(&waves, found[i].angle, 0, turn);
        ik_push(&roots, turn[0], turn[1]);
    }
    return roots;
}

/* == vector == */
typedef struct { double x[3]; } ik_vector;

/* Cosine and sine. */
typedef struct { double c, s; } ik_turn;

/* A line about which things turn: unit direction, and a point on it. */
typedef struct { ik_vector direction, point; } ik_line;

/* A rigid motion: rows of its rotation, and where it takes the origin. */
typedef struct { ik_vector rows[3], place; } ik_motion;

static ik_vector ik_vector_of(double x, double y, double z)
{
    ik_vector v;
    v.x[0] = x;
    v.x[1] = y;
    v.x[2] = z;
    return v;
}

static ik_turn ik_turn_of(double c, double s)
{
    ik_turn turn;
    turn.c = c;
    turn.s = s;
    return turn;
}

static double ik_dot(ik_vector a, ik_vector b) { return a.x[0] * b.x[0] + a.x[1] * b.x[1] + a.x[2] * b.x[2]; }

static ik_vector ik_cross(ik_vector a, ik_vector b)
{
    return ik_vector_of(a.x[1] * b.x[2] - a.x[2] * b.x[1], a.x[2] * b.x[0] - a.x[0] * b.x[2], a.x[0] * b.x[1] - a.x[1] * b.x[0]);
}

static ik_vector ik_plus(ik_vector a, ik_vector b) { return ik_vector_of(a.x[0] + b.x[0], a.x[1] + b.x[1], a.x[2] + b.x[2]); }

static ik_vector ik_minus(ik_vector a, ik_vector b) { return ik_vector_of(a.x[0] - b.x[0], a.x[1] - b.x[1], a.x[2] - b.x[2]); }

static ik_vector ik_scaled(ik_vector a, double x) { return ik_vector_of(a.x[0] * x, a.x[1] * x, a.x[2] * x); }

/* (x, y) at length one; says whether it has a direction. */
static int ik_unit(double x, double y, ik_turn *out)
{
    double n = ik_sqrt(x * x + y * y);
    if (!(n > 0.0) || !ik_finite(n)) return 0;
    *out = ik_turn_of(x / n, y / n);
    return 1;
}

/* Both turns, one after the other. */
static ik_turn ik_sum(ik_turn a, ik_turn b) { return ik_turn_of(a.c * b.c - a.s * b.s, a.s * b.c + a.c * b.s); }

static ik_turn ik_back(ik_turn turn) { return ik_turn_of(turn.c, -turn.s); }

static ik_turn ik_turn_by(double angle)
{
    double turn[2];
    ik_cos_sin(angle, turn);
    return ik_turn_of(turn[0], turn[1]);
}

/* A vector turned about a line. */
static ik_vector ik_turned(const ik_line *line, ik_vector v, ik_turn turn)
{
    ik_vector along = ik_scaled(line->direction, ik_dot(line->direction, v)), across = ik_cross(line->direction, v);
    return ik_plus(along, ik_plus(ik_scaled(ik_minus(v, along), turn.c), ik_scaled(across, turn.s)));
}

/* A line turned about another. */
static ik_line ik_line_turned(const ik_line *line, const ik_line *other, ik_turn turn)
{
    ik_line out;
    out.direction = ik_turned(line, other->direction, turn);
    out.point = ik_plus(line->point, ik_turned(line, ik_minus(other->point, line->point), turn));
    return out;
}

/* A vector, and a line, after a motion. */
static ik_vector ik_vector_moved(const ik_motion *motion, ik_vector v)
{
    return ik_vector_of(ik_dot(motion->rows[0], v), ik_dot(motion->rows[1], v), ik_dot(motion->rows[2], v));
}

static ik_line ik_line_moved(const ik_motion *motion, const ik_line *line)
{
    ik_line out;
    out.direction = ik_vector_moved(motion, line->direction);
    out.point = ik_plus(ik_vector_moved(motion, line->point), motion->place);
    return out;
}

static ik_motion ik_inverse(const ik_motion *motion)
{
    ik_motion out;
    int i;
    for (i = 0; i < 3; i++) out.rows[i] = ik_vector_of(motion->rows[0].x[i], motion->rows[1].x[i], motion->rows[2].x[i]);
    out.place = ik_scaled(ik_vector_moved(&out, motion->place), -1.0);
    return out;
}

/* == elimination == */
/* Six equations, each with a coefficient for each product of one of 1, c, s of the sampled angle q3, one of t^2, t, 1 of the half
   tangent t of a second one, and one of 1, c, s of the third. */
typedef struct { double rows[6][27]; } ik_six_rows;

/* The angle that is eliminated by its half tangent is counted from here: far from the multiples of 90 degrees. */
static ik_turn ik_start(void) { return ik_turn_of(0.8, 0.6); }

/* The turn that belongs to a half tangent, given as a vector along half of the turn. */
static ik_turn ik_turn_of_half(ik_turn half) { return ik_sum(ik_sum(half, half), ik_start()); }

/* From values at the turns (1, 0), (0, 1), (-1, 0) to the coefficients of 1, c, s, for the index of this stride. */
static void ik_fit(double *values, int count, int stride)
{
    int outer, base;
    for (outer = 0; outer < count; outer += 3 * stride)
        for (base = outer; base < outer + stride; base++) {
            double a = values[base], b = values[base + stride], still = 0.5 * (a + values[base + 2 * stride]);
            values[base] = still;
            values[base + stride] = a - still;
            values[base + 2 * stride] = b - still;
        }
}

/* The fourteen functions of a line on which the elimination rests: with p a point on it and l its direction, p, l, p.p, p.l, p x l
   and (p.p) l - 2 (p.l) p. */
static void ik_functions(const ik_line *line, ik_vector origin, double scale, double out[14])
{
    ik_vector p = ik_scaled(ik_minus(line->point, origin), scale), l = line->direction, m = ik_cross(p, l), w;
    double pp = ik_dot(p, p), pl = ik_dot(p, l);
    int i;
    w = ik_minus(ik_scaled(l, pp), ik_scaled(p, 2.0 * pl));
    for (i = 0; i < 3; i++) {
        out[i] = p.x[i];
        out[3 + i] = l.x[i];
        out[8 + i] = m.x[i];
        out[11 + i] = w.x[i];
    }
    out[6] = pp;
    out[7] = pl;
}

/* Takes all columns of `right` but the first to its first eight rows, by reflections of both sides; returns the square of the volume that
   they span. The left side has rows of this width. */
static double ik_clear_right(double *left, int width, double right[14][9])
{
    double volume = 1.0;
    int done[9] = { 1 }, step, pivot, r, c;
    for (step = 0; step < 8; step++) {
        double squares[9] = { 0.0 }, mirror[14] = { 0.0 }, of_left[27] = { 0.0 }, of_right[9] = { 0.0 }, most = -1.0, head, factor, by;
        for (r = step; r < 14; r++)
            for (c = 0; c < 9; c++) squares[c] += right[r][c] * right[r][c];
        for (pivot = 0, c = 1; c < 9; c++)
            if (!done[c] && squares[c] > most) {
                pivot = c;
                most = squares[c];
            }
        done[pivot] = 1;
        if (most < 1e-24) break;
        volume *= most;
        for (r = step; r < 14; r++) mirror[r] = right[r][pivot];
        head = mirror[step];
        mirror[step] += head < 0.0 ? -ik_sqrt(most) : ik_sqrt(most);
        factor = 1.0 / (most + ik_abs(head) * ik_sqrt(most));
        for (r = step; r < 14; r++) {
            for (c = 0; c < width; c++) of_left[c] += mirror[r] * left[width * r + c];
            for (c = 0; c < 9; c++) of_right[c] += mirror[r] * right[r][c];
        }
        for (r = step; r < 14; r++) {
            by = factor * mirror[r];
            for (c = 0; c < width; c++) left[width * r + c] -= by * of_left[c];
            for (c = 0; c < 9; c++) right[r][c] -= by * of_right[c];
        }
    }
    return volume;
}

/* The turns at which sides are sampled, and the same for the angle that is eliminated by its half tangent. */
static void ik_places(ik_turn plain[3], ik_turn shifted[3])
{
    int i;
    plain[0] = ik_turn_of(1.0, 0.0);
    plain[1] = ik_turn_of(0.0, 1.0);
    plain[2] = ik_turn_of(-1.0, 0.0);
    for (i = 0; i < 3; i++) shifted[i] = ik_sum(plain[i], ik_start());
}

/* The unit of length in which lines are measured from a point. */
static double ik_scale_of(const ik_line *lines, int count, ik_vector origin)
{
    double size = 0.0;
    int i;
    for (i = 0; i < count; i++) {
        ik_vector d = ik_minus(lines[i].point, origin);
        if (ik_dot(d, d) > size) size = ik_dot(d, d);
    }
    return 1.0 / ik_sqrt(size);
}

/* The right side of the fourteen equations: coefficients of the products of 1, c, s of q1 and q2. */
static void ik_right_side(const ik_line lines[6], const ik_motion *goal, ik_vector origin, double scale, double right[14][9])
{
    double values[14];
    ik_turn plain[3], shifted[3];
    ik_line last = ik_line_moved(goal, &lines[5]);
    int i, j, row;
    ik_places(plain, shifted);
    for (i = 0; i < 3; i++) {
        ik_line before1 = ik_line_turned(&lines[0], &last, ik_back(plain[i]));
        for (j = 0; j < 3; j++) {
            ik_line before2 = ik_line_turned(&lines[1], &before1, ik_back(plain[j]));
            ik_functions(&before2, origin, scale, values);
            for (row = 0; row < 14; row++) right[row][3 * i + j] = values[row];
        }
    }
    for (row = 0; row < 14; row++) {
        ik_fit(right[row], 9, 1);
        ik_fit(right[row], 9, 3);
    }
}

/* From the coefficients of 1, c, s to those of t^2, t, 1, three of each. */
static void ik_by_half_tangent(const double from[9], double to[9])
{
    int k;
    for (k = 0; k < 3; k++) {
        /* (1 + t^2) (one + cos c + sin s) */
        to[k] = from[k] - from[3 + k];
        to[3 + k] = 2.0 * from[6 + k];
        to[6 + k] = from[k] + from[3 + k];
    }
}

/* The six equations at one value of q3: three forms in 1, c, s of the third angle, with t^2, t and 1. */
static void ik_rows_at(const ik_six_rows *six, ik_turn turn, double rows[54])
{
    int r, n;
    for (r = 0; r < 6; r++)
        for (n = 0; n < 9; n++) rows[9 * r + n] = six->rows[r][n] + turn.c * six->rows[r][9 + n] + turn.s * six->rows[r][18 + n];
}

/* Clears the first columns of six rows of this width below the diagonal, with row exchanges; returns the product of the pivots, and
   multiplies `sign` by that of the exchanges. */
static double ik_clear(double *rows, int width, int columns, double *sign, double *least)
{
    double product = 1.0, swap, inverse, factor;
    int k, r, c, pivot;
    for (k = 0; k < columns; k++) {
        const double *top = &rows[width * k];
        pivot = k;
        for (r = k + 1; r < 6; r++)
            if (ik_abs(rows[width * r + k]) > ik_abs(rows[width * pivot + k])) pivot = r;
        if (pivot != k) {
            for (c = 0; c < width; c++) {
                swap = rows[width * pivot + c];
                rows[width * pivot + c] = rows[width * k + c];
                rows[width * k + c] = swap;
            }
            *sign = -*sign;
        }
        product *= top[k];
        if (ik_abs(top[k]) < *least) *least = ik_abs(top[k]);
        if (!(top[k] < 0.0) && !(top[k] > 0.0)) continue;
        inverse = 1.0 / top[k];
        for (r = k + 1; r < 6; r++) {
            double *row = &rows[width * r];
            factor = row[k] * inverse;
            row[k] = 0.0;
            for (c = k + 1; c < width; c++) row[c] -= factor * top[c];
        }
    }
    return product;
}

/* The square system of the six equations and their multiples by t at one value of q3, reduced to the unknowns (t y, y) with y for
   1, c, s of the third angle: its determinant is what is returned times that of `left`. In blocks of three columns the twelve are,
   after the first three columns of the six have been cleared below U,

       U T T 0
       0 L L 0
       0 U T T      the three rows L L 0 and U T T clear the second block of columns,
       0 0 L L      and leave three that join the last */
static double ik_reduced(const ik_six_rows *six, ik_turn turn, double left[36], double *least)
{
    double rows[54], next[54] = { 0.0 }, sign = 1.0, ignored = 1.0, first, second;
    int r, c;
    ik_rows_at(six, turn, rows);
    /* The same steps act on the equations and on their multiples, so that the sign of exchanges cancels. */
    first = ik_clear(rows, 9, 3, &ignored, least);
    for (r = 0; r < 3; r++) {
        for (c = 0; c < 6; c++) next[9 * r + c] = rows[9 * (3 + r) + 3 + c];
        for (c = 0; c < 9; c++) next[9 * (3 + r) + c] = rows[9 * r + c];
    }
    second = ik_clear(next, 9, 3, &sign, least);
    for (r = 0; r < 3; r++)
        for (c = 0; c < 6; c++) {
            left[6 * r + c] = next[9 * (3 + r) + 3 + c];
            left[6 * (3 + r) + c] = rows[9 * (3 + r) + 3 + c];
        }
    return sign * first * second;
}

/* == null == */
/* The null space of the reduced system: vectors (t y, y); returns how many there are, three at most. */
static int ik_null_space(const ik_six_rows *six, ik_turn turn, int most, double nothing, double vectors[3][6])
{
    double m[36], largest = 0.0, pivot, factor, x[6], sum, swap, least = 1.0;
    int columns[6] = { 0, 1, 2, 3, 4, 5 }, rank = 0, row, column, count, r, c, i;
    ik_reduced(six, turn, m, &least);
    for (; rank < 6; rank++) {
        row = column = rank;
        for (r = rank; r < 6; r++)
            for (c = rank; c < 6; c++)
                if (ik_abs(m[6 * r + c]) > ik_abs(m[6 * row + column])) {
                    row = r;
                    column = c;
                }
        pivot = ik_abs(m[6 * row + column]);
        if (pivot > largest) largest = pivot;
        /* The system is singular, whatever rounding says. */
        if (rank == 5 || (rank + most >= 6 && pivot <= nothing * largest) || !(pivot > 0.0)) break;
        for (c = 0; c < 6; c++) {
            swap = m[6 * rank + c];
            m[6 * rank + c] = m[6 * row + c];
            m[6 * row + c] = swap;
        }
        i = columns[rank];
        columns[rank] = columns[column];
        columns[column] = i;
        for (r = 0; r < 6; r++) {
            swap = m[6 * r + rank];
            m[6 * r + rank] = m[6 * r + column];
            m[6 * r + column] = swap;
        }
        for (r = rank + 1; r < 6; r++) {
            factor = m[6 * r + rank] / m[6 * rank + rank];
            for (c = rank + 1; c < 6; c++) m[6 * r + c] -= factor * m[6 * rank + c];
        }
    }
    count = 6 - rank < 3 ? 6 - rank : 3;
    for (i = 0; i < count; i++) {
        for (r = 0; r < 6; r++) x[r] = r == rank + i ? 1.0 : 0.0;
        for (r = rank - 1; r >= 0; r--) {
            sum = 0.0;
            for (c = r + 1; c < 6; c++) sum += m[6 * r + c] * x[c];
            x[r] = -sum / m[6 * r + r];
        }
        for (r = 0; r < 6; r++) vectors[i][columns[r]] = x[r];
    }
    return count;
}

/* Half of a null vector. */
static ik_vector ik_half_of(const double *v) { return ik_vector_of(v[0], v[1], v[2]); }

/* The turn along the last two of y, whichever sign it has. */
static int ik_unit_of(ik_vector y, ik_turn *out)
{
    double sign = y.x[0] < 0.0 ? -1.0 : 1.0;
    return ik_unit(sign * y.x[1], sign * y.x[2], out);
}

/* At a simple root, the turn whose half tangent was eliminated, and the one beside it; says whether there is such a pair. */
static int ik_single(const ik_six_rows *six, ik_turn turn, ik_turn pair[2])
{
    double vectors[3][6], h, l, hl;
    ik_vector high, low;
    ik_turn half;
    ik_null_space(six, turn, 1, 1e-6, vectors);
    high = ik_half_of(vectors[0]);
    low = ik_half_of(&vectors[0][3]);
    h = ik_dot(high, high);
    l = ik_dot(low, low);
    hl = ik_dot(high, low);
    if (!(h > l ? ik_unit(hl, h, &half) : ik_unit(l, hl, &half))) return 0;
    pair[0] = ik_turn_of_half(half);
    return ik_unit_of(h > l ? high : low, &pair[1]);
}

/* The turns at which all forms in 1, c, s vanish; returns how many: one, or two where the forms are multiples of one. */
static int ik_third(const ik_vector forms[6], ik_turn found[2])
{
    ik_vector first = forms[0], y = ik_vector_of(0.0, 0.0, 0.0), across;
    ik_roots roots;
    int i;
    for (i = 0; i < 6; i++)
        if (ik_dot(forms[i], forms[i]) > ik_dot(first, first)) first = forms[i];
    for (i = 0; i < 6; i++) {
        across = ik_cross(first, forms[i]);
        if (ik_dot(across, across) > ik_dot(y, y)) y = across;
    }
    if (ik_dot(y, y) > 1e-10 * ik_dot(first, first) * ik_dot(first, first)) return ik_unit_of(y, found);
    roots = ik_circle(first.x[1], first.x[2], -first.x[0], 1e-9);
    for (i = 0; i < ik_count(&roots) && i < 2; i++) {
        double root[2];
        ik_get(&roots, i, root);
        found[i] = ik_turn_of(root[0], root[1]);
    }
    return i;
}

/* The third angle, as a multiple of 1, c, s, that two solutions share which differ in t: both (y, 0) and (0, y) are null vectors then,
   and no map says what t is. Returns whether there is one, and how many of the vectors are of others; they come first, with nothing of y
   left in them. */
static int ik_shared(ik_vector highs[3], ik_vector lows[3], int n, ik_vector *y, int *rest)
{
    double square, part, most = 0.0, before;
    int i, k, longest;
    ik_vector swap;
    for (k = 0; k < n - 1; k++) {
        longest = k;
        for (i = k + 1; i < n; i++)
            if (ik_dot(lows[i], lows[i]) > ik_dot(lows[longest], lows[longest])) longest = i;
        swap = lows[k];
        lows[k] = lows[longest];
        lows[longest] = swap;
        swap = highs[k];
        highs[k] = highs[longest];
        highs[longest] = swap;
        for (i = k + 1; i < n; i++) {
            part = ik_dot(lows[i], lows[k]) / ik_dot(lows[k], lows[k]);
            lows[i] = ik_minus(lows[i], ik_scaled(lows[k], part));
            highs[i] = ik_minus(highs[i], ik_scaled(highs[k], part));
        }
    }
    *y = highs[n - 1];
    square = ik_dot(*y, *y);
    /* Below the square of this angle, about, two third angles are one. */
    if (!(ik_dot(lows[n - 1], lows[n - 1]) < 1e-8 * square)) return 0;
    longest = 0;
    for (i = 0; i < n - 1; i++) {
        before = ik_dot(lows[i], lows[i]);
        lows[i] = ik_minus(lows[i], ik_scaled(*y, ik_dot(lows[i], *y) / square));
        highs[i] = ik_minus(highs[i], ik_scaled(*y, ik_dot(highs[i], *y) / square));
        part = ik_dot(lows[i], lows[i]) / before;
        if (part > most) {
            longest = i;
            most = part;
        }
    }
    lows[0] = lows[longest];
    highs[0] = highs[longest];
    *rest = most > 1e-8;
    return 1;
}

/* The halves of turns, as vectors along them, with a t^2 + b t + c = 0: returns how many there are. */
static int ik_halves_of(ik_vector form, ik_turn halves[2])
{
    double a = form.x[0], b = form.x[1], c = form.x[2], square = b * b - 4.0 * a * c, far;
    int count;
    if (!(square > -1e-8 * (b * b + 4.0 * ik_abs(a * c)))) return 0;
    far = b < 0.0 ? b - ik_sqrt(square) : b + ik_sqrt(square);
    count = ik_unit(-2.0 * a, far, &halves[0]);
    return count + ik_unit(far, -2.0 * c, &halves[count]);
}

/* The pairs at a root where several solutions share the angle: as many null vectors as there are solutions, mixed. Multiplication by t
   maps their space to itself, and its eigenvalues are the values of t. Pivots below the part `nothing` of the first one count as zero.
   Returns the dimension of the null space; a space of one dimension gives no pairs. */
static int ik_several(const ik_six_rows *six, ik_turn turn, double nothing, ik_turn pairs[6][2], int *count)
{
    double vectors[3][6], left[3][3], right[3][3], map[IK_SIZE][IK_SIZE] = { { 0.0 } }, values[IK_SIZE][2], rows[54];
    double factor, swap;
    ik_vector highs[3], lows[3], y;
    int n = ik_null_space(six, turn, 3, nothing, vectors), dimension = n, found, rest, i, j, k, r, c;
    *count = 0;
    if (n < 2) return n;
    ik_rows_at(six, turn, rows);
    for (i = 0; i < n; i++) {
        highs[i] = ik_half_of(vectors[i]);
        lows[i] = ik_half_of(&vectors[i][3]);
    }
    /* Those that share the third angle first. */
    if (ik_shared(highs, lows, n, &y, &rest)) {
        ik_vector form = ik_vector_of(0.0, 0.0, 0.0), next;
        ik_turn halves[2], other;
        for (r = 0; r < 6; r++) {
            const double *x = &rows[9 * r];
            next = ik_vector_of(ik_dot(ik_half_of(x), y), ik_dot(ik_half_of(&x[3]), y), ik_dot(ik_half_of(&x[6]), y));
            if (ik_dot(next, next) > ik_dot(form, form)) form = next;
        }
        if (ik_unit_of(y, &other)) {
            found = ik_halves_of(form, halves);
            for (i = 0; i < found; i++) {
                pairs[*count][0] = ik_turn_of_half(halves[i]);
                pairs[*count][1] = other;
                *count += 1;
            }
        }
        n = rest;
    }
    /* high = low T, by normal equations, solved by elimination. */
    for (i = 0; i < n; i++)
        for (j = 0; j < n; j++) {
            left[i][j] = ik_dot(lows[i], lows[j]);
            right[i][j] = ik_dot(lows[i], highs[j]);
        }
    for (k = 0; k < n; k++)
        for (r = 0; r < n; r++) {
            if (r == k) continue;
            factor = left[r][k] / left[k][k];
            for (c = 0; c < n; c++) {
                left[r][c] -= factor * left[k][c];
                right[r][c] -= factor * right[k][c];
            }
        }
    for (i = 0; i < n; i++)
        for (j = 0; j < n; j++) map[i][j] = right[i][j] / left[i][i];
    if (n == 3) {
        /* A similar matrix whose lower left corner is zero. */
        if (ik_abs(map[2][0]) > ik_abs(map[1][0])) {
            for (c = 0; c < 3; c++) {
                swap = map[1][c];
                map[1][c] = map[2][c];
                map[2][c] = swap;
            }
            for (r = 0; r < 3; r++) {
                swap = map[r][1];
                map[r][1] = map[r][2];
                map[r][2] = swap;
            }
        }
        if (ik_abs(map[1][0]) > 0.0) {
            factor = map[2][0] / map[1][0];
            for (c = 0; c < 3; c++) map[2][c] -= factor * map[1][c];
            for (r = 0; r < 3; r++) map[r][1] += factor * map[r][2];
        }
    }
    found = ik_eigenvalues(map, n, values);
    for (i = 0; i < found; i++) {
        double t = values[i][0];
        ik_vector forms[6];
        ik_turn half, others[2];
        if (ik_abs(values[i][1]) > 1e-3 * (1.0 + t * t) || !ik_unit(1.0, t, &half)) continue;
        for (r = 0; r < 6; r++)
            for (k = 0; k < 3; k++) {
                const double *x = &rows[9 * r + k];
                forms[r].x[k] = x[0] * half.s * half.s + x[3] * half.s * half.c + x[6] * half.c * half.c;
            }
        j = ik_third(forms, others);
        for (k = 0; k < j; k++) {
            pairs[*count][0] = ik_turn_of_half(half);
            pairs[*count][1] = others[k];
            *count += 1;
        }
    }
    return dimension;
}

/* == joint == */
/* What loops of six unknowns have in common. */
#define IK_CANDIDATES 48

typedef struct {
    ik_turn turns[IK_CANDIDATES][6];
    int count;
} ik_candidates;

/* A loop turned and shifted to an order; `joints` says which joint is at each place. */
typedef struct {
    ik_line lines[6];
    ik_motion goal;
    int joints[6];
    int swapped;
} ik_loop;

static ik_loop ik_arrange(const ik_line lines[6], const ik_motion *goal, int code)
{
    ik_loop loop;
    ik_motion undo;
    int backwards = code >= 12, shift = code % 12 / 2, i, place;
    loop.swapped = code % 2;
    loop.goal = backwards ? ik_inverse(goal) : *goal;
    undo = ik_inverse(&loop.goal);
    for (i = 0; i < 6; i++) {
        place = (i + shift) % 6;
        loop.joints[i] = backwards ? 5 - place : place;
        loop.lines[i] = lines[loop.joints[i]];
        if (backwards) loop.lines[i].direction = ik_scaled(loop.lines[i].direction, -1.0);
        /* e1 X = G is X (G^-1 e1 G) = G. */
        if (i + shift >= 6) loop.lines[i] = ik_line_moved(&undo, &loop.lines[i]);
    }
    return loop;
}

/* The turn about an axis that takes two vectors to two others as well as it can. */
static int ik_turn_between(ik_vector axis, const ik_vector from[2], const ik_vector to[2], ik_turn *out)
{
    double x = 0.0, y = 0.0;
    int i;
    for (i = 0; i < 2; i++) {
        ik_vector across = ik_minus(from[i], ik_scaled(axis, ik_dot(axis, from[i])));
        x += ik_dot(across, to[i]);
        y += ik_dot(axis, ik_cross(across, to[i]));
    }
    return ik_unit(x, y, out);
}

/* Adds u . R2 v = right as an equation in the cosine and sine of q2. */
static void ik_add_turned(ik_vector axis, ik_vector u, ik_vector v, double right, double equation[3])
{
    ik_vector along = ik_scaled(axis, ik_dot(axis, v));
    equation[0] = ik_dot(u, ik_minus(v, along)) + equation[0];
    equation[1] = ik_dot(u, ik_cross(axis, v)) + equation[1];
    equation[2] = (right - ik_dot(u, along)) + equation[2];
}

/* The first two turns and the last, from the middle three; says whether there are such. */
static int ik_close(const ik_loop *loop, const ik_turn middle[3], ik_turn turns[6])
{
    const ik_line *lines = loop->lines;
    ik_line reached = ik_line_turned(&lines[4], &lines[5], middle[2]), goal = ik_line_moved(&loop->goal, &lines[5]);
    ik_vector h1 = lines[0].direction, h2 = lines[1].direction, h6 = lines[5].direction;
    ik_vector p, l = ik_vector_of(0.0, 0.0, 0.0), g, m, step, moved[2], wanted[2], side, seen, gap, lean;
    double equations[5][3] = { { 0.0 } }, cc = 0.0, cs = 0.0, ss = 0.0, cr = 0.0, sr = 0.0, size;
    int i;
    reached = ik_line_turned(&lines[3], &reached, middle[1]);
    reached = ik_line_turned(&lines[2], &reached, middle[0]);
    /* e1 e2 takes the line (p, l) to (g, m); what e1 leaves alone is linear in the cosine and sine of q2. */
    p = ik_minus(reached.point, lines[1].point);
    l = reached.direction;
    g = ik_minus(goal.point, lines[0].point);
    m = goal.direction;
    step = ik_minus(lines[1].point, lines[0].point);
    ik_add_turned(h2, h1, l, ik_dot(h1, m), equations[0]);
    ik_add_turned(h2, h1, p, ik_dot(h1, g) - ik_dot(h1, step), equations[1]);
    ik_add_turned(h2, step, p, 0.5 * (ik_dot(g, g) - ik_dot(p, p) - ik_dot(step, step)), equations[2]);
    ik_add_turned(h2, step, l, ik_dot(g, m) - ik_dot(p, l), equations[3]);
    ik_add_turned(h2, h1, ik_cross(p, l), ik_dot(h1, ik_cross(g, m)), equations[4]);
    ik_add_turned(h2, ik_cross(h1, step), l, 0.0, equations[4]);
    for (i = 0; i < 5; i++) {
        double c = equations[i][0], s = equations[i][1], r = equations[i][2];
        cc += c * c;
        cs += c * s;
        ss += s * s;
        cr += c * r;
        sr += s * r;
    }
    if (!ik_unit(cr * ss - sr * cs, sr * cc - cr * cs, &turns[1])) return 0;
    moved[0] = ik_plus(ik_turned(&lines[1], p, turns[1]), step);
    moved[1] = ik_turned(&lines[1], l, turns[1]);
    wanted[0] = g;
    wanted[1] = m;
    if (!ik_turn_between(h1, moved, wanted, &turns[0])) return 0;
    /* Near roots that are no solutions, or of many that fall together, the loop does not close. */
    gap = ik_minus(ik_turned(&lines[0], moved[0], turns[0]), g);
    lean = ik_minus(ik_turned(&lines[0], moved[1], turns[0]), m);
    size = ik_dot(g, g) + ik_dot(p, p) + ik_dot(step, step);
    if (!(ik_dot(gap, gap) <= size && ik_dot(lean, lean) <= 1.0)) return 0;
    for (i = 0; i < 3; i++) turns[2 + i] = middle[i];
    /* A vector that is not along the last axis shows how far that has turned. */
    side = ik_abs(h6.x[0]) < 0.8 ? ik_vector_of(1.0, 0.0, 0.0) : ik_vector_of(0.0, 1.0, 0.0);
    seen = ik_vector_moved(&loop->goal, side);
    for (i = 0; i < 5; i++) seen = ik_turned(&lines[i], seen, ik_back(turns[i]));
    moved[0] = side;
    wanted[0] = seen;
    moved[1] = wanted[1] = ik_vector_of(0.0, 0.0, 0.0);
    return ik_turn_between(h6, moved, wanted, &turns[5]);
}

/* A motion near another, in no special direction. */
static ik_motion ik_nudged(const ik_motion *goal, double size)
{
    ik_turn turn = ik_turn_by(size);
    ik_line about;
    ik_motion out;
    int i, k;
    about.direction = ik_vector_of(0.48, -0.6, 0.64);
    about.point = ik_vector_of(0.0, 0.0, 0.0);
    for (i = 0; i < 3; i++) {
        ik_vector column = ik_turned(&about, ik_vector_of(goal->rows[0].x[i], goal->rows[1].x[i], goal->rows[2].x[i]), turn);
        for (k = 0; k < 3; k++) out.rows[k].x[i] = column.x[k];
    }
    out.place = ik_plus(goal->place, ik_scaled(ik_vector_of(0.64, 0.48, -0.6), size));
    return out;
}

/* Adds a candidate, unless one is nearer to it in all cosines and sines: that is the same, found in two orders. */
static void ik_add_turns(const ik_turn turns[6], ik_candidates *found)
{
    int i, k;
    if (found->count >= IK_CANDIDATES) return;
    for (k = 0; k < found->count; k++) {
        double gap = 0.0, one;
        for (i = 0; i < 6; i++) {
            const ik_turn *other = &found->turns[k][i];
            one = ik_abs(other->c - turns[i].c);
            if (one > gap) gap = one;
            one = ik_abs(other->s - turns[i].s);
            if (one > gap) gap = one;
        }
        if (!(gap > 1e-9)) return;
    }
    for (i = 0; i < 6; i++) found->turns[found->count][i] = turns[i];
    found->count++;
}

/* Roots whose imaginary part is smaller may be real: pairs that fall together lose half of their digits. */
#define IK_NEARLY_REAL 1e-3

/* == whole == */
/* The equations without q1 and q2, for the loop e1 ... e6 = goal, by Raghavan and Roth's elimination. The half tangent is that of q4, or
   of q5 if `swapped`. */
static void ik_eliminate(const ik_line lines[6], const ik_motion *goal, int swapped, ik_six_rows *out)
{
    double left[14][27], right[14][9], values[14], scale = ik_scale_of(lines, 6, lines[2].point);
    ik_turn plain[3], shifted[3];
    ik_vector origin = lines[2].point;
    int i, j, k, row;
    ik_places(plain, shifted);
    for (k = 0; k < 3; k++) {
        ik_line after5 = ik_line_turned(&lines[4], &lines[5], swapped ? shifted[k] : plain[k]);
        for (j = 0; j < 3; j++) {
            ik_line after4 = ik_line_turned(&lines[3], &after5, swapped ? plain[j] : shifted[j]);
            for (i = 0; i < 3; i++) {
                ik_line after3 = ik_line_turned(&lines[2], &after4, plain[i]);
                ik_functions(&after3, origin, scale, values);
                for (row = 0; row < 14; row++) left[row][swapped ? 9 * i + 3 * k + j : 9 * i + 3 * j + k] = values[row];
            }
        }
    }
    ik_right_side(lines, goal, origin, scale, right);
    for (row = 0; row < 14; row++) {
        ik_fit(left[row], 27, 1);
        ik_fit(left[row], 27, 3);
        ik_fit(left[row], 27, 9);
        left[row][0] -= right[row][0];
    }
    ik_clear_right(left[0], 27, right);
    for (row = 0; row < 6; row++)
        for (i = 0; i < 3; i++) ik_by_half_tangent(&left[8 + row][9 * i], &out->rows[row][9 * i]);
}

/* How the sampled angle is looked at: tan((q3 - centre) / 2) = width tan(u / 2). A determinant is a trigonometric polynomial of u as
   well; where it is all but zero over a part of the circle, a small width shows what is there. */
typedef struct {
    ik_turn centre;
    double width;
} ik_view;

/* The angle at u, and the square of the stretch there. */
static ik_turn ik_turn_in_view(const ik_view *view, double u, double *square)
{
    ik_turn half = ik_turn_by(0.5 * u);
    double c = half.c, s = view->width * half.s;
    *square = c * c + s * s;
    return ik_sum(view->centre, ik_turn_of((c * c - s * s) / *square, 2.0 * c * s / *square));
}

/* The determinant at u, as a trigonometric polynomial of this degree. */
static double ik_value_in_view(const ik_view *view, const ik_six_rows *six, int degree, double u, double *least)
{
    double square, rows[36], sign = 1.0, factor, pivots, value;
    ik_turn turn = ik_turn_in_view(view, u, &square);
    int i;
    *least = 1.7976931348623157e308;
    factor = ik_reduced(six, turn, rows, least);
    pivots = ik_clear(rows, 6, 6, &sign, least);
    value = sign * factor * pivots;
    for (i = 0; i < degree; i++) value *= square;
    return value;
}

/* The waves of the determinant, from samples at equal steps, and the largest of the smallest pivots. */
static ik_waves ik_waves_in_view(const ik_view *view, const ik_six_rows *six, int degree, double *clear)
{
    ik_waves waves = { { { 0.0 } }, 0, 0.0, 0.0 };
    double samples[IK_SAMPLES], table[IK_SAMPLES][2], step, least;
    int n = 2 * degree + 1, at = 0, i, k, place;
    *clear = 0.0;
    step = 6.283185307179586 / (double)n;
    for (i = 0; i < n; i++) {
        samples[i] = ik_value_in_view(view, six, degree, 6.283185307179586 * (double)i / (double)n, &least);
        if (least > *clear) *clear = least;
    }
    for (i = 0; i < n; i++) {
        ik_cos_sin(step * (double)i, table[i]);
        if (ik_abs(samples[i]) > ik_abs(samples[at])) at = i;
    }
    for (k = 0; k <= degree; k++) {
        for (place = 0, i = 0; i < n; i++) {
            waves.d[k][0] += samples[i] * table[place][0];
            waves.d[k][1] -= samples[i] * table[place][1];
            place = (place + k) % n;
        }
        waves.d[k][0] /= (double)n;
        waves.d[k][1] /= (double)n;
    }
    waves.degree = degree;
    waves.largest = ik_abs(samples[at]);
    waves.start = step * (double)at - 3.141592653589793;
    return waves;
}

/* Value and derivative. */
static double ik_waves_at(const ik_waves *waves, double angle, double *slope)
{
    ik_turn turn = ik_turn_by(angle);
    double x = 1.0, y = 0.0, value = waves->d[0][0], next;
    int k;
    *slope = 0.0;
    for (k = 1; k <= waves->degree; k++) {
        next = x * turn.c - y * turn.s;
        y = x * turn.s + y * turn.c;
        x = next;
        value += 2.0 * (waves->d[k][0] * x - waves->d[k][1] * y);
        *slope -= 2.0 * (double)k * (waves->d[k][0] * y + waves->d[k][1] * x);
    }
    return value;
}

/* A root of the determinant near that of its waves, which are exact to rounding of the largest sample: Newton's method with the
   determinant itself and the slope of the waves, only where rounding matters. */
static double ik_refined(const ik_six_rows *six, const ik_waves *waves, const ik_view *view, double start)
{
    double q = start, slope, doubt, change, least;
    int i;
    for (i = 0; i < 8; i++) {
        ik_waves_at(waves, q, &slope);
        doubt = 1e-15 * waves->largest / ik_abs(slope);
        if (i == 0 && doubt < 1e-13) break;
        change = -ik_value_in_view(view, six, waves->degree, q, &least) / slope;
        if (!(ik_abs(change) < 0.05)) break;
        q += change;
        /* What is left is about this part of the change. */
        if (ik_abs(change) * (doubt + ik_abs(change)) < 1e-13) break;
    }
    return q;
}

/* Whether only one null vector is anywhere near: of two solutions that share the angle there are two. */
static int ik_is_alone(const ik_six_rows *six, ik_turn turn)
{
    double vectors[3][6];
    return ik_null_space(six, turn, 3, 1e-3, vectors) == 1;
}

/* == six == */
/* Six revolute joints in general. The loop is e1 e2 e3 e4 e5 e6 = G, each e a turn about a line. Fourteen equations, each linear in the
   cosine and sine of every angle (Raghavan and Roth, 1993), leave six in q3, q4 and q5; they and their multiples by the half tangent of
   q4 are a square system, whose determinant is a trigonometric polynomial of q3. Its roots are eigenvalues, its null vectors q4 and
   q5, what remains of the loop q2, q1 and q6. Any joint can be first in the loop, and the loop can be run backwards: an order. */

/* Adds a candidate: the sampled turn, then the one that was eliminated by its half tangent and the one beside it. */
static void ik_add_candidate(const ik_loop *loop, ik_turn turn, const ik_turn pair[2], ik_candidates *found)
{
    ik_turn middle[3], turns[6], placed[6];
    int i;
    middle[0] = turn;
    middle[1] = pair[loop->swapped ? 1 : 0];
    middle[2] = pair[loop->swapped ? 0 : 1];
    if (!ik_close(loop, middle, turns)) return;
    for (i = 0; i < 6; i++) placed[loop->joints[i]] = turns[i];
    ik_add_turns(placed, found);
}

/* Where the polynomial is smaller than this part of the largest sample, rounding decides where its roots are and which are real. */
#define IK_FLAT 1e-11

/* The extremum near an angle, with the value and the second derivative there. */
static void ik_extremum(const ik_waves *waves, double angle, double out[3])
{
    double turn[2], bends[3], step;
    int i;
    ik_cos_sin(angle, turn);
    ik_bends(waves, turn, bends);
    for (i = 0; i < 4; i++) {
        step = -bends[1] / bends[2];
        if (!(ik_abs(step) < 1e-2) || ik_abs(step) < 1e-12) break;
        angle += step;
        ik_cos_sin(angle, turn);
        ik_bends(waves, turn, bends);
    }
    out[0] = angle;
    out[1] = bends[0];
    out[2] = bends[2];
}

/* How high the polynomial rises about a root, to second order. */
static double ik_rise(const ik_waves *waves, double angle)
{
    double turn[2], bends[3];
    ik_cos_sin(angle, turn);
    ik_bends(waves, turn, bends);
    return ik_abs(bends[0]) + IK_NEARLY_REAL * (ik_abs(bends[1]) + 0.5 * IK_NEARLY_REAL * ik_abs(bends[2]));
}

/* Most views of the polynomial of an order: the whole circle, and places where it is flat. */
#define IK_VIEWS 3

/* Whether a turn is far from the centre of a narrow view: what is there shows better in the view before. */
static int ik_beside(const ik_view *view, ik_turn turn)
{
    return view->width < 1.0 && turn.c < 0.0;
}

/* The turn from one to another. */
static ik_turn ik_between(ik_turn from, ik_turn to)
{
    return ik_turn_of(from.c * to.c + from.s * to.s, from.c * to.s - from.s * to.c);
}

/* Places where the polynomial is all but zero, or misses the determinant, flattest first and as wide as the roots reach that rounding has
   moved: how many there are, `most` at most, and `more` if there are others. Marks the roots that are there. */
static int ik_flats(const ik_six_rows *six, int degree, int squared, const ik_view *view, const ik_waves *waves, const ik_root *roots,
                    const ik_turn *turns, int count, int most, double places[IK_VIEWS][2], int *holds, int *more)
{
    double rises[IK_SIZE], least, rise, miss, width, gap, slope;
    int n = 0, low, at, i;
    *more = 0;
    for (i = 0; i < count; i++) {
        double imaginary = roots[i].imaginary;
        rises[i] = 1.7976931348623157e308;
        holds[i] = 0;
        if (ik_beside(view, turns[i]) || ik_abs(imaginary) >= 1.0 || (squared && ik_abs(imaginary) < IK_NEARLY_REAL)) continue;
        rise = ik_rise(waves, roots[i].angle);
        low = rise < IK_FLAT * waves->largest;
        if (!low && rise < 1e-7 * waves->largest) {
            /* Waves that are left out of an order because they are small may not be small here. */
            miss = ik_value_in_view(view, six, degree, roots[i].angle, &least) - ik_waves_at(waves, roots[i].angle, &slope);
            low = ik_abs(miss) > 0.1 * rise;
        }
        if (low) rises[i] = rise;
    }
    for (;;) {
        least = 1.7976931348623157e308;
        at = 0;
        for (i = 0; i < count; i++)
            if (rises[i] < least) {
                least = rises[i];
                at = i;
            }
        if (!(least < 1.7976931348623157e308)) return n;
        if (n == most) {
            *more = 1;
            return n;
        }
        width = 1e-3;
        for (i = 0; i < count; i++) {
            ik_turn turn = ik_between(turns[at], turns[i]);
            gap = ik_abs(turn.s) + ik_abs(roots[i].imaginary);
            if (rises[i] < 1.7976931348623157e308 && turn.c > 0.0 && gap < 0.5) {
                if (gap > width) width = gap;
                rises[i] = 1.7976931348623157e308;
                holds[i] = 1;
            }
        }
        rises[at] = 1.7976931348623157e308;
        holds[at] = 1;
        places[n][0] = roots[at].angle;
        places[n][1] = width;
        n++;
    }
}

/* How much an order has shown of what there is: nothing where it breaks down, not what is in flat places of which there were too many,
   not all roots that nearly fall together, or everything. */
enum { IK_NOTHING, IK_PART, IK_MOST, IK_ALL };

/* Adds the candidates that show in one view; says how much they are of what is there. Places where the polynomial is all but zero are
   added to the views, of which there are so many, and may be `most`. */
static int ik_look(const ik_loop *loop, const ik_six_rows *six, int degree, int squared, ik_view views[IK_VIEWS], int at, int *count_views, int most,
                   double slack, ik_candidates *found)
{
    const ik_view *view = &views[at];
    double clear;
    ik_waves waves = ik_waves_in_view(view, six, degree, &clear);
    ik_root roots[IK_SIZE];
    int count, multiplicity = squared ? 2 : 1, apart;
    int done[IK_SIZE] = { 0 }, holds[IK_SIZE], near[IK_SIZE], together, pairs_found, fold, merged, many, more, flats, i, j, k;
    double gap, square, shift, spread, mean, side, exact, off, least;
    double starts[IK_SIZE], extremum[3], places[IK_VIEWS][2];
    ik_turn turn, turns[IK_SIZE], pairs[6][2];
    /* A determinant of which one pivot is smaller than this everywhere is rounding alone: at some poses an order breaks down. */
    if (clear < 1e-9) return view->width < 1.0 ? IK_MOST : IK_NOTHING;
    count = ik_roots_of_waves(&waves, squared, roots);
    apart = count * multiplicity == 2 * degree;
    for (i = 0; i < count; i++) turns[i] = ik_turn_by(roots[i].angle);
    flats = ik_flats(six, degree, squared, view, &waves, roots, turns, count, most - *count_views, places, holds, &more);
    /* Where one pivot is small everywhere solutions may be lost in rounding. */
    if (!(clear > 1e-5)) apart = 0;
    for (i = 0; i < count; i++) {
        double angle = roots[i].angle, imaginary = roots[i].imaginary;
        if (done[i] || ik_beside(view, turns[i]) || ik_abs(imaginary) > IK_NEARLY_REAL + 5.0 * ik_sqrt(slack)) continue;
        together = 0;
        shift = spread = 0.0;
        for (j = 0; j < count; j++) {
            turn = ik_between(turns[i], turns[j]);
            gap = ik_abs(turn.s) + ik_abs(roots[j].imaginary - imaginary);
            near[j] = turn.c > 0.0 && gap < 3e-3;
            if (near[j]) {
                if (gap > spread) spread = gap;
                together += multiplicity;
                shift += turn.s;
            }
        }
        /* Roots that nearly fall together: their mean is more exact than each of them. */
        mean = angle + shift * (double)multiplicity / (double)together;
        if (holds[i]) {
            /* The rest shows in the view of the place. */
            for (j = 0; j < count; j++) done[j] |= near[j] && holds[j];
            turn = ik_turn_in_view(view, mean, &square);
            k = ik_several(six, turn, 1e-6, pairs, &pairs_found);
            for (j = 0; j < pairs_found; j++) ik_add_candidate(loop, turn, pairs[j], found);
            if (k < 2 && ik_single(six, turn, pairs[0])) ik_add_candidate(loop, turn, pairs[0], found);
            continue;
        }
        ik_extremum(&waves, mean, extremum);
        fold = together == 2 && !squared && slack == 0.0;
        many = 0;
        /* What the determinant itself is there also tells how far its waves are off. */
        exact = fold ? ik_value_in_view(view, six, degree, extremum[0], &least) : extremum[1];
        off = ik_abs(exact - extremum[1]) + IK_FLAT * waves.largest;
        if (together == 1 || (fold && imaginary == 0.0 && ik_abs(exact) > off)) {
            starts[0] = ik_refined(six, &waves, view, angle);
            many = 1;
        } else {
            for (j = 0; j < count; j++) done[j] |= near[j];
            merged = spread < 1e-5 || squared;
            turn = ik_turn_in_view(view, mean, &square);
            k = ik_several(six, turn, 1e-6, pairs, &pairs_found);
            for (j = 0; j < pairs_found; j++) ik_add_candidate(loop, turn, pairs[j], found);
            apart &= merged && (k == together || (fold && ik_is_alone(six, turn)));
            if (k == together && merged) continue;
            if (fold) {
                /* Seen from outside of the two each leads to its own. */
                side = ik_sqrt(2.0 * (ik_abs(exact) + 1e-14 * waves.largest) / ik_abs(extremum[2]));
                starts[0] = extremum[0] - side;
                starts[1] = extremum[0] + side;
                many = 2;
            }
            /* Real roots may also be of solutions far apart that share the angle by chance. */
            if (!fold || imaginary == 0.0)
                for (j = 0; j < count; j++) if (near[j]) starts[many++] = roots[j].angle;
        }
        for (j = 0; j < many; j++) {
            turn = ik_turn_in_view(view, starts[j], &square);
            if (ik_single(six, turn, pairs[0])) ik_add_candidate(loop, turn, pairs[0], found);
            else apart = 0;
        }
    }
    for (i = 0; i < flats; i++) {
        turn = ik_turn_in_view(view, places[i][0], &square);
        views[*count_views].centre = turn;
        views[*count_views].width = places[i][1] * view->width / square;
        (*count_views)++;
    }
    if (more) return IK_PART;
    return apart ? IK_ALL : IK_MOST;
}

/* Adds the candidates of one order; says how much of all that there is they are. */
static int ik_solve_order(const ik_line lines[6], const ik_motion *goal, const double *order, double slack, int most, ik_candidates *found)
{
    ik_loop loop = ik_arrange(lines, goal, (int)order[0]);
    ik_six_rows six;
    /* Views that are left to look at, those of wide places before those within them. */
    ik_view views[IK_VIEWS];
    int all = IK_ALL, before = found->count, shown, next, end = 1;
    ik_eliminate(loop.lines, &loop.goal, loop.swapped, &six);
    views[0].centre = ik_turn_of(1.0, 0.0);
    views[0].width = 1.0;
    for (next = 0; next < end; next++) {
        shown = ik_look(&loop, &six, (int)order[1], order[2] > 0.0, views, next, &end, most, slack, found);
        if (shown < all) all = shown;
    }
    return all == IK_ALL && found->count == before ? IK_MOST : all;
}

/* Candidate turns of six joints. The numbers are six lines as direction and point, the rows of the goal's rotation, its place, and three
   orders as code, degree (zero for none), and whether the determinant is a square. Orders that break down at this goal are passed over, the
   others are tried until one has shown all there is; where all break down goals nearby are solved. Slack is for poses at which that gave
   nothing: at a goal nearby solutions are isolated, and near enough for a polish. */
static void ik_six(const double numbers[57], double slack, ik_candidates *found)
{
    ik_line lines[6];
    ik_motion goal, near;
    const double beside[2] = { 1e-2, -1e-3 };
    const double *orders[3];
    int count = 0, sound = 0, shown, i;
    found->count = 0;
    for (i = 0; i < 57; i++)
        if (!ik_finite(numbers[i])) return;
    for (i = 0; i < 6; i++) {
        lines[i].direction = ik_half_of(&numbers[6 * i]);
        lines[i].point = ik_half_of(&numbers[6 * i + 3]);
    }
    for (i = 0; i < 3; i++) goal.rows[i] = ik_half_of(&numbers[36 + 3 * i]);
    goal.place = ik_half_of(&numbers[45]);
    if (slack > 0.0) goal = ik_nudged(&goal, 0.1 * slack);
    for (i = 48; i < 57; i += 3)
        if (numbers[i + 1] > 0.0) orders[count++] = &numbers[i];
    for (i = 0; i < count; i++) {
        shown = ik_solve_order(lines, &goal, orders[i], slack, IK_VIEWS, found);
        if (shown == IK_ALL && !(slack > 0.0)) return;
        if (shown == IK_NOTHING) continue;
        /* Solutions that share the angle here do not at a goal nearby; but those that are nearly singular may not reach it. */
        if (sound < 2 && !(slack > 0.0)) {
            near = ik_nudged(&goal, beside[sound]);
            if (ik_solve_order(lines, &near, orders[i], slack, 1, found) == IK_ALL && shown == IK_MOST) return;
        }
        sound++;
    }
    for (i = 0; i < 2 && sound == 0 && count > 0; i++) {
        near = ik_nudged(&goal, beside[i]);
        ik_solve_order(lines, &near, orders[i % count], slack, 1, found);
    }
}

/* == piece == */
/* A smooth function on an interval, by its samples at Chebyshev nodes: coefficients of Chebyshev's polynomials. */
#define IK_NODES (IK_SIZE + 1)

typedef struct {
    double a[IK_NODES];
    double centre, half, largest;
    /* Largest sample of that third of the samples where they are smallest, as part of the largest one of all. */
    double even;
} ik_piece;

/* Cosines of the multiples of the angle between half a node and the next. */
static void ik_cosines(double table[4 * IK_NODES])
{
    double turn[2];
    int m;
    for (m = 0; m < 4 * IK_NODES; m++) {
        ik_cos_sin((double)m * (3.141592653589793 / (double)(2 * IK_NODES)), turn);
        table[m] = turn[0];
    }
}

/* From the samples to the coefficients, for the interval of this width from `start` on. */
static void ik_piece_of(const double table[4 * IK_NODES], double start, double width, const double samples[IK_NODES], ik_piece *piece)
{
    double least = 1.7976931348623157e308, most = 0.0, size;
    int j, k;
    for (j = 0; j < IK_NODES; j += IK_NODES / 3 + 1) {
        size = 0.0;
        for (k = j; k < IK_NODES && k < j + IK_NODES / 3 + 1; k++)
            if (ik_abs(samples[k]) > size) size = ik_abs(samples[k]);
        if (size < least) least = size;
        if (size > most) most = size;
    }
    piece->even = least / most;
    piece->half = 0.5 * width;
    piece->centre = start + piece->half;
    piece->largest = 0.0;
    for (j = 0; j < IK_NODES; j++) {
        double sum = 0.0;
        for (k = 0; k < IK_NODES; k++) sum += samples[k] * table[j * (2 * k + 1) % (4 * IK_NODES)];
        piece->a[j] = sum * ((j == 0 ? 1.0 : 2.0) / (double)IK_NODES);
        if (ik_abs(piece->a[j]) > piece->largest) piece->largest = ik_abs(piece->a[j]);
    }
}

/* The last coefficients: what the polynomial may be off. */
static double ik_rest_of_piece(const ik_piece *piece)
{
    return ik_abs(piece->a[IK_SIZE - 1]) + ik_abs(piece->a[IK_SIZE]);
}

static double ik_slope_of_piece(const ik_piece *piece, double x)
{
    double t = (x - piece->centre) / piece->half, before = 0.0, u = 1.0, sum = 0.0, next;
    int k;
    for (k = 1; k < IK_NODES; k++) {
        sum += piece->a[k] * (double)k * u;
        next = 2.0 * t * u - before;
        before = u;
        u = next;
    }
    return sum / piece->half;
}

/* Places and imaginary parts of the roots on the interval, or as near to it as `margin`, with imaginary parts up to `height`: eigenvalues of
   the colleague matrix (Good, 1961; Boyd, 2002). Returns how many there are. */
static int ik_roots_of_piece(const ik_piece *piece, double margin, double height, double found[IK_SIZE][2])
{
    double colleague[IK_SIZE][IK_SIZE] = { { 0.0 } }, values[IK_SIZE][2], others = 0.0, least, last, base, power = 1.0, x, y;
    int k, count, kept = 0;
    for (k = 1; k < IK_NODES; k++) others += ik_abs(piece->a[k]);
    if (!(piece->largest > 0.0 && ik_finite(piece->largest)) || ik_abs(piece->a[0]) > 1.01 * others) return 0;
    /* What is less is rounding. */
    least = 1e-14 * piece->largest;
    last = ik_abs(piece->a[IK_SIZE]) > least ? piece->a[IK_SIZE] : least;
    /* The basis is scaled by powers of the sixteenth root, which balances the matrix. */
    base = ik_sqrt(ik_sqrt(ik_sqrt(ik_sqrt(piece->largest / ik_abs(last)))));
    for (k = IK_SIZE - 1; k >= 0; k--) {
        colleague[k][IK_SIZE - 1] = -0.5 * piece->a[k] / last * power;
        power /= base;
    }
    for (k = 1; k < IK_SIZE; k++) {
        colleague[k][k - 1] += k == 1 ? base : 0.5 * base;
        colleague[k - 1][k] += 0.5 / base;
    }
    count = ik_eigenvalues(colleague, IK_SIZE, values);
    for (k = 0; k < count; k++) {
        x = piece->half * values[k][0];
        y = piece->half * values[k][1];
        if (ik_abs(x) <= piece->half + margin && ik_abs(y) <= height) {
            found[kept][0] = piece->centre + x;
            found[kept][1] = y;
            kept++;
        }
    }
    return kept;
}

/* == sweep == */
/* Six unknowns of a loop of which five turn a joint each, while one slides, or moves several joints at once. For each value of that one the
   other five close the loop only by chance: with a sixth joint among them that does not turn, the elimination gives a determinant that
   vanishes there. It is swept over all values, interval after interval, each so short that a polynomial is as good. */
#define IK_MOST_LINES 9

/* The right side of a loop: six combinations of the fourteen equations that hold whatever q1 and q2 are, what is constant on the right
   side, and the square of the volume of its columns: with it as a factor the determinant is a smooth function of the loop. */
typedef struct { double rows[6][14], constant[14], volume; } ik_shadow;

static void ik_shadow_of(const ik_line lines[6], const ik_motion *goal, ik_vector origin, double scale, ik_shadow *out)
{
    double right[14][9], all[14][14] = { { 0.0 } };
    int i, k;
    ik_right_side(lines, goal, origin, scale, right);
    for (i = 0; i < 14; i++) {
        out->constant[i] = right[i][0];
        all[i][i] = 1.0;
    }
    out->volume = ik_clear_right(all[0], 14, right);
    for (i = 0; i < 6; i++)
        for (k = 0; k < 14; k++) out->rows[i][k] = all[8 + i][k];
}

/* As ik_eliminate, of a loop whose third joint does not turn: the six equations hold for q3 at zero. */
static void ik_eliminate_still(const ik_line lines[6], int swapped, ik_vector origin, double scale, const ik_shadow *shadow, ik_six_rows *out)
{
    double left[14][9], values[14], six[9];
    ik_turn plain[3], shifted[3];
    int j, k, row;
    ik_places(plain, shifted);
    for (k = 0; k < 3; k++) {
        ik_line after5 = ik_line_turned(&lines[4], &lines[5], swapped ? shifted[k] : plain[k]);
        for (j = 0; j < 3; j++) {
            ik_line after4 = ik_line_turned(&lines[3], &after5, swapped ? plain[j] : shifted[j]);
            ik_functions(&after4, origin, scale, values);
            for (row = 0; row < 14; row++) left[row][swapped ? 3 * k + j : 3 * j + k] = values[row];
        }
    }
    for (row = 0; row < 14; row++) {
        ik_fit(left[row], 9, 1);
        ik_fit(left[row], 9, 3);
        left[row][0] -= shadow->constant[row];
    }
    for (row = 0; row < 6; row++) {
        for (k = 0; k < 9; k++) six[k] = 0.0;
        for (j = 0; j < 14; j++)
            for (k = 0; k < 9; k++) six[k] += shadow->rows[row][j] * left[j][k];
        for (k = 0; k < 27; k++) out->rows[row][k] = 0.0;
        ik_by_half_tangent(six, out->rows[row]);
    }
}

/* The joints of a loop, base to tip: their lines, how they move (zero for none, one for an unknown turn, two and three for a turn and a
   slide by the swept variable), and how far for each unit of that. */
typedef struct {
    ik_line lines[IK_MOST_LINES];
    int kinds[IK_MOST_LINES];
    double ratios[IK_MOST_LINES];
    ik_motion goal;
    ik_vector origin;
    double scale;
    int turns;
    /* How many of the five come before the swept joints, -1 if one is among these. Then the right side is constant in some orders. */
    int before;
    int is_constant;
    ik_shadow shadow;
    /* Values where there are roots in an order whatever the goal, and how many, zero for none. */
    double places[2][2];
} ik_swept;

/* A motion after another. */
static ik_motion ik_after(const ik_motion *motion, const ik_motion *first)
{
    ik_motion out;
    int i, k;
    for (i = 0; i < 3; i++) {
        ik_vector column = ik_vector_moved(motion, ik_vector_of(first->rows[0].x[i], first->rows[1].x[i], first->rows[2].x[i]));
        for (k = 0; k < 3; k++) out.rows[k].x[i] = column.x[k];
    }
    out.place = ik_plus(ik_vector_moved(motion, first->place), motion->place);
    return out;
}

/* The motion of turning about a line. */
static ik_motion ik_turning(const ik_line *line, ik_turn turn)
{
    ik_motion out;
    int i, k;
    for (i = 0; i < 3; i++) {
        ik_vector column = ik_turned(line, ik_vector_of(i == 0 ? 1.0 : 0.0, i == 1 ? 1.0 : 0.0, i == 2 ? 1.0 : 0.0), turn);
        for (k = 0; k < 3; k++) out.rows[k].x[i] = column.x[k];
    }
    out.place = ik_plus(line->point, ik_turned(line, ik_minus(ik_vector_of(0.0, 0.0, 0.0), line->point), turn));
    return out;
}

/* The number of the joint that does not turn: the third in the order. */
static int ik_still_joint(int code)
{
    int place = (code % 12 / 2 + 2) % 6;
    return code >= 12 ? 5 - place : place;
}

/* The loop at a value of the swept variable, in an order: the other five, and the joint that does not turn. */
static ik_loop ik_swept_loop(const ik_swept *swept, double x, int code)
{
    ik_motion moved, step, goal;
    ik_line lines[6];
    int still = ik_still_joint(code), count = 0, i;
    for (i = 0; i < 3; i++) moved.rows[i] = ik_vector_of(i == 0 ? 1.0 : 0.0, i == 1 ? 1.0 : 0.0, i == 2 ? 1.0 : 0.0);
    moved.place = ik_vector_of(0.0, 0.0, 0.0);
    for (i = 0; i < 6; i++) lines[i] = swept->lines[0];
    for (i = 0; i < IK_MOST_LINES; i++) {
        double by = swept->ratios[i] * x;
        if (swept->kinds[i] == 1) {
            if (count == still) count++;
            lines[count++] = ik_line_moved(&moved, &swept->lines[i]);
        } else if (swept->kinds[i] == 2) {
            step = ik_turning(&swept->lines[i], ik_turn_by(by));
            moved = ik_after(&moved, &step);
        } else if (swept->kinds[i] == 3) {
            moved.place = ik_plus(ik_vector_moved(&moved, ik_scaled(swept->lines[i].direction, by)), moved.place);
        }
    }
    step = ik_inverse(&moved);
    goal = ik_after(&swept->goal, &step);
    return ik_arrange(lines, &goal, code);
}

/* The same, and the six equations; returns the square of a volume. */
static double ik_swept_at(const ik_swept *swept, double x, int code, ik_loop *loop, ik_six_rows *six)
{
    ik_shadow shadow;
    const ik_shadow *used = &swept->shadow;
    *loop = ik_swept_loop(swept, x, code);
    if (!swept->is_constant) {
        ik_shadow_of(loop->lines, &loop->goal, swept->origin, swept->scale, &shadow);
        used = &shadow;
    }
    ik_eliminate_still(loop->lines, loop->swapped, swept->origin, swept->scale, used, six);
    return used->volume;
}

static double ik_swept_value(const ik_swept *swept, double x, int code)
{
    ik_loop loop;
    ik_six_rows six;
    double volume = ik_swept_at(swept, x, code, &loop, &six), rows[36], sign = 1.0, factor, pivots, least = 1.0;
    factor = ik_reduced(&six, ik_turn_of(1.0, 0.0), rows, &least);
    pivots = ik_clear(rows, 6, 6, &sign, &least);
    return volume * (sign * factor * pivots);
}

/* The determinant on an interval of this width from `start` on. */
static void ik_piece_at(const ik_swept *swept, int code, const double table[4 * IK_NODES], double start, double width, ik_piece *piece)
{
    double samples[IK_NODES], half = 0.5 * width, centre = start + half;
    int k;
    for (k = 0; k < IK_NODES; k++) samples[k] = ik_swept_value(swept, centre + half * table[2 * k + 1], code);
    ik_piece_of(table, start, width, samples, piece);
}

/* Adds a candidate: the turns of the five in their order, then the swept variable. */
static void ik_add_swept(const ik_loop *loop, const ik_turn pair[2], double x, int is_turn, ik_candidates *found)
{
    ik_turn middle[3], turns[6], placed[6];
    int i, joint, still = loop->joints[2];
    middle[0] = ik_turn_of(1.0, 0.0);
    middle[1] = pair[loop->swapped ? 1 : 0];
    middle[2] = pair[loop->swapped ? 0 : 1];
    if (!ik_close(loop, middle, turns)) return;
    for (i = 0; i < 6; i++) {
        joint = loop->joints[i];
        if (joint != still) placed[joint > still ? joint - 1 : joint] = turns[i];
    }
    placed[5] = is_turn ? ik_turn_by(x) : ik_turn_of(x, 0.0);
    ik_add_turns(placed, found);
}

/* Adds the candidates of one interval; says whether its roots lie apart. They may be so far from real ones. */
static int ik_look_at_piece(const ik_swept *swept, int code, const double *table, const ik_piece *piece, double unreal, int zooms, ik_candidates *found)
{
    double roots[IK_SIZE][2], tight = 0.05 * piece->half, reach = 0.125 * piece->half, margin = IK_NEARLY_REAL + unreal;
    /* Seen from nearby roots are told apart that were one. */
    double together_at = tight < 3e-3 ? tight : 3e-3;
    int count = ik_roots_of_piece(piece, margin, reach > margin ? reach : margin, roots), done[IK_SIZE] = { 0 }, near[IK_SIZE];
    int apart = 1, together, pairs_found, all, alone, i, j;
    ik_turn still = ik_turn_of(1.0, 0.0), pairs[6][2];
    ik_loop loop;
    ik_six_rows six;
    ik_piece inner;
    /* Where the five others lose a freedom at some value, whatever the goal, the determinant has a root of a high order there, which hides
       others beside it: it is looked at alone. As many roots as always are none of a solution. */
    for (i = 0; i < 2; i++) {
        double place = swept->places[i][0], order = swept->places[i][1];
        if (!(order > 0.0) || zooms == 0 || !(ik_abs(place - piece->centre) <= piece->half + reach)) continue;
        together = 0;
        for (j = 0; j < count; j++)
            if (ik_abs(roots[j][0] - place) + ik_abs(roots[j][1]) < reach) {
                together++;
                done[j] = 1;
            }
        if (together != (int)order) {
            ik_piece_at(swept, code, table, place - reach, 2.0 * reach, &inner);
            apart &= ik_look_at_piece(swept, code, table, &inner, unreal, zooms - 1, found);
        }
    }
    for (i = 0; i < count; i++) {
        double centre = 0.0;
        together = 0;
        for (j = 0; j < count; j++) {
            near[j] = ik_abs(roots[j][0] - roots[i][0]) + ik_abs(roots[j][1] - roots[i][1]) < tight;
            if (!done[j] && near[j]) {
                together++;
                centre += roots[j][0];
            }
        }
        if (done[i] || ik_abs(roots[i][1]) > tight || together < 3 || zooms == 0) continue;
        for (j = 0; j < count; j++) done[j] |= near[j];
        ik_piece_at(swept, code, table, centre / (double)together - reach, 2.0 * reach, &inner);
        ik_look_at_piece(swept, code, table, &inner, unreal, zooms - 1, found);
        /* What lies so near to others may be clearer in another order. */
        apart = 0;
    }
    for (i = 0; i < count; i++) {
        double x = roots[i][0], imaginary = roots[i][1], sum = 0.0, mean, change;
        if (done[i] || ik_abs(imaginary) > margin) continue;
        together = 0;
        for (j = 0; j < count; j++) {
            near[j] = !done[j] && ik_abs(roots[j][1]) <= margin && ik_abs(roots[j][0] - x) + ik_abs(roots[j][1] - imaginary) < together_at;
            if (near[j]) {
                together++;
                sum += roots[j][0];
            }
        }
        alone = together == 1;
        if (together > 1) {
            /* Several solutions that share the value, or nearly do. */
            mean = sum / (double)together;
            /* Roots so far from their mean are looked at one by one too: a null space may seem to have as many vectors, and has not. */
            alone = ik_abs(x - mean) + ik_abs(imaginary) > 3e-4;
            ik_swept_at(swept, mean, code, &loop, &six);
            all = ik_several(&six, still, 1e-6, pairs, &pairs_found) == together;
            for (j = 0; j < pairs_found; j++) ik_add_swept(&loop, pairs[j], mean, swept->turns, found);
            if (all && !alone) {
                for (j = 0; j < count; j++) done[j] |= near[j];
                continue;
            }
            if (!all) {
                /* The middle of roots that others are near is good to few digits. */
                ik_several(&six, still, 1e-3, pairs, &pairs_found);
                for (j = 0; j < pairs_found; j++) ik_add_swept(&loop, pairs[j], mean, swept->turns, found);
                apart = 0;
            }
        }
        if (alone && !(ik_abs(imaginary) > 0.0)) {
            for (j = 0; j < 4; j++) {
                change = -ik_swept_value(swept, x, code) / ik_slope_of_piece(piece, x);
                if (!(ik_abs(change) < IK_NEARLY_REAL)) break;
                x += change;
                if (ik_abs(change) < 1e-12) break;
            }
        }
        ik_swept_at(swept, x, code, &loop, &six);
        if (ik_single(&six, still, pairs[0])) ik_add_swept(&loop, pairs[0], x, swept->turns, found);
        else apart = 0;
    }
    return apart;
}

/* Adds the candidates of one order, its code and one and its places; says whether they are all that there are. */
static int ik_sweep_order(ik_swept *swept, const double numbers[5], double low, double high, double slack, ik_candidates *found)
{
    double table[4 * IK_NODES], whole = high - low, at = low, width = whole / 16.0, before = 1.7976931348623157e308, rest;
    ik_piece piece;
    int code = ((int)numbers[0] - 1) % 24, all = 1, resolved, round;
    ik_cosines(table);
    for (round = 0; round < 4; round++) swept->places[round / 2][round % 2] = numbers[1 + round];
    swept->is_constant = swept->before == ik_still_joint(code);
    if (swept->is_constant) {
        ik_loop loop = ik_swept_loop(swept, 0.0, code);
        ik_shadow_of(loop.lines, &loop.goal, swept->origin, swept->scale, &swept->shadow);
    }
    for (round = 0; round < 200; round++) {
        ik_piece_at(swept, code, table, at, width, &piece);
        rest = ik_rest_of_piece(&piece);
        resolved = rest < 1e-9 * piece.largest;
        /* Half an interval that is no better than the whole one shows rounding. On an interval with a third on which the function is small
           everywhere roots may be lost in it. */
        if ((piece.even < 1e-3 && width > (1.0 / 512.0) * whole) || (!resolved && rest < 0.1 * before && width > (1.0 / 16384.0) * whole)) {
            before = rest;
            width *= 0.5;
            continue;
        }
        all &= ik_look_at_piece(swept, code, table, &piece, 5.0 * ik_sqrt(slack), 4, found) && resolved;
        at += width;
        if (at > high - (1.0 / 16384.0) * whole) return all;
        before = 1.7976931348623157e308;
        if (!resolved) width *= 2.0;
        else if (rest < 1e-3 * 1e-9 * piece.largest && piece.even > 30.0 * 1e-3) width *= 1.5;
        if (width > high - at) width = high - at;
    }
    return 0;
}

/* Candidates for the joints of a loop: the five unknown turns in order, then the swept variable, as cosine and sine or as a length. The
   numbers are, for each joint, the direction of its line, a point on it, how it moves and how far; rows of the goal's rotation, its place;
   three orders as their code and one, zero for none, each with two places and how many roots are there whatever the goal; and where the variable is looked for: zero for a length, one for an angle of which a
   full turn changes nothing, two for other angles. Slack is for poses at which that gave nothing, as in six joints. */
static void ik_sweep(const double numbers[100], double slack, ik_candidates *found)
{
    ik_swept swept;
    ik_line ends;
    ik_vector d;
    double low, high, sum = 0.0, ratio = 0.0;
    /* How many of the five come before the first swept joint and before the last one. */
    int unknown = 0, first = 6, last = 0, i;
    found->count = 0;
    for (i = 0; i < 100; i++)
        if (!ik_finite(numbers[i])) return;
    swept.origin = ik_half_of(&numbers[3]);
    for (i = 0; i < IK_MOST_LINES; i++) {
        const double *from = &numbers[8 * i];
        swept.lines[i].direction = ik_half_of(from);
        swept.lines[i].point = ik_half_of(from + 3);
        swept.kinds[i] = (int)from[6];
        swept.ratios[i] = from[7];
        unknown += swept.kinds[i] == 1;
        if (swept.kinds[i] > 1) {
            if (unknown < first) first = unknown;
            last = unknown;
        }
    }
    if (unknown != 5) return;
    swept.before = first == last ? first : -1;
    for (i = 0; i < 3; i++) swept.goal.rows[i] = ik_half_of(&numbers[72 + 3 * i]);
    swept.goal.place = ik_half_of(&numbers[81]);
    if (slack > 0.0) swept.goal = ik_nudged(&swept.goal, 0.1 * slack);
    swept.turns = numbers[99] > 0.0;
    low = -3.141592653589793;
    high = 3.141592653589793;
    if (swept.turns && numbers[99] < 2.0) {
        low = 0.2137 - 3.141592653589793;
        high = 0.2137 + 3.141592653589793;
    }
    /* How far a slide can go at most: the other joints reach no farther. */
    ends.direction = ends.point = swept.lines[0].point;
    for (i = 0; i < IK_MOST_LINES; i++) {
        if (swept.kinds[i] > 0) {
            d = ik_minus(swept.lines[i].point, ends.point);
            sum += ik_sqrt(ik_dot(d, d));
            ends.point = swept.lines[i].point;
        } else {
            swept.lines[i].point = swept.lines[0].point;
        }
        if (swept.kinds[i] == 3 && ik_abs(swept.ratios[i]) > ratio) ratio = ik_abs(swept.ratios[i]);
    }
    swept.scale = ik_scale_of(swept.lines, IK_MOST_LINES, swept.origin);
    if (!swept.turns) {
        ends = ik_line_moved(&swept.goal, &ends);
        d = ik_minus(ends.point, swept.lines[0].point);
        high = 1.01 * (sum + ik_sqrt(ik_dot(d, d))) / ratio;
        low = -high;
    }
    for (i = 84; i < 99; i += 5)
        if (numbers[i] >= 1.0 && ik_sweep_order(&swept, &numbers[i], low, high, slack, found) && !(slack > 0.0) && found->count > 0)
            break;
}

/* == as_given == */
/* Offers candidates of the general solver of six joints, on the chain as it is. */
static void ik_as_given(const ik_chain *chain, const ik_frame *pose, const double *given, const double orders[9], ik_sink *sink)
{
    ik_frame at = { { { 1.0, 0.0, 0.0 }, { 0.0, 1.0, 0.0 }, { 0.0, 0.0, 1.0 } }, { 0.0, 0.0, 0.0 } }, turn = at, next, goal;
    double numbers[57], held[IK_VARIABLES][2], values[IK_VARIABLES];
    const double misses[2] = { 1.0, 1.0 };
    ik_candidates found;
    int i, k, count = 0, taken = 0;
    for (i = 0; i < IK_VARIABLES; i++) values[i] = ik_held[i] ? given[taken++] : 0.0;
    for (i = 0; i < 57; i++) numbers[i] = i < 48 ? 0.0 : orders[i - 48];
    for (i = 0; i < IK_LINKS; i++) {
        ik_times(&at, &chain->links[i].previous_from_joint, &next);
        at = next;
        if (ik_held[i]) {
            ik_cos_sin(values[i], held[i]);
            turn.rotation[0][0] = turn.rotation[1][1] = held[i][0];
            turn.rotation[0][1] = -held[i][1];
            turn.rotation[1][0] = held[i][1];
            ik_times(&next, &turn, &at);
        } else if (count < 6) {
            for (k = 0; k < 3; k++) {
                numbers[6 * count + k] = at.rotation[k][2];
                numbers[6 * count + 3 + k] = at.position[k];
            }
            count++;
        }
    }
    ik_times(&at, &chain->last_from_tip, &next);
    for (i = 0; i < 3; i++) {
        for (k = 0; k < 3; k++) turn.rotation[i][k] = next.rotation[k][i];
        turn.position[i] = -(turn.rotation[i][0] * next.position[0] + turn.rotation[i][1] * next.position[1] + turn.rotation[i][2] * next.position[2]);
    }
    ik_times(pose, &turn, &goal);
    for (i = 0; i < 3; i++) {
        for (k = 0; k < 3; k++) numbers[36 + 3 * i + k] = goal.rotation[i][k];
        numbers[45 + i] = goal.position[i];
    }
    ik_six(numbers, 0.0, &found);
    sink->misses = 0;
    for (i = 0; i < found.count; i++) {
        double steps[IK_VARIABLES][2], own[IK_VARIABLES];
        taken = 0;
        for (k = 0; k < IK_VARIABLES; k++) {
            const ik_turn *next_turn = &found.turns[i][taken < 6 ? taken : 5];
            steps[k][0] = ik_held[k] ? held[k][0] : next_turn->c;
            steps[k][1] = ik_held[k] ? held[k][1] : next_turn->s;
            own[k] = values[k];
            if (!ik_held[k]) taken++;
        }
        ik_offer(sink, steps, own, misses);
    }
}
