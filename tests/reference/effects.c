/* Time integration for effects.py (which compiles this file and states the equations): the paper's rig on its contact, and an
   oscillator by itself, each from rest until the last cycles repeat.

   Trapezoidal rule throughout. contact(): in every step the slip rate at its end is the root of a scalar equation, zero where
   friction holds. alone(): where the velocity changes sign the step is split there; under dry friction the body then rests as
   long as the force on it is no more than that. out: cosine and sine parts over sin(w t), mean, change over the last cycle. */

#include <math.h>

static const double TWO_PI = 6.283185307179586476925;

#define POT 48
#define JOINT 200
#define BRUSH 1000

static double power(double x, double p) { return copysign(pow(fabs(x), p), x); }

/* Parts of the cycle that was summed, and the change against the one before in out[3]. */
static void finish(double *sum, long steps, double *out)
{
    double re = 2.0 * sum[0] / steps, im = 2.0 * sum[1] / steps;
    out[3] = hypot(re - out[0], im - out[1]) / hypot(re, im);
    out[0] = re;
    out[1] = im;
    out[2] = sum[2] / steps;
    sum[0] = sum[1] = sum[2] = 0.0;
}

static void tally(double *sum, double u, double phase)
{
    sum[0] += u * sin(phase);
    sum[1] += u * cos(phase);
    sum[2] += u;
}

/* ---------------------------------------------------------------- the paper's rig */

typedef struct {
    double J, C, K, re, im, b, kc, cc, mu, V, W, omega;
    double law, p1, p2, p3; /* friction: 1 Stribeck, 2 strengthening, 3 Grosch, 4 film, 5 a film and a hump (beyond.py) */
    double K2, K3, K5, D2, kn, k1, tau;
    double F_max, x_2;                 /* Berg's friction of the stretch */
    double relaxations, pot[2 * POT]; /* a spring-pot: stiffness and rate of each */
    double leave;                      /* rate at which bristles leave the contact: V over their travel */
    double P_0, tau_T;                 /* heat of friction */
    double a_s, B_s, v_s, D_c;         /* rate and state */
    double m_r, c_r, k_r;              /* the roller's surface, where m_r > 0 */
    double lugre, sigma_2;             /* an element of LuGre's in place of the slider */
    double elements, slip[BRUSH], share[BRUSH]; /* elements side by side: the stretch beyond which each slips, its part of kc and cc */
} rig;

static double friction(const rig *r, double s)
{
    switch ((int)r->law) {
    case 1: return r->mu + r->p1 * exp(-s / r->p2);
    case 2: return r->mu + r->p1 * log1p(s / r->p2);
    case 3: {
        double x = log10((s + 1e-9) / r->p2) / r->p3;
        return r->mu + r->p1 * exp(-0.5 * x * x);
    }
    case 4: return r->mu + r->p1 * s;
    case 5: {
        double x = (s - r->p2) / (0.5 * r->p2);
        return r->mu + r->p3 * s + r->p1 * exp(-x * x);
    }
    default: return r->mu;
    }
}

/* x_r, F_r, up: the last reversal of the stretch and the direction since; F_b: Berg's force; p: forces of the spring-pot. */
typedef struct {
    double th, w, a, x, d, q, x_r, F_r, up, F_b, p[POT];
    double s, psi, heat, T;       /* slip rate, age of the contact over D_c/v_s, power of friction, temperature */
    double y, yd, ya;             /* the roller's surface */
    double xs[BRUSH], ds[BRUSH]; /* elements side by side */
} state;

/* The coefficient of friction at the end of a step that ends with this slip rate and force; its own states go to n. */
static double coefficient(const rig *r, const state *z, state *n, double h, double s, double force)
{
    double mu = friction(r, s);
    n->s = s;
    if (r->D_c > 0.0) {
        n->psi = (z->psi + 0.5 * h * (2.0 - z->s * z->psi / r->D_c)) / (1.0 + 0.5 * h * s / r->D_c);
        mu += r->a_s * log1p(s / r->v_s) + r->B_s * log1p(r->v_s * n->psi / r->D_c);
    }
    if (r->P_0 > 0.0) {
        n->heat = fabs(force) * s / r->P_0;
        n->T = (z->T * (1.0 - 0.5 * h / r->tau_T) + 0.5 * h / r->tau_T * (z->heat + n->heat)) / (1.0 + 0.5 * h / r->tau_T);
        mu /= 1.0 + n->T;
    }
    return mu;
}

