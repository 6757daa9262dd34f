#include "plate_theory.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>

// ---- sheets ----

// x = span / 2 a solves sinh( x ) / x = 1 / span, whose left side rises.
static double catenary_of( double span )
{
    double lower = 1e-9, upper = 1.0;
    while ( sinh( upper ) / upper < 1.0 / span )
    {
        upper *= 2.0;
    }
    for ( int i = 0; i < 100; ++i )
    {
        const double middle = 0.5 * ( lower + upper );
        *( sinh( middle ) / middle < 1.0 / span ? &lower : &upper ) = middle;
    }
    return span / ( lower + upper );
}

// The length from the lowest point is a sinh( x / a ), and there y = sqrt( a^2 + length^2 ).
void sheet_catenary( double span, double s, double out[2] )
{
    const double a = catenary_of( span );
    out[0] = a * asinh( ( s - 0.5 ) / a );
    out[1] = hypot( a, s - 0.5 ) - hypot( a, 0.5 );
}

double sheet_slide( double gravity, double angle, double friction )
{
    return gravity * fmax( 0.0, sin( angle ) - friction * cos( angle ) );
}

// T( pi ) = light e^(pi mu) + 2 mu R ( 1 + e^(pi mu) ) / ( 1 + mu^2 ) rises with mu.
double sheet_capstan( double light, double heavy, double radius )
{
    const double pi = acos( -1.0 );
    double lower = 0.0, upper = log( heavy / light ) / pi;
    for ( int i = 0; i < 60; ++i )
    {
        const double mu = 0.5 * ( lower + upper ), gain = exp( pi * mu );
        const double held = light * gain + 2.0 * mu * radius * ( 1.0 + gain ) / ( 1.0 + mu * mu );
        *( held < heavy ? &lower : &upper ) = mu;
    }
    return 0.5 * ( lower + upper );
}

double sheet_terminal_speed( double force, double air_density, double drag_coefficient, double area )
{
    return sqrt( 2.0 * force / ( air_density * drag_coefficient * area ) );
}

double sheet_fall_speed( double terminal, double acceleration, double time )
{
    return terminal * tanh( acceleration * time / terminal );
}

double sheet_bending_length( double rigidity, double weight )
{
    return cbrt( rigidity / weight );
}

double sheet_cusick( double length, double shear )
{
    return 35.6 * length - 3.61 * length * length - 2.59 * shear + 0.0461 * shear * shear + 17.0;
}

double sheet_cusick_softest( void )
{
    return 2.59 / ( 2.0 * 0.0461 );
}

// ---- plates ----

enum
{
    NODES =
        36, // of quadrature in each direction: exact for polynomials up to degree 71, and products have 64 at most
    TERMS = PLATE_THEORY_MAX_DEGREE + 1,
    PLANE_DEGREE =
        13, // of plate_theory_load(), where loads have settled to 0.1 % from W = L / 20 to 2 L: see the test
    ALONG = 16,
    ACROSS = 7,
};

static const double PI = 3.14159265358979323846;

// A polynomial at a point, with its derivatives.
typedef struct jet
{
    double f, f1, f2;
} jet;

static jet jet_multiply( jet a, jet b )
{
    return ( jet ){ a.f * b.f, a.f1 * b.f + a.f * b.f1, a.f2 * b.f + 2.0 * a.f1 * b.f1 + a.f * b.f2 };
}

// Legendre polynomials up to a degree, of t in [-1, 1], differentiated by s with t = rate s + const.
static void legendre( double t, double rate, int degree, jet* out )
{
    const jet x = { t, rate, 0.0 };
    out[0] = ( jet ){ 1.0, 0.0, 0.0 };
    out[1] = x;
    for ( int n = 1; n < degree; ++n )
    {
        const jet next = jet_multiply( x, out[n] );
        const double a = ( 2.0 * n + 1.0 ) / ( n + 1.0 ), b = n / ( n + 1.0 );
        out[n + 1] = ( jet ){ a * next.f - b * out[n - 1].f, a * next.f1 - b * out[n - 1].f1,
                              a * next.f2 - b * out[n - 1].f2 };
    }
}

