#include "boundary_scene.h"

#include "oracle/boundary_oracle.h"
#include "wisp/module/components.h"
#include "wisp/module/module.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double TWO_PI = 6.283185307179586;

// A position is a sum of three products with computed weights: a point has an error of some roundings of its largest
// coordinate.
static const double ROUNDINGS = 8.0;

static const float LITTLE_HYSTERESIS = 1e-6f; // of a spacing

const layer_law layer_laws[LAYER_LAWS] = {
    { "even", WISP_SPACING_EVEN, WISP_ROUND_DOWN },
    { "exact", WISP_SPACING_EXACT, WISP_ROUND_DOWN },
    { "even, up", WISP_SPACING_EVEN, WISP_ROUND_UP },
};

wisp_status layer_sphere( int segments, float radius, wisp_mesh* out, wisp_error* error )
{
    wisp_mesh_generator generator = wisp_default_mesh_generator( WISP_MESH_UV_SPHERE );
    generator.segments = generator.rings = segments;
    generator.radius = radius;
    return wisp_mesh_generate( &generator, out, error );
}

wisp_status layer_cook( const wisp_mesh* mesh, wisp_fabric** out, wisp_error* error )
{
    wisp_fabric_def def = wisp_default_fabric_def();
    def.bend_links = false;
    return surface_cook( mesh, def, out, error );
}

wisp_boundary_def layer_def( const layer_law* law, float spacing )
{
    wisp_boundary_def def = wisp_default_boundary_def();
    def.spacing = spacing;
    def.policy = law->policy;
    def.rounding = law->rounding;
    return def;
}

// ---- implementations ----

wisp_status layer_set( surface_implementation* implementation, const wisp_boundary_def* def, wisp_error* error )
{
    wisp_status status = wisp_set_boundary( implementation->world, implementation->entity, def );
    return status == WISP_OK ? WISP_OK : bench_world_fail( implementation->world, status, error );
}