/* Force of elements side by side at a rate v of the surfaces, and its slope by that rate. */
static double brush(const rig *r, const state *z, state *n, double h, double v, double *slope)
{
    double sum = 0.0;
    *slope = 0.0;
    for (int i = 0; i < (int)r->elements; i++) {
        double k = r->kc * r->share[i], by = 0.5 * h * k + r->cc * r->share[i];
        double begun = k * (z->xs[i] + 0.5 * h * z->ds[i]), force = begun + by * v, most = k * r->slip[i];
        n->ds[i] = v;
        if (fabs(force) > most) {
            force = copysign(most, force);
            n->ds[i] = (force - begun) / by;
        } else
            *slope += by;
        n->xs[i] = z->xs[i] + 0.5 * h * (z->ds[i] + n->ds[i]);
        sum += force;
    }
    return sum;
}

/* Stretch rate behind a roller's surface that gives way under the force, and by how much less it follows the arm. */
static double yielding(const rig *r, const state *z, state *n, double h, double v, double *gain)
{
    double left = r->m_r + 0.5 * h * r->c_r + 0.25 * h * h * r->k_r, e = 0.5 * h / left;
    double begun = r->kc * (z->x + 0.5 * h * z->d), by = 0.5 * h * r->kc + r->cc;
    double yd = z->yd + 0.5 * h * z->ya, y = z->y + h * z->yd + 0.25 * h * h * z->ya;
    double d = (v + yd - e * (begun + r->c_r * yd + r->k_r * y)) / (1.0 + e * by);
    n->ya = (-(begun + by * d) - r->c_r * yd - r->k_r * y) / left;
    n->yd = yd + 0.5 * h * n->ya;
    n->y = y + 0.25 * h * h * n->ya;
    *gain = 1.0 / (1.0 + e * by);
    return d;
}

/* Berg's force at the end of a step, which begins with a reversal if the stretch turns back; returns its slope. */
static double berg(const rig *r, const state *z, state *n)
{
    double moved = n->x - z->x, turns = moved * z->up < 0.0;
    n->up = moved == 0.0 ? z->up : copysign(1.0, moved);
    n->x_r = turns ? z->x : z->x_r;
    n->F_r = turns ? z->F_b : z->F_r;
    double room = r->F_max - n->up * n->F_r, soft = r->x_2 * (1.0 - n->up * n->F_r / r->F_max);
    double from = n->x - n->x_r, over = soft + fabs(from);
    n->F_b = n->F_r + from / over * room;
    return room * soft / (over * over);
}

/* The end of a step at time t if the interface slips at rate s there; returns the force of the contact. */
static double step(const rig *r, const state *z, double t, double h, double s, state *n)
{
    double drive = r->re * sin(r->omega * t) + r->im * cos(r->omega * t), force = 0.0, a = z->a;
    double branch = r->k1 * 0.5 * h / (1.0 + 0.5 * h / r->tau), hysteresis = 0.0;
    for (int j = 0; j < (int)r->relaxations; j++) branch += r->pot[2 * j] * 0.5 * h / (1.0 + 0.5 * h * r->pot[2 * j + 1]);
    for (int i = 0; i < 30; i++) {
        n->w = z->w + 0.5 * h * (z->a + a);
        n->th = z->th + 0.5 * h * (z->w + n->w);
        double gain = 1.0, own = 0.0, v = r->V - r->b * n->w, kept = 1.0 + 0.5 * h * r->leave;
        n->d = r->m_r > 0.0 ? yielding(r, z, n, h, v - s, &gain) : v - s;
        n->x = (z->x * (2.0 - kept) + 0.5 * h * (z->d + n->d)) / kept;
        if (r->lugre > 0.0) {
            double rate = r->kc * fabs(v) / (r->mu * r->W);
            n->x = (z->x + 0.5 * h * (z->d + v)) / (1.0 + 0.5 * h * rate);
            n->d = v - rate * n->x;
            own = r->sigma_2 * v;
        }
        n->q = (z->q * (1.0 - 0.5 * h / r->tau) + r->k1 * 0.5 * h * (z->d + n->d)) / (1.0 + 0.5 * h / r->tau);
        force = r->kc * n->x + r->cc * n->d + n->q + own;
        for (int j = 0; j < (int)r->relaxations; j++) {
            double k = r->pot[2 * j], fade = 0.5 * h * r->pot[2 * j + 1];
            n->p[j] = (z->p[j] * (1.0 - fade) + k * 0.5 * h * (z->d + n->d)) / (1.0 + fade);
            force += n->p[j];
        }
        if (r->F_max > 0.0) {
            hysteresis = berg(r, z, n);
            force += n->F_b;
        }
        double follows = ((r->kc + hysteresis) * 0.5 * h / kept + r->cc + branch) * gain + r->sigma_2;
        if (r->elements > 0.0) force = brush(r, z, n, h, v, &follows);
        double y = n->th, y2 = y * y;
        double spring = r->K * y + r->K2 * y2 + r->K3 * y2 * y + r->K5 * y2 * y2 * y;
        double slope = r->K + 2.0 * r->K2 * y + 3.0 * r->K3 * y2 + 5.0 * r->K5 * y2 * y2;
        double left = r->J * a + r->C * n->w + spring + r->D2 * fabs(n->w) * n->w - drive - r->b * force;
        double by = r->J + 0.5 * h * (r->C + 2.0 * r->D2 * fabs(n->w)) + 0.25 * h * h * slope
                  + r->b * r->b * 0.5 * h * follows;
        double move = left / by;
        a -= move;
        if (fabs(move) <= 1e-13 * (fabs(a) + fabs(drive) / r->J)) break;
    }
    n->a = a;
    return force;
}

