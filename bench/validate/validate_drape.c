// Cusick's test: round specimens of named fabrics between two discs, each fabric on two meshes, all in one world.
#include "validate/validate.h"

#include "validate/validate_bodies.h"

#include "oracle/plate_theory.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

// ---- discs ----

enum
{
    MAX_CIRCLES = 34,
    PIXELS = 1024, // along a side of the shadow
};

// ---- the mesh ----

// Circles from the inside, with their vertices one after another.
typedef struct disc_circles
{
    int count;
    int first[MAX_CIRCLES + 1];
    double radius[MAX_CIRCLES], phase[MAX_CIRCLES]; // the phase in parts of a cell
} disc_circles;

static disc_circles lay_circles( double clamp, double border, int cells, double turn )
{
    const double cell = ( border - clamp ) / cells;
    disc_circles c = { .count = cells + 2 };
    for ( int k = 0; k < c.count; ++k )
    {
        // multiples of the golden ratio are spread evenly and repeat nothing
        const double phase = turn * ( k + 1 ) * 0.6180339887498949;
        c.radius[k] = clamp + cell * ( k - 1 );
        c.phase[k] = phase - floor( phase );
        c.first[k + 1] = c.first[k] + (int)lrint( 2.0 * VALIDATE_PI * c.radius[k] / cell );
    }
    return c;
}

static int size_of( const disc_circles* c, int k )
{
    return c->first[k + 1] - c->first[k];
}

// Of vertex i of a circle, which may go round more than once, in turns.
static double angle_of( const disc_circles* c, int k, int i )
{
    return ( i + c->phase[k] ) / size_of( c, k );
}

static int vertex_on_circle( const disc_circles* c, int k, int i )
{
    return c->first[k] + i % size_of( c, k );
}

// Triangles between circle k and the next: advance on the circle whose next vertex comes first.
static int zip( const disc_circles* c, int k, int32_t* triangles )
{
    const int inner = size_of( c, k ), outer = size_of( c, k + 1 );
    int count = 0;
    for ( int i = 0, j = 0; i < inner || j < outer; ++count )
    {
        const bool is_outer = i == inner || ( j < outer && angle_of( c, k + 1, j + 1 ) < angle_of( c, k, i + 1 ) );
        int32_t* t = triangles + 3 * count;
        t[0] = vertex_on_circle( c, k, i );
        t[1] = vertex_on_circle( c, k + 1, j );
        t[2] = is_outer ? vertex_on_circle( c, k + 1, j + 1 ) : vertex_on_circle( c, k, i + 1 );
        i += is_outer ? 0 : 1;
        j += is_outer ? 1 : 0;
    }
    return count;
}

wisp_status disc_mesh( double clamp, double border, int cells, double turn, wisp_mesh* out, int* pin_count,
                       wisp_error* error )
{
    const disc_circles c = lay_circles( clamp, border, cells, turn );
    const int vertices = c.first[c.count];
    *out = ( wisp_mesh ){ .vertex_count = vertices };
    out->points = malloc( (size_t)vertices * sizeof( wisp_vec3 ) );
    out->triangles = malloc( (size_t)vertices * 6 * sizeof( int32_t ) );
    if ( !out->points || !out->triangles )
    {
        wisp_mesh_release( out );
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for a specimen" );
    }
    for ( int k = 0; k < c.count; ++k )
    {
        for ( int i = 0; i < size_of( &c, k ); ++i )
        {
            const double angle = 2.0 * VALIDATE_PI * angle_of( &c, k, i );
            out->points[c.first[k] + i] =
                ( wisp_vec3 ){ (float)( c.radius[k] * cos( angle ) ), 0.0f, (float)( -c.radius[k] * sin( angle ) ) };
        }
    }
    for ( int k = 0; k + 1 < c.count; ++k )
    {
        out->triangle_count += zip( &c, k, out->triangles + 3 * out->triangle_count );
    }
    *pin_count = c.first[2];
    return WISP_OK;
}

// ---- the shadow ----

// Pixels of a square about the axis; a pixel is in shadow if its middle is.
typedef struct shadow_image
{
    unsigned char* dark; // [PIXELS][PIXELS]
    double pixel;        // m
} shadow_image;

static double middle_of( const shadow_image* s, int pixel )
{
    return s->pixel * ( pixel + 0.5 - 0.5 * PIXELS );
}

static int pixel_of( const shadow_image* s, double at )
{
    const double pixel = floor( at / s->pixel + 0.5 * PIXELS );
    return (int)fmin( fmax( pixel, 0.0 ), PIXELS - 1.0 );
}

// Twice the area of a triangle of the plane.
static double turn_of( const double a[2], const double b[2], double x, double z )
{
    return ( b[0] - a[0] ) * ( z - a[1] ) - ( b[1] - a[1] ) * ( x - a[0] );
}