// Points and weights of Gauss on [-1, 1]: the roots of the Legendre polynomial, by Newton's method.
static void gauss( double point[NODES], double weight[NODES] )
{
    for ( int i = 0; i < NODES; ++i )
    {
        jet p[NODES + 1];
        double t = cos( PI * ( i + 0.75 ) / ( NODES + 0.5 ) );
        for ( int n = 0; n < 10; ++n )
        {
            legendre( t, 1.0, NODES, p );
            t -= p[NODES].f / p[NODES].f1;
        }
        legendre( t, 1.0, NODES, p );
        point[i] = t;
        weight[i] = 2.0 / ( ( 1.0 - t * t ) * p[NODES].f1 * p[NODES].f1 );
    }
}

// Call a function at all points of quadrature of a plate.
typedef void visit_fn( void* context, double x, double y, double weight );

static void visit( double width, visit_fn* function, void* context )
{
    double point[NODES], weight[NODES];
    gauss( point, weight );
    for ( int i = 0; i < NODES * NODES; ++i )
    {
        const int n = i / NODES, m = i % NODES;
        function( context, 0.5 * ( 1.0 + point[n] ), 0.5 * width * point[m], 0.25 * width * weight[n] * weight[m] );
    }
}

// Factor a symmetric matrix, of which the lower part is read, into L L' in place. @return whether it is positive definite
static bool cholesky( double* a, int n )
{
    for ( int j = 0; j < n; ++j )
    {
        for ( int i = j; i < n; ++i )
        {
            double sum = a[i * n + j];
            for ( int k = 0; k < j; ++k )
            {
                sum -= a[i * n + k] * a[j * n + k];
            }
            if ( i == j && !( sum > 0.0 ) )
            {
                return false;
            }
            a[i * n + j] = i == j ? sqrt( sum ) : sum / a[j * n + j];
        }
    }
    return true;
}

static void solve_factored( const double* l, int n, double* x )
{
    for ( int i = 0; i < n; ++i )
    {
        for ( int k = 0; k < i; ++k )
        {
            x[i] -= l[i * n + k] * x[k];
        }
        x[i] /= l[i * n + i];
    }
    for ( int i = n - 1; i >= 0; --i )
    {
        for ( int k = i + 1; k < n; ++k )
        {
            x[i] -= l[k * n + i] * x[k];
        }
        x[i] /= l[i * n + i];
    }
}

// ---- deflections ----

typedef struct bending
{
    const plate_theory_plate* plate;
    plate_theory_field* forces;
    const void* context;
    int count;                 // of deflections
    double *stiff, *geometric; // [count][count] D times the first and the second form of the energy
} bending;

// Factors of the deflections along each direction.
static void deflections_at( const plate_theory_plate* plate, double x, double y, jet along[TERMS], jet across[TERMS] )
{
    const bool is_clamped = plate->support == PLATE_CLAMPED_AT_ONE_END;
    const double half = 0.5 * plate->width;
    const jet hold_x = is_clamped ? ( jet ){ x * x, 2.0 * x, 2.0 } : ( jet ){ x * ( 1.0 - x ), 1.0 - 2.0 * x, -2.0 };
    const jet hold_y =
        is_clamped ? ( jet ){ 1.0, 0.0, 0.0 }
                   : ( jet ){ 1.0 - y * y / ( half * half ), -2.0 * y / ( half * half ), -2.0 / ( half * half ) };
    legendre( 2.0 * x - 1.0, 2.0, plate->along, along );
    legendre( y / half, 1.0 / half, plate->across, across );
    for ( int i = 0; i <= plate->along; ++i )
    {
        along[i] = jet_multiply( hold_x, along[i] );
    }
    for ( int i = 0; i <= plate->across; ++i )
    {
        across[i] = jet_multiply( hold_y, across[i] );
    }
}