static double excess(const rig *r, const state *z, double t, double h, double sign, double s, state *n)
{
    double force = step(r, z, t, h, sign * s, n), load = r->W + r->kn * r->b * n->th;
    return sign * force - coefficient(r, z, n, h, s, force) * (load > 0.0 ? load : 0.0);
}

/* Sliding at the speed of the roller, before the drive begins; returns the force. */
static double sliding(const rig *r, state *z)
{
    double pull = friction(r, r->V) * r->W;
    if (r->D_c > 0.0) {
        z->s = r->V, z->psi = r->D_c / r->V;
        pull += (r->a_s * log1p(r->V / r->v_s) + r->B_s * log1p(r->v_s / r->V)) * r->W;
    }
    if (r->P_0 > 0.0) { /* F (1 + F V/P_0) = mu W */
        double hot = r->V / r->P_0;
        pull = (sqrt(1.0 + 4.0 * hot * pull) - 1.0) / (2.0 * hot);
        z->s = r->V, z->heat = z->T = pull * hot;
    }
    if (r->leave > 0.0 && r->kc * r->V / r->leave + r->cc * r->V < pull) { /* bristles leave before they slip */
        z->d = r->V;
        pull = r->kc * r->V / r->leave;
    }
    if (r->m_r > 0.0) z->y = -pull / r->k_r;
    if (r->lugre > 0.0) pull += r->sigma_2 * r->V;
    for (int i = 0; i < (int)r->elements; i++) z->xs[i] = r->slip[i];
    return pull;
}

void contact(const rig *r, long steps, long cycles, double *out)
{
    double h = TWO_PI / r->omega / steps, sum[3] = { 0.0, 0.0, 0.0 }, last = 0.0;
    static state z, n;
    z = n = (state){ 0 };
    if (r->V > 0.0) {
        double pull = sliding(r, &z);
        z.x = (pull - r->sigma_2 * r->V) / r->kc;
        for (int i = 0; i < 60; i++) { /* the deflection under it */
            double y = z.th, y2 = y * y;
            double left = r->K * y + r->K2 * y2 + r->K3 * y2 * y + r->K5 * y2 * y2 * y - r->b * pull;
            z.th -= left / (r->K + 2.0 * r->K2 * y + 3.0 * r->K3 * y2 + 5.0 * r->K5 * y2 * y2);
        }
    }
    if (r->F_max > 0.0) {
        z.up = 1.0;
        n.x = z.x, z.x = 0.0;
        berg(r, &z, &n);
        z.x = n.x, z.F_b = n.F_b;
    }
    z.a = r->im / r->J;
    for (long c = 0; c < cycles; c++) {
        for (long j = 0; j < steps; j++) {
            double t = h * (j + 1);
            double force = step(r, &z, t, h, 0.0, &n), load = r->W + r->kn * r->b * n.th;
            double holds = coefficient(r, &z, &n, h, 0.0, force) * (load > 0.0 ? load : 0.0);
            if (r->lugre == 0.0 && r->elements == 0.0 && r->W > 0.0 && fabs(force) > holds) {
                double sign = force > 0.0 ? 1.0 : -1.0;
                double low = 0.0, high = fabs(last) + 1e-9, f_low = excess(r, &z, t, h, sign, 0.0, &n), f_high;
                while ((f_high = excess(r, &z, t, h, sign, high, &n)) > 0.0) {
                    low = high, f_low = f_high;
                    high *= 2.0;
                }
                for (int i = 0; i < 80; i++) { /* regula falsi, Illinois */
                    double s = (low * f_high - high * f_low) / (f_high - f_low);
                    double f = excess(r, &z, t, h, sign, s, &n);
                    if (fabs(f) < 1e-13 * fabs(force) || fabs(high - low) < 1e-15 * high) break;
                    if (f > 0.0) { low = s, f_low = f, f_high *= 0.5; } else { high = s, f_high = f, f_low *= 0.5; }
                    last = s;
                }
            }
            z = n;
            tally(sum, z.th, r->omega * t);
        }
        finish(sum, steps, out);
    }
}

/* ---------------------------------------------------------------- an oscillator by itself */