static void darken( shadow_image* s, const double a[2], const double b[2], const double c[2] )
{
    const int left = pixel_of( s, fmin( a[0], fmin( b[0], c[0] ) ) ),
              right = pixel_of( s, fmax( a[0], fmax( b[0], c[0] ) ) ),
              low = pixel_of( s, fmin( a[1], fmin( b[1], c[1] ) ) ),
              high = pixel_of( s, fmax( a[1], fmax( b[1], c[1] ) ) );
    for ( int i = low; i <= high; ++i )
    {
        for ( int j = left; j <= right; ++j )
        {
            const double x = middle_of( s, j ), z = middle_of( s, i );
            const double u = turn_of( a, b, x, z ), v = turn_of( b, c, x, z ), w = turn_of( c, a, x, z );
            // inside, whichever side is up
            if ( ( u >= 0.0 && v >= 0.0 && w >= 0.0 ) || ( u <= 0.0 && v <= 0.0 && w <= 0.0 ) )
            {
                s->dark[i * PIXELS + j] = 1;
            }
        }
    }
}

double disc_shadow( const wisp_mesh* mesh, const wisp_vec3* points, double disc, double border )
{
    shadow_image s = { calloc( (size_t)PIXELS * PIXELS, 1 ), 2.2 * border / PIXELS };
    if ( s.dark == NULL )
    {
        return -1.0;
    }
    for ( int t = 0; t < mesh->triangle_count; ++t )
    {
        double corners[3][2];
        for ( int k = 0; k < 3; ++k )
        {
            const wisp_vec3 p = points[mesh->triangles[3 * t + k]];
            corners[k][0] = (double)p.x;
            corners[k][1] = (double)p.z;
        }
        darken( &s, corners[0], corners[1], corners[2] );
    }
    double area = 0.0;
    for ( int i = 0; i < PIXELS * PIXELS; ++i )
    {
        const double r = hypot( middle_of( &s, i % PIXELS ), middle_of( &s, i / PIXELS ) );
        area += s.dark[i] && r > disc ? s.pixel * s.pixel : 0.0;
    }
    free( s.dark );
    return area;
}

// ---- the test ----

enum
{
    MESHES = 2,
    MAX_PINS = 256,
    DRAPE_STEPS = 120,
    LAST_STEPS = 30, // over which the change that is left is measured
};

// A little above critical for the softest fabric, 1/s: with half of it folds still swing after 2 s.
static const double DRAPE_DAMPING = 12.0;
// Of the membrane, N/m: the weight strains it by less than 0.1 %.
static const double STIFFNESS = 100.0;
static const double TURNS[MESHES] = { 1.0, 2.0 };

const drape_fabric drape_fabrics[DRAPE_FABRICS] = {
    { "polyester faille", 0.019, 10.43, 28.3 },
    { "wool tropical", 0.067, 16.29, 49.8 },
    { "polyester tropical", 0.077, 11.65, 50.7 },
    { "cotton broad", 0.118, 12.38, 82.9 },
};

double drape_rigidity( const drape_fabric* fabric )
{
    return 9.80665e-5 * fabric->bending; // gf cm
}

double drape_density( const drape_fabric* fabric )
{
    return 0.01 * fabric->weight; // mg / cm^2
}

// ---- a run ----

// Lay all fabrics on a mesh: fabric f on mesh m is body m DRAPE_FABRICS + f.
static wisp_status lay_fabrics( validate_bodies* b, const wisp_mesh* mesh, int pin_count, wisp_error* error )
{
    int32_t pins[MAX_PINS];
    WISP_ASSERT( pin_count <= MAX_PINS );
    for ( int i = 0; i < pin_count; ++i )
    {
        pins[i] = i;
    }
    for ( int f = 0; f < DRAPE_FABRICS; ++f )
    {
        const sheet_def def = {
            .solver = (sheet_solver)b->method,
            .mesh = mesh,
            .pins = pins,
            .pin_count = pin_count,
            .density = drape_density( drape_fabrics + f ),
            .rigidity = drape_rigidity( drape_fabrics + f ),
            .stiffness = STIFFNESS,
            .damping = DRAPE_DAMPING,
            .gravity = { 0.0f, (float)-SHEET_GRAVITY, 0.0f },
            .friction = -1.0,
        };
        WISP_TRY( sheet_add( &b->world, &def, error ) );
    }
    return WISP_OK;
}

// Drape coefficients of all bodies, in %, if they are observed.
static wisp_status read_drapes( validate_bodies* b, const wisp_mesh* meshes, double out[MESHES * DRAPE_FABRICS],
                                wisp_error* error )
{
    for ( int i = 0; i < MESHES * DRAPE_FABRICS && b->world.is_observed; ++i )
    {
        const wisp_vec3* points = NULL;
        WISP_TRY( validate_world_points( &b->world, i, &points, error ) );
        const double shadow = disc_shadow( meshes + i / DRAPE_FABRICS, points, DRAPE_DISC, DRAPE_CLOTH );
        WISP_TRY( shadow >= 0.0 ? WISP_OK : wisp_fail( error, WISP_NO_MEMORY, "no memory for a shadow" ) );
        out[i] = 100.0 * shadow / ( VALIDATE_PI * ( DRAPE_CLOTH * DRAPE_CLOTH - DRAPE_DISC * DRAPE_DISC ) );
    }
    return WISP_OK;
}