wisp_status layer_enter( wisp_fabric* fabric, const wisp_boundary_def* def, int workers, layer_implementation* out,
                         wisp_error* error )
{
    *out = ( layer_implementation ){ .def = *def };
    surface_generator generator = surface_default_generator( &wisp_boundary_module, fabric );
    generator.workers = workers;
    wisp_status status = surface_implementation_create( &generator, &out->surface, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    status = layer_set( &out->surface, def, error );
    if ( status != WISP_OK )
    {
        surface_implementation_destroy( &out->surface );
    }
    return status;
}

// Position of every vertex before the step, at rest, so that only the layer has to follow.
static void pulsate( layer_implementation* implementation )
{
    const wisp_fabric* f = implementation->surface.fabric;
    const double phase = TWO_PI * ( implementation->surface.steps % LAYER_PERIOD ) / LAYER_PERIOD;
    const double scale = 1.0 + implementation->amplitude * sin( phase );
    float* x =
        wisp_world_column( implementation->surface.world, implementation->surface.entity, WISP_PARTICLE_POSITION, 0 );
    for ( int i = 0; i < f->slot_count; ++i )
    {
        x[4 * (size_t)i] = (float)( scale * (double)f->rest[i].x );
        x[4 * (size_t)i + 1] = (float)( scale * (double)f->rest[i].y );
        x[4 * (size_t)i + 2] = (float)( scale * (double)f->rest[i].z );
    }
}

// A layer that is set again with the same definition keeps its weights where counts are the same. Another hysteresis
// drops all of them; so small a change affects no count, except for lengths that are a whole number of spacings
// within the rounding of a float.
static wisp_status sample_again( layer_implementation* implementation, wisp_error* error )
{
    wisp_boundary_def def = implementation->def;
    implementation->has_little = !implementation->has_little;
    def.hysteresis += implementation->has_little ? LITTLE_HYSTERESIS : 0.0f;
    return layer_set( &implementation->surface, &def, error );
}

wisp_status layer_step( void* context, wisp_error* error )
{
    layer_implementation* implementation = context;
    if ( implementation->amplitude > 0.0 )
    {
        pulsate( implementation );
    }
    wisp_status status = implementation->is_resampled ? sample_again( implementation, error ) : WISP_OK;
    return status == WISP_OK ? surface_implementation_step( &implementation->surface, error ) : status;
}

wisp_status layer_keep_profile( void* context )
{
    layer_implementation* implementation = context;
    return surface_implementation_keep_profile( &implementation->surface );
}

stats_summary layer_pass_ms( surface_implementation* implementation, const char* pass )
{
    stats_summary ms = { .median = NAN, .p10 = NAN, .p90 = NAN, .minimum = NAN };
    for ( int i = 0; i < implementation->profile.pass_count; ++i )
    {
        profile_pass* kept = implementation->profile.passes + i;
        if ( strcmp( kept->name, pass ) == 0 )
        {
            ms = stats_summarise( kept->seconds, kept->count );
            ms.median *= 1e3;
            ms.p10 *= 1e3;
            ms.p90 *= 1e3;
            ms.minimum *= 1e3;
        }
    }
    return ms;
}

// ---- outputs of a layer ----

wisp_status layer_read( surface_implementation* implementation, wisp_boundary_view* out, wisp_error* error )
{
    wisp_status status = wisp_read_boundary( implementation->world, implementation->entity, out );
    return status == WISP_OK ? WISP_OK : bench_world_fail( implementation->world, status, error );
}

wisp_status layer_read_stats( surface_implementation* implementation, wisp_boundary_stats* out, wisp_error* error )
{
    wisp_status status = wisp_read_boundary_stats( implementation->world, implementation->entity, out );
    return status == WISP_OK ? WISP_OK : bench_world_fail( implementation->world, status, error );
}

static uint64_t hash_bytes( uint64_t hash, const void* bytes, size_t size )
{
    const unsigned char* p = bytes;
    for ( size_t i = 0; i < size; ++i )
    {
        hash = ( hash ^ p[i] ) * 0x100000001b3u; // FNV-1a
    }
    return hash;
}

uint64_t layer_hash( const wisp_boundary_view* view )
{
    const wisp_samples* s = view->samples;
    const size_t bytes = (size_t)s->count * 4 * sizeof( float );
    const int32_t counts[2] = { s->count, s->edge_count };
    uint64_t hash = hash_bytes( 0xcbf29ce484222325u, counts, sizeof( counts ) );
    hash = hash_bytes( hash, s->xyzw, bytes );
    hash = hash_bytes( hash, s->normals, bytes );
    hash = hash_bytes( hash, s->parents, bytes );
    return hash_bytes( hash, s->weights, bytes );
}

// ---- the oracle ----

static double3 point_of( const float* quads, size_t at )
{
    return double3_make( (double)quads[at], (double)quads[at + 1], (double)quads[at + 2] );
}

// Unlike fmax() it keeps NaN.
static double larger( double so_far, double next )
{
    return next > so_far || isnan( next ) ? next : so_far;
}

static double length_of( double3 v )
{
    return sqrt( double3_dot( v, v ) );
}

// From the line of its edge, or from the plane of its triangle.
static double off_surface( const wisp_samples* s, const float* x, int point )
{
    const int32_t* parents = s->parents[point];
    const double3 a = point_of( x, (size_t)parents[0] );
    const double3 y = double3_sub( point_of( s->xyzw, 4 * (size_t)point ), a );
    const double3 u = double3_sub( point_of( x, (size_t)parents[1] ), a );
    if ( point < s->edge_count )
    {
        return length_of( double3_cross( y, u ) ) / length_of( u );
    }
    const double3 n = double3_cross( u, double3_sub( point_of( x, (size_t)parents[2] ), a ) );
    return fabs( double3_dot( y, n ) ) / length_of( n );
}

static void compare_points( const wisp_boundary_view* view, const float* x, const boundary_oracle_layer* oracle,
                            layer_check* out )
{
    const wisp_samples* s = view->samples;
    const bool same = s->edge_count == oracle->edge_point_count && s->count == oracle->point_count;
    *out = ( layer_check ){
        .edge_points = s->edge_count,
        .inner_points = s->count - s->edge_count,
        .edge_expected = oracle->edge_point_count,
        .inner_expected = oracle->point_count - oracle->edge_point_count,
        .farthest = same ? 0.0 : INFINITY,
    };
    for ( int p = 0; p < s->count; ++p )
    {
        const double3 y = point_of( s->xyzw, 4 * (size_t)p );
        const double away = same ? length_of( double3_sub( y, oracle->points[p].y ) ) : INFINITY;
        out->farthest = larger( out->farthest, away );
        out->off_surface = larger( out->off_surface, off_surface( s, x, p ) );
        out->reach = fmax( out->reach, fmax( fabs( y.x ), fmax( fabs( y.y ), fabs( y.z ) ) ) );
    }
}

static boundary_oracle_options oracle_options( const wisp_boundary_def* def )
{
    boundary_oracle_options options = boundary_oracle_default_options();
    options.spacing = (double)def->spacing;
    options.policy = (boundary_oracle_policy)def->policy;
    options.rounding = (boundary_oracle_rounding)def->rounding;
    return options;
}

static wisp_status ask_oracle( const wisp_mesh* mesh, double3* points, const wisp_boundary_def* def,
                               const wisp_boundary_view* view, const float* x, layer_check* out, wisp_error* error )
{
    const balloon_mesh as_oracle = { mesh->vertex_count, mesh->triangle_count, points, mesh->triangles };
    const boundary_oracle_options options = oracle_options( def );
    boundary_oracle_layer oracle;
    wisp_status status = boundary_oracle_create( &as_oracle, &options, &oracle, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    if ( boundary_oracle_update( &oracle, points ) )
    {
        compare_points( view, x, &oracle, out );
    }
    else
    {
        status = wisp_fail( error, WISP_NO_MEMORY, "no memory for the oracle's boundary points" );
    }
    boundary_oracle_destroy( &oracle );
    return status;
}

wisp_status layer_compare( surface_implementation* implementation, const wisp_mesh* mesh,
                           const wisp_boundary_def* def, layer_check* out, wisp_error* error )
{
    const float* x = wisp_world_column( implementation->world, implementation->entity, WISP_PARTICLE_POSITION, 0 );
    double3* points = malloc( (size_t)mesh->vertex_count * sizeof( double3 ) );
    if ( points == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for the oracle's vertices" );
    }
    for ( int v = 0; v < mesh->vertex_count; ++v )
    {
        points[v] = point_of( x, 4 * (size_t)implementation->fabric->vertex_slot[v] );
    }
    wisp_boundary_view view;
    wisp_status status = layer_read( implementation, &view, error );
    status = status == WISP_OK ? ask_oracle( mesh, points, def, &view, x, out, error ) : status;
    free( points );
    return status;
}

wisp_status layer_volume( surface_implementation* implementation, const wisp_mesh* mesh, double* volume,
                          wisp_error* error )
{
    const wisp_vec3* points;
    wisp_status status = surface_implementation_points( implementation, &points, error );
    *volume = status == WISP_OK ? balloon_volume( mesh, points ) / balloon_volume( mesh, mesh->points ) : NAN;
    return status;
}

bool layer_check_is_met( const layer_check* check )
{
    const double rounding = ROUNDINGS * (double)FLT_EPSILON * check->reach;
    return check->edge_points == check->edge_expected && check->inner_points == check->inner_expected &&
           check->farthest <= rounding && check->off_surface <= rounding;
}

// ---- the balloon of the boundary particle paper ----

layer_balloon layer_default_balloon( void )
{
    return ( layer_balloon ){ .skin = LAYER_SKIN, .multiplier = 1.0f, .seconds = LAYER_STEP };
}

wisp_status layer_enter_balloon( wisp_fabric* fabric, const wisp_mesh* mesh, const layer_balloon* setting,
                                 surface_implementation* out, wisp_error* error )
{
    const int32_t top = balloon_mesh_extreme( mesh, ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f } );
    surface_generator generator = surface_default_generator( &wisp_balloon_module, fabric );
    generator.second = &wisp_boundary_module;
    generator.vertex_mass = 1.0f;
    // the engine's implicit step of a rate that keeps the same velocity as the paper's decay, for any step
    generator.damping = (float)( expm1( (double)LAYER_DECAY * (double)setting->seconds ) / (double)setting->seconds );
    generator.iterations = LAYER_ITERATIONS;
    generator.seconds = setting->seconds;
    generator.gravity = ( wisp_vec3 ){ 0.0f, -setting->gravity, 0.0f };
    generator.pins = &top;
    generator.pin_count = setting->is_hung ? 1 : 0;
    wisp_balloon_def def = wisp_default_balloon_def();
    def.solver = def.volume = WISP_SOLVER_PBD;
    def.stretch_stiffness = setting->skin;
    def.bend_stiffness = 0.0f;
    def.volume_stiffness = 1.0f;
    def.gas_ratio = setting->multiplier;
    def.min_gas_ratio = 0.001f;
    def.buoyancy = false; // not in the paper
    def.drag_coefficient = 0.0f;
    wisp_status status = surface_implementation_create( &generator, out, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    status = wisp_set_balloon( out->world, out->entity, &def );
    if ( status != WISP_OK )
    {
        bench_world_fail( out->world, status, error );
        surface_implementation_destroy( out );
    }
    return status;
}
