/* Time integration of one driven mode, for oscillators.py (which compiles this file and states the equations).

   Dimensionless: time t counts 1/w0, u is displacement over a length X0,

       u'' + u'/Q + u + kappa u^3 + d |u'| u' + sum_i k_i clip(u - z_i, -y_i, y_i) + s(u) = p cos(W t)

   z_i is where slider i holds: it stays while |u - z_i| <= y_i and is dragged along otherwise. s(u) is a spring from outside
   the program's catalogue, law 0 to 4: none; a stop b max(0, u - s) on one side; b (s sinh(u/s) - u); b s tanh(u/s); one whose
   stiffness is a sawtooth of |u|, from -b/2 up to b/2 over every s. Law 5 is no spring but a damping with a hump,
   b exp(-((|u| - s)/(s/3))^2) u'. Laws 6 to 9 are of the catalogue: b max(0, |u| - s) to either side; b u^5; b u^2; and the
   damping b |u'|^s sign(u').

   Method: the linear damped oscillator is propagated exactly by its matrix exponential; the drive and everything
   nonlinear enter through the classical fourth-order Runge-Kutta rule in the variables that the exponential leaves
   (Lawson 1967). Errors are therefore relative to the small terms and do not grow with Q. A slider is
   committed at the end of a step, and first at the turning point where the velocity changes sign within it. */

#include <math.h>
#include <stdlib.h>

typedef struct { double Q, kappa, d, p, W; int m; const double *k, *y; double *z; int law; double b, s; } mode;