static void add_deflections( void* context, double x, double y, double weight )
{
    bending* b = context;
    const int terms = b->plate->across + 1;
    const double nu = b->plate->poisson;
    const plate_theory_forces n = b->forces( b->context, x, y );
    jet along[TERMS], across[TERMS];
    deflections_at( b->plate, x, y, along, across );
    for ( int i = 0; i < b->count; ++i )
    {
        const jet p = along[i / terms], q = across[i % terms];
        const double wx = p.f1 * q.f, wy = p.f * q.f1, wxx = p.f2 * q.f, wyy = p.f * q.f2, wxy = p.f1 * q.f1;
        // moments and forces across the plate of this deflection
        const double mx = wxx + nu * wyy, my = wyy + nu * wxx, mxy = 2.0 * ( 1.0 - nu ) * wxy;
        const double tx = n.xx * wx + n.xy * wy, ty = n.xy * wx + n.yy * wy;
        for ( int j = 0; j <= i; ++j )
        {
            const jet r = along[j / terms], s = across[j % terms];
            b->stiff[i * b->count + j] += weight * ( mx * r.f2 * s.f + my * r.f * s.f2 + mxy * r.f1 * s.f1 );
            b->geometric[i * b->count + j] += weight * ( tx * r.f1 * s.f + ty * r.f * s.f1 );
        }
    }
}

// Whether the energy of all deflections is positive under a factor of the forces.
static bool is_stable( const bending* b, double factor, double* scratch )
{
    for ( int i = 0; i < b->count * b->count; ++i )
    {
        scratch[i] = b->stiff[i] + factor * b->geometric[i];
    }
    return cholesky( scratch, b->count );
}

static double find_factor( const bending* b, double* scratch )
{
    const double most = 1e6;
    double lower = 0.0, upper = 1.0;
    while ( upper < most && is_stable( b, upper, scratch ) )
    {
        lower = upper;
        upper *= 2.0;
    }
    for ( int i = 0; i < 45 && upper < most; ++i )
    {
        const double middle = 0.5 * ( lower + upper );
        *( is_stable( b, middle, scratch ) ? &lower : &upper ) = middle;
    }
    return upper < most ? 0.5 * ( lower + upper ) : INFINITY;
}

double plate_theory_factor( const plate_theory_plate* plate, plate_theory_field* forces, const void* context )
{
    bending b = { .plate = plate, .forces = forces, .context = context };
    b.count = ( plate->along + 1 ) * ( plate->across + 1 );
    const size_t entries = (size_t)b.count * (size_t)b.count;
    assert( plate->along >= 1 && plate->along < TERMS && plate->across >= 1 && plate->across < TERMS );
    double* room = calloc( 3 * entries, sizeof( double ) );
    if ( room == NULL )
    {
        return NAN;
    }
    b.stiff = room;
    b.geometric = room + entries;
    visit( plate->width, add_deflections, &b );
    const double factor = find_factor( &b, room + 2 * entries );
    free( room );
    return factor;
}

// ---- forces in the plane ----

struct plate_theory_weight
{
    double width;
    plate_theory_membrane membrane;
    bool is_sideways;
    int degree, count;       // count: of displacements, first all along x, then all along y
    double *stiff, *amounts; // [count][count], [count]
};

plate_theory_membrane plate_theory_isotropic( double poisson )
{
    return ( plate_theory_membrane ){ 1.0 / ( 1.0 - poisson * poisson ), poisson / ( 1.0 - poisson * poisson ),
                                      0.5 / ( 1.0 + poisson ) };
}

typedef struct strain
{
    double xx, yy, xy; // xy: the angle
} strain;