typedef struct {
    double M, C, K, f, omega, K2, K3, K5, kg, g, D, v0, p, Fc;
    double elements, k_e, slip[JOINT]; /* a joint: elements of one stiffness, each slips beyond its own stretch */
} oscillator;

/* Force of the joint's elements after the body has moved on; their own forces then go to `n` where that is wanted. */
static double joint(const oscillator *o, const double *e, double moved, double *n)
{
    double sum = 0.0;
    for (int i = 0; i < (int)o->elements; i++) {
        double most = o->k_e * o->slip[i], force = e[i] + o->k_e * moved;
        force = force > most ? most : force < -most ? -most : force;
        if (n) n[i] = force;
        sum += force;
    }
    return sum;
}

/* Force of everything but what opposes the velocity by a law of its own. */
static double pull(const oscillator *o, double t, double x, double v)
{
    double x2 = x * x, beyond = fabs(x) - o->g;
    double force = o->f * sin(o->omega * t) - o->K * x - o->C * v - o->K2 * x2 - o->K3 * x2 * x - o->K5 * x2 * x2 * x;
    if (o->kg > 0.0 && beyond > 0.0) force -= o->kg * copysign(beyond, x);
    return force;
}

static double held(const oscillator *o, double v, double sign)
{
    double force = o->Fc * sign;
    if (o->D > 0.0 && o->p > 0.0) force += o->D * power(v / o->v0, o->p);
    return force;
}

/* Velocity at the end of a step of length h: monotone, by regula falsi. `sign`: that of dry friction. */
static double moved(const oscillator *o, const double *e, double t, double h, double x, double v, double sign)
{
    double now = pull(o, t, x, v) - held(o, v, sign) - joint(o, e, 0.0, 0), low, high, f_low, f_high, wide;
#define LEFT(u) (o->M * ((u) - v) - 0.5 * h * (now + pull(o, t + h, x + 0.5 * h * (v + (u)), (u)) - held(o, (u), sign) \
                                               - joint(o, e, 0.5 * h * (v + (u)), 0)))
    wide = h * fabs(now) / o->M + h * (o->f + o->Fc + o->D) / o->M + 1e-30;
    low = v - wide, high = v + wide;
    while ((f_low = LEFT(low)) > 0.0) low -= wide, wide *= 2.0;
    while ((f_high = LEFT(high)) < 0.0) high += wide, wide *= 2.0;
    for (int i = 0; i < 200; i++) {
        double u = i % 8 == 7 ? 0.5 * (low + high) : (low * f_high - high * f_low) / (f_high - f_low);
        if (!(u > low && u < high)) u = 0.5 * (low + high);
        double f = LEFT(u);
        if (f == 0.0 || high - low <= 1e-15 * (fabs(u) + fabs(v))) return u;
        if (f < 0.0) { low = u, f_low = f, f_high *= 0.5; } else { high = u, f_high = f, f_low *= 0.5; }
        if (fabs(f) < 1e-15 * o->M * (fabs(u) + fabs(v))) return u;
    }
    return 0.5 * (low + high);
#undef LEFT
}

void alone(const oscillator *o, long steps, long cycles, double *out)
{
    double h = TWO_PI / o->omega / steps, sum[3] = { 0.0, 0.0, 0.0 }, x = 0.0, v = 0.0, sign = 0.0, e[JOINT] = { 0.0 };
    for (long c = 0; c < cycles; c++) {
        for (long j = 0; j < steps; j++) {
            double t = h * j, left = h;
            for (int part = 0; part < 4 && left > 0.0; part++) {
                if (v == 0.0) {
                    double force = pull(o, t, x, 0.0) - joint(o, e, 0.0, 0);
                    if (fabs(force) <= o->Fc) break;
                    sign = force > 0.0 ? 1.0 : -1.0;
                }
                double u = moved(o, e, t, left, x, v, sign), took = left;
                if (o->Fc > 0.0 && v != 0.0 && u * v < 0.0) { /* split where it comes to rest */
                    double from = 0.0, to = left, f_from = v, f_to = u;
                    for (int i = 0; i < 60 && to - from > 1e-14 * h; i++) {
                        took = from + (to - from) * f_from / (f_from - f_to);
                        u = moved(o, e, t, took, x, v, sign);
                        if (u * v > 0.0) { from = took, f_from = u, f_to *= 0.5; } else { to = took, f_to = u, f_from *= 0.5; }
                        if (fabs(u) < 1e-13 * fabs(v)) break;
                    }
                    u = 0.0;
                }
                joint(o, e, 0.5 * took * (v + u), e);
                x += 0.5 * took * (v + u);
                v = u;
                t += took;
                left -= took;
            }
            tally(sum, x, h * (j + 1) * o->omega);
        }
        finish(sum, steps, out);
    }
}