// How far a value is from an interval.
static double outside( double value, double lower, double upper )
{
    return fmax( 0.0, fmax( lower - value, value - upper ) );
}

// How far a coefficient is from those that the regression has for fabrics of this bending length, whatever their shear.
static double outside_cusick( const drape_fabric* fabric, double drape )
{
    const double c =
        100.0 * sheet_bending_length( drape_rigidity( fabric ), drape_density( fabric ) * SHEET_GRAVITY );
    return outside( drape, sheet_cusick( c, sheet_cusick_softest() ), sheet_cusick( c, 0.0 ) );
}

enum
{
    SPREAD = DRAPE_FABRICS,
    LEFT,
    CUSICK,
    DRAPE_MEASURES,
};

static void compare_drapes( const double* before, const double* after, accuracy_run* out )
{
    double sum = 0.0;
    out->measures[SPREAD] = out->measures[LEFT] = out->measures[CUSICK] = 0.0;
    for ( int f = 0; f < DRAPE_FABRICS; ++f )
    {
        const drape_fabric* fabric = drape_fabrics + f;
        const double other = after[f + DRAPE_FABRICS], mean = 0.5 * ( after[f] + other );
        const double wrong = outside( mean, fabric->drape - DRAPE_SCATTER, fabric->drape + DRAPE_SCATTER );
        const double left = fmax( fabs( after[f] - before[f] ), fabs( other - before[f + DRAPE_FABRICS] ) );
        sum += wrong * wrong;
        out->measures[f] = mean;
        out->measures[SPREAD] = fmax( out->measures[SPREAD], fabs( after[f] - other ) );
        out->measures[LEFT] = fmax( out->measures[LEFT], left / ( LAST_STEPS * (double)VALIDATE_STEP ) );
        out->measures[CUSICK] = fmax( out->measures[CUSICK], outside_cusick( fabric, mean ) );
    }
    out->error = sqrt( sum / DRAPE_FABRICS );
}

static wisp_status drape( validate_bodies* b, wisp_mesh meshes[MESHES], wisp_error* error )
{
    double before[MESHES * DRAPE_FABRICS], after[MESHES * DRAPE_FABRICS];
    WISP_TRY( sheet_world_create( b, false, error ) );
    for ( int m = 0; m < MESHES; ++m )
    {
        int pin_count = 0;
        WISP_TRY( disc_mesh( DRAPE_DISC, DRAPE_CLOTH, b->def.cells, TURNS[m], meshes + m, &pin_count, error ) );
        WISP_TRY( lay_fabrics( b, meshes + m, pin_count, error ) );
    }
    WISP_TRY( validate_step( b, DRAPE_STEPS - LAST_STEPS, error ) );
    WISP_TRY( read_drapes( b, meshes, before, error ) );
    WISP_TRY( validate_step( b, LAST_STEPS, error ) );
    WISP_TRY( read_drapes( b, meshes, after, error ) );
    if ( b->world.is_observed )
    {
        compare_drapes( before, after, b->world.run );
    }
    return WISP_OK;
}

static wisp_status play_drape( validate_bodies* b, wisp_error* error )
{
    wisp_mesh meshes[MESHES] = { { .points = NULL } };
    const wisp_status status = drape( b, meshes, error );
    for ( int m = 0; m < MESHES; ++m )
    {
        wisp_mesh_release( meshes + m );
    }
    return status;
}

// Implicit cloth, which is the slowest by far and needs the fewest substeps, has less of both. A quick run has coarse meshes alone.
static void put_drapes( accuracy_scene* out )
{
    static const int quick[] = { 3, 4, 0 }, cells[] = { 4, 6, 8, 0 }, fewer_cells[] = { 4, 6, 0 };
    static const int substeps[] = { 2, 4, 8, 0 }, fewer_substeps[] = { 2, 4, 0 };
    const bool is_quick = ( (const validate_settings*)out->context )->is_quick;
    for ( int s = SHEET_DIHEDRAL; s <= SHEET_IMPLICIT; ++s )
    {
        const char *name = sheet_solver_names[s], *cell = "cell / overhang";
        const bool is_slow = s == SHEET_IMPLICIT;
        validate_put_cells( out, s, name, cell,
                            is_quick  ? quick
                            : is_slow ? fewer_cells
                                      : cells,
                            is_quick || is_slow ? 8 : 16 );
        if ( !is_quick )
        {
            validate_put_substeps( out, s, name, 4, is_slow ? fewer_substeps : substeps );
        }
    }
}

const validate_case validate_drape = {
    .name = "drape",
    .title = "Cusick's test: named fabrics drape over a disc",
    .scene = { .reference = "measured coefficients of four fabrics, +- 5 points; root mean square, after 2 s",
               .error_name = "distance of the drape from its band",
               .error_unit = "points",
               .measure_names = { "faille, %", "wool, %", "polyester, %", "cotton, %", "spread of two meshes",
                                  "change per s", "outside Cusick's law" },
               .measure_count = DRAPE_MEASURES },
    .put = put_drapes,
    .play = play_drape,
};