// Strains of all displacements at a point, and the displacements. They are x times Legendre polynomials: 0 at the clamp.
static void displacements_at( const plate_theory_weight* w, double x, double y, strain* strains, double* values )
{
    const int terms = w->degree + 1, half_count = terms * terms;
    const jet hold = { x, 1.0, 0.0 };
    jet along[TERMS], across[TERMS];
    legendre( 2.0 * x - 1.0, 2.0, w->degree, along );
    legendre( 2.0 * y / w->width, 2.0 / w->width, w->degree, across );
    for ( int i = 0; i < half_count; ++i )
    {
        const jet p = jet_multiply( hold, along[i / terms] ), q = across[i % terms];
        strains[i] = ( strain ){ p.f1 * q.f, 0.0, p.f * q.f1 };
        strains[half_count + i] = ( strain ){ 0.0, p.f * q.f1, p.f1 * q.f };
        values[i] = p.f * q.f;
    }
}

static plate_theory_forces forces_of( plate_theory_membrane m, strain e )
{
    return ( plate_theory_forces ){ m.along * e.xx + m.cross * e.yy, m.cross * e.xx + m.along * e.yy,
                                    m.shear * e.xy };
}

static void add_displacements( void* context, double x, double y, double weight )
{
    plate_theory_weight* w = context;
    strain strains[2 * TERMS * TERMS];
    double values[TERMS * TERMS];
    displacements_at( w, x, y, strains, values );
    for ( int i = 0; i < w->count; ++i )
    {
        const plate_theory_forces n = forces_of( w->membrane, strains[i] );
        for ( int j = 0; j <= i; ++j )
        {
            const strain e = strains[j];
            w->stiff[i * w->count + j] += weight * ( n.xx * e.xx + n.yy * e.yy + n.xy * e.xy );
        }
    }
    const int first = w->is_sideways ? w->count / 2 : 0;
    for ( int i = 0; i < w->count / 2; ++i )
    {
        w->amounts[first + i] -= weight * values[i];
    }
}

plate_theory_weight* plate_theory_weigh( double width, plate_theory_membrane membrane, bool is_sideways, int degree )
{
    assert( degree >= 1 && degree < TERMS );
    plate_theory_weight* w = calloc( 1, sizeof *w );
    if ( w == NULL )
    {
        return NULL;
    }
    w->width = width;
    w->membrane = membrane;
    w->is_sideways = is_sideways;
    w->degree = degree;
    w->count = 2 * ( degree + 1 ) * ( degree + 1 );
    w->stiff = calloc( (size_t)w->count * (size_t)w->count, sizeof( double ) );
    w->amounts = calloc( (size_t)w->count, sizeof( double ) );
    const bool has_room = w->stiff != NULL && w->amounts != NULL;
    if ( has_room )
    {
        visit( width, add_displacements, w );
    }
    if ( !has_room || !cholesky( w->stiff, w->count ) )
    {
        plate_theory_destroy( w );
        return NULL;
    }
    solve_factored( w->stiff, w->count, w->amounts );
    free( w->stiff );
    w->stiff = NULL;
    return w;
}

void plate_theory_destroy( plate_theory_weight* w )
{
    if ( w != NULL )
    {
        free( w->stiff );
        free( w->amounts );
        free( w );
    }
}

plate_theory_forces plate_theory_weight_forces( const void* context, double x, double y )
{
    const plate_theory_weight* w = context;
    strain strains[2 * TERMS * TERMS], sum = { 0.0, 0.0, 0.0 };
    double values[TERMS * TERMS];
    displacements_at( w, x, y, strains, values );
    for ( int i = 0; i < w->count; ++i )
    {
        sum.xx += w->amounts[i] * strains[i].xx;
        sum.yy += w->amounts[i] * strains[i].yy;
        sum.xy += w->amounts[i] * strains[i].xy;
    }
    return forces_of( w->membrane, sum );
}

double plate_theory_load( double width, double poisson, plate_theory_membrane membrane, bool is_sideways )
{
    const plate_theory_plate plate = { PLATE_CLAMPED_AT_ONE_END, width, poisson, ALONG, ACROSS };
    plate_theory_weight* weight = plate_theory_weigh( width, membrane, is_sideways, PLANE_DEGREE );
    const double load =
        weight != NULL ? plate_theory_factor( &plate, plate_theory_weight_forces, weight ) : (double)NAN;
    plate_theory_destroy( weight );
    return load;
}