static double joint(const mode *o, double u)
{
    double sum[4] = { 0.0 }; /* four at a time, for speed; m is a multiple of four, filled up with k = 0 */
    for (int i = 0; i < o->m; i += 4)
        for (int j = 0; j < 4; j++) {
            double e = u - o->z[i + j], y = o->y[i + j];
            e = e > y ? y : e;
            e = e < -y ? -y : e;
            sum[j] += o->k[i + j] * e;
        }
    return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

static void drag(const mode *o, double u)
{
    for (int i = 0; i < o->m; i++) {
        double e = u - o->z[i], y = o->y[i];
        e = e > y ? y : e;
        e = e < -y ? -y : e;
        o->z[i] = u - e;
    }
}

static double spring(const mode *o, double u)
{
    switch (o->law) {
    case 1: return u > o->s ? o->b * (u - o->s) : 0.0;
    case 2: return o->b * (o->s * sinh(u / o->s) - u);
    case 3: return o->b * o->s * tanh(u / o->s);
    case 4: {
        double x = fabs(u) / o->s, part = x - floor(x);
        return copysign(0.5 * o->b * o->s * (part * part - part), u);
    }
    case 6: return fabs(u) > o->s ? copysign(o->b * (fabs(u) - o->s), u) : 0.0;
    case 7: return o->b * u * u * u * u * u;
    case 8: return o->b * u * u;
    default: return 0.0;
    }
}

static double loss(const mode *o, double u, double v)
{
    double x = 3.0 * (fabs(u) / o->s - 1.0);
    switch (o->law) {
    case 5: return o->b * exp(-x * x) * v;
    case 9: return copysign(o->b * pow(fabs(v), o->s), v);
    default: return 0.0;
    }
}

/* drive minus everything that is not the linear oscillator */
static double rest(const mode *o, double u, double v, double drive)
{
    return drive - o->kappa * u * u * u - o->d * fabs(v) * v - joint(o, u) - spring(o, u) - loss(o, u, v);
}

/* exp(A h) of A = [[0, 1], [-1, -1/Q]], Q > 1/2, row by row */
static void propagator(double Q, double h, double e[4])
{
    double a = 0.5 / Q, w = sqrt(1.0 - a * a), x = exp(-a * h), c = cos(w * h), s = sin(w * h);
    e[0] = x * (c + a / w * s);
    e[1] = x * s / w;
    e[2] = -x * s / w;
    e[3] = x * (c - a / w * s);
}

/* Runs whole drive periods from phase 0 of the drive. par: Q, kappa, d, p, W, law, b, s. state: u, u', z_1..z_m (replaced by the end state).
   out, of the last period: 2/N sum u cos, 2/N sum u sin, largest |u|. */
void run(const double *par, int m, const double *k, const double *y, double *state, long cycles, int steps, double *out)
{
    mode o = { par[0], par[1], par[2], par[3], par[4], m, k, y, state + 2, (int)par[5], par[6], par[7] };
    const double two_pi = 6.283185307179586476925;
    double h = two_pi / o.W / steps, half[4], full[4];
    propagator(o.Q, 0.5 * h, half);
    propagator(o.Q, h, full);
    double *wave = malloc((2 * steps + 1) * sizeof *wave); /* cosine at the steps and half way */
    for (int j = 0; j <= 2 * steps; j++) wave[j] = cos(two_pi * j / (2 * steps));
    double u = state[0], v = state[1];
    for (long c = 0; c < cycles; c++) {
        double sc = 0.0, ss = 0.0, top = 0.0;
        for (int j = 0; j < steps; j++) {
            double f0 = o.p * wave[2 * j], f1 = o.p * wave[2 * j + 1], f2 = o.p * wave[2 * j + 2];
            if (c == cycles - 1) {
                sc += u * wave[2 * j];
                ss += u * sin(two_pi * j / steps);
                if (fabs(u) > top) top = fabs(u);
            }
            double k1 = rest(&o, u, v, f0);
            double hu = half[0] * u + half[1] * v, hv = half[2] * u + half[3] * v;
            double k2 = rest(&o, hu + half[1] * 0.5 * h * k1, hv + half[3] * 0.5 * h * k1, f1);
            double k3 = rest(&o, hu, hv + 0.5 * h * k2, f1);
            double fu = full[0] * u + full[1] * v, fv = full[2] * u + full[3] * v;
            double k4 = rest(&o, fu + half[1] * h * k3, fv + half[3] * h * k3, f2);
            double nu = fu + h / 6.0 * (full[1] * k1 + 2.0 * half[1] * (k2 + k3));
            double nv = fv + h / 6.0 * (full[3] * k1 + 2.0 * half[3] * (k2 + k3) + k4);
            if (m > 0) {
                if (v * nv < 0.0) drag(&o, u + 0.5 * h * v * v / (v - nv));
                drag(&o, nu);
            }
            u = nu;
            v = nv;
        }
        out[0] = 2.0 * sc / steps;
        out[1] = 2.0 * ss / steps;
        out[2] = top;
    }
    free(wave);
    state[0] = u;
    state[1] = v;
}

/* The sliders alone, moved along path: the force after each point of it (for checks against closed forms). */
void follow(int m, const double *k, const double *y, double *z, long n, const double *path, double *force)
{
    mode o = { 1.0, 0.0, 0.0, 0.0, 1.0, m, k, y, z, 0, 0.0, 1.0 };
    for (long i = 0; i < n; i++) {
        drag(&o, path[i]);
        force[i] = joint(&o, path[i]);
    }
}

/* The linear mode with a second one on it, mass mu times the first, frequency a and quality factor b by itself:

       u'' + u'/Q + u + mu [a^2 (u - q) + a/b (u' - q')] = p cos(W t),   q'' + a/b (q' - u') + a^2 (q - u) = 0

   The same method, each mode by its own exponential, the coupling by the Runge-Kutta rule in both. par: Q, mu, a, b, p, W.
   state: u, u', q, q'. out as above. */
static void pair_rest(const double *par, const double *x, double drive, double *r)
{
    double mu = par[1], a = par[2], c = par[2] / par[3];
    r[0] = drive - mu * (a * a * (x[0] - x[2]) + c * (x[1] - x[3]));
    r[1] = a * a * x[0] + c * x[1];
}

/* x moved by the exponentials, for a unit of time of the second mode of 1/a */
static void pair_move(const double *e, const double *g, double a, const double *x, double *y)
{
    y[0] = e[0] * x[0] + e[1] * x[1];
    y[1] = e[2] * x[0] + e[3] * x[1];
    y[2] = g[0] * x[2] + g[1] / a * x[3];
    y[3] = g[2] * a * x[2] + g[3] * x[3];
}

void run_pair(const double *par, double *x, long cycles, int steps, double *out)
{
    const double two_pi = 6.283185307179586476925;
    double a = par[2], p = par[4], h = two_pi / par[5] / steps, e[2][4], g[2][4];
    for (int i = 0; i < 2; i++) {
        propagator(par[0], (i + 1) * 0.5 * h, e[i]);
        propagator(par[3], (i + 1) * 0.5 * h * a, g[i]);
    }
    for (long c = 0; c < cycles; c++) {
        double sc = 0.0, ss = 0.0, top = 0.0;
        for (int j = 0; j < steps; j++) {
            double t = two_pi * j / steps, dt = two_pi / steps, r[4][2], y[4], z[4], at_half[4], at_full[4];
            sc += x[0] * cos(t);
            ss += x[0] * sin(t);
            if (fabs(x[0]) > top) top = fabs(x[0]);
            pair_move(e[0], g[0], a, x, at_half);
            pair_move(e[1], g[1], a, x, at_full);
            pair_rest(par, x, p * cos(t), r[0]);
            double kick[4] = { 0.0, r[0][0], 0.0, r[0][1] };
            pair_move(e[0], g[0], a, kick, y);
            for (int i = 0; i < 4; i++) z[i] = at_half[i] + 0.5 * h * y[i];
            pair_rest(par, z, p * cos(t + 0.5 * dt), r[1]);
            for (int i = 0; i < 4; i++) z[i] = at_half[i];
            z[1] += 0.5 * h * r[1][0];
            z[3] += 0.5 * h * r[1][1];
            pair_rest(par, z, p * cos(t + 0.5 * dt), r[2]);
            double late[4] = { 0.0, r[2][0], 0.0, r[2][1] };
            pair_move(e[0], g[0], a, late, y);
            for (int i = 0; i < 4; i++) z[i] = at_full[i] + h * y[i];
            pair_rest(par, z, p * cos(t + dt), r[3]);
            double middle[4] = { 0.0, r[1][0] + r[2][0], 0.0, r[1][1] + r[2][1] };
            pair_move(e[1], g[1], a, kick, y);
            for (int i = 0; i < 4; i++) z[i] = at_full[i] + h / 6.0 * y[i];
            pair_move(e[0], g[0], a, middle, y);
            for (int i = 0; i < 4; i++) x[i] = z[i] + h / 3.0 * y[i];
            x[1] += h / 6.0 * r[3][0];
            x[3] += h / 6.0 * r[3][1];
        }
        out[0] = 2.0 * sc / steps;
        out[1] = 2.0 * ss / steps;
        out[2] = top;
    }
}
