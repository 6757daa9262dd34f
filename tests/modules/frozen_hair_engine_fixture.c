#include "frozen_hair_engine_fixture.h"

#include "trig.h"

// ---- grooms ----

static void* new_memory( size_t bytes )
{
    void* memory = checked_calloc( 1, bytes + 16 );
    return memory;
}

static hair_groom new_groom( int dimension, int strands, const int* counts, int equal_count )
{
    hair_groom groom = { .strand_count = strands, .dimension = dimension };
    groom.offsets = new_memory( ( (size_t)strands + 1 ) * sizeof( int32_t ) );
    for ( int s = 0; s < strands; ++s )
    {
        groom.offsets[s + 1] = groom.offsets[s] + ( counts != NULL ? counts[s] : equal_count );
    }
    groom.vertex_count = groom.offsets[strands];
    groom.points = new_memory( (size_t)groom.vertex_count * sizeof( wisp_vec3 ) );
    return groom;
}

static void sine_cosine( float angle, float* sine, float* cosine )
{
    trig_sincos( angle, sine, cosine );
}

// Vertex i relative to its root. Straight hair is made of multiples of 2^-10 m, and 2, 6, 3 have the whole-number
// length 7, so that all its tangents are the same bits in any precision.
static wisp_vec3 offset_from_root( hair_shape shape, int dimension, float phase, float heading, int i )
{
    const float unit = 0x1p-10f, fall = (float)-i * unit;
    if ( shape == HAIR_STRAIGHT )
    {
        return dimension == 2 ? ( wisp_vec3 ){ 0.0f, 7.0f * fall, 0.0f }
                              : ( wisp_vec3 ){ -2.0f * fall, 6.0f * fall, -3.0f * fall };
    }
    float sine, cosine, first_sine, first_cosine, aside, ahead;
    sine_cosine( phase, &first_sine, &first_cosine );
    sine_cosine( phase + 1.25663706f * (float)i, &sine, &cosine );
    sine_cosine( heading, &aside, &ahead );
    float swing = unit * ( sine - first_sine ), sway = unit * ( cosine - first_cosine );
    if ( shape == HAIR_WAVY )
    {
        return dimension == 2 ? ( wisp_vec3 ){ 3.0f * swing, 7.0f * fall, 0.0f }
                              : ( wisp_vec3 ){ 3.0f * swing * ahead, 7.0f * fall, 3.0f * swing * aside };
    }
    // loops in the plane fall more slowly than they turn, so that no two neighbouring segments are collinear
    return dimension == 2 ? ( wisp_vec3 ){ 4.0f * sway, 2.0f * fall + 4.0f * swing, 0.0f }
                          : ( wisp_vec3 ){ 4.0f * sway, 4.0f * fall, 4.0f * swing };
}

static void shape_groom( hair_groom* groom, hair_shape shape, float spacing )
{
    const wisp_random_key key = wisp_random_make_key( 2024, 0, 0 );
    const float grid = (float)(int)( spacing * 0x1p14f + 0.5f ) * 0x1p-14f;
    int side = 1;
    while ( groom->dimension == 3 && side * side < groom->strand_count )
    {
        ++side;
    }
    side = groom->dimension == 2 ? groom->strand_count : side;
    for ( int s = 0; s < groom->strand_count; ++s )
    {
        // a little freedom, small enough that no bend of a wave is nearly straight
        float phase = 0.3f + 0.2f * ( wisp_random_unit_float( key, (uint32_t)s, 0, 0 ) - 0.5f );
        float heading = 6.28318531f * wisp_random_unit_float( key, (uint32_t)s, 1, 0 );
        float x = grid * (float)( s % side ), z = grid * (float)( s / side );
        for ( int v = groom->offsets[s]; v < groom->offsets[s + 1]; ++v )
        {
            wisp_vec3 p = offset_from_root( shape, groom->dimension, phase, heading, v - groom->offsets[s] );
            groom->points[v] = ( wisp_vec3 ){ x + p.x, p.y, groom->dimension == 2 ? 0.0f : z + p.z };
        }
    }
}

hair_groom hair_groom_create( hair_shape shape, int dimension, int strands, int vertices, float spacing )
{
    hair_groom groom = new_groom( dimension, strands, NULL, vertices );
    shape_groom( &groom, shape, spacing );
    return groom;
}

hair_groom hair_groom_create_mixed( hair_shape shape, int dimension, int strands, const int* counts, float spacing )
{
    hair_groom groom = new_groom( dimension, strands, counts, 0 );
    shape_groom( &groom, shape, spacing );
    return groom;
}

hair_groom hair_groom_from( int dimension, int strands, const int* counts, const wisp_vec3* points )
{
    hair_groom groom = new_groom( dimension, strands, counts, 0 );
    memcpy( groom.points, points, (size_t)groom.vertex_count * sizeof( wisp_vec3 ) );
    return groom;
}

void hair_groom_destroy( hair_groom* groom )
{
    free( groom->offsets );
    free( groom->points );
    *groom = ( hair_groom ){ 0 };
}

// ---- worlds ----

static void forget( void* user, wisp_log_level level, const char* message )
{
    (void)user;
    (void)level;
    (void)message;
}

static void expect_ok( const wisp_world* world, wisp_status status )
{
    if ( status != WISP_OK )
    {
        fail_msg( "%s: %s", wisp_status_name( status ), wisp_world_message( world ) );
    }
}

wisp_world* hair_world_create( const hair_host* host )
{
    static const wisp_module* const modules[] = { &wisp_environment_module, &wisp_frozen_hair_module,
                                                  &wisp_strand_appearance_module };
    wisp_world_def def = wisp_default_world_def();
    def.substeps = 1;
    def.modules = modules;
    def.module_count = WISP_COUNT( modules );
    def.log = forget;
    def.workers = 1;
    if ( host != NULL )
    {
        def.workers = host->workers > 0 ? host->workers : 1;
        def.isa = host->isa;
        def.parallel_for = host->parallel_for;
        def.parallel_for_user = host->user;
        def.allocator = host->allocator;
    }
    wisp_world* world = NULL;
    wisp_error error = { WISP_OK, "" };
    if ( wisp_world_create( &def, &world, &error ) != WISP_OK )
    {
        fail_msg( "no world: %s", error.message );
    }
    return world;
}

wisp_entity hair_add( wisp_world* world, const hair_groom* groom )
{
    wisp_strands_def def = wisp_default_strands_def();
    def.points = groom->points;
    def.offsets = groom->offsets;
    def.strand_count = groom->strand_count;
    def.dimension = groom->dimension;
    wisp_entity entity;
    expect_ok( world, wisp_add_strands( world, &def, &entity ) );
    expect_ok( world, wisp_request( world, entity, WISP_STRAND_POINTS ) );
    return entity;
}

wisp_entity hair_add_frozen( wisp_world* world, const hair_groom* groom, const wisp_frozen_hair_def* def )
{
    wisp_entity entity = hair_add( world, groom );
    hair_set( world, entity, def );
    return entity;
}

void hair_set( wisp_world* world, wisp_entity entity, const wisp_frozen_hair_def* def )
{
    expect_ok( world, wisp_set_frozen_hair( world, entity, def ) );
}

void hair_step( wisp_world* world )
{
    expect_ok( world, wisp_world_step( world, 1.0f / 60.0f ) );
}

void hair_command( wisp_world* world, wisp_entity entity, wisp_vec3 cursor )
{
    expect_ok( world, wisp_command_frozen_hair( world, entity, cursor ) );
}

const wisp_vec3* hair_view( wisp_world* world, wisp_entity entity, int vertex_count )
{
    wisp_view view;
    expect_ok( world, wisp_world_view( world, entity, WISP_STRAND_POINTS, &view ) );
    assert_int_equal( view.count, vertex_count );
    assert_int_equal( view.stride, sizeof( wisp_vec3 ) );
    return view.data;
}

wisp_vec3* hair_points( wisp_world* world, wisp_entity entity, int vertex_count )
{
    wisp_vec3* copy = new_memory( (size_t)vertex_count * sizeof( wisp_vec3 ) );
    const wisp_vec3* points = hair_view( world, entity, vertex_count );
    if ( vertex_count > 0 )
    {
        memcpy( copy, points, (size_t)vertex_count * sizeof( wisp_vec3 ) );
    }
    return copy;
}

wisp_frozen_hair_stats hair_stats( wisp_world* world, wisp_entity entity )
{
    wisp_frozen_hair_stats report;
    expect_ok( world, wisp_read_frozen_hair_stats( world, entity, &report ) );
    return report;
}

wisp_vec3* hair_run( const hair_host* host, const hair_groom* groom, const wisp_frozen_hair_def* def )
{
    SCOPED( destroy_local ) wisp_world* world = hair_world_create( host );
    wisp_entity entity = hair_add_frozen( world, groom, def );
    hair_step( world );
    wisp_vec3* points = hair_points( world, entity, groom->vertex_count );
    return points;
}

// ---- parameters ----

wisp_frozen_hair_def hair_no_stages( void )
{
    wisp_frozen_hair_def def = wisp_default_frozen_hair_def();
    def.freeze = def.align = def.clump = false;
    return def;
}

wisp_frozen_hair_def hair_freeze_only( void )
{
    wisp_frozen_hair_def def = hair_no_stages();
    def.freeze = true;
    return def;
}

wisp_frozen_hair_def hair_align_only( wisp_vec3 cursor )
{
    wisp_frozen_hair_def def = hair_no_stages();
    def.align = true;
    def.cursor = cursor;
    def.reach = 100.0f;
    return def;
}

wisp_frozen_hair_def hair_clump_only( void )
{
    wisp_frozen_hair_def def = hair_no_stages();
    def.clump = true;
    return def;
}

// ---- oracle ----

static frozen_oracle_options widen_options( const wisp_frozen_hair_def* d, int dimension, uint64_t event )
{
    frozen_oracle_options o = frozen_oracle_default_options();
    o.theta_max = (double)d->max_bend_angle;
    o.cursor = double3_widen( d->cursor );
    o.cursor_radius = (double)d->reach;
    o.clump_radius = (double)d->clump_radius;
    o.clump_iterations = d->clump_iterations;
    o.clump_step = (double)( d->clump_step_length == -1.0f ? 0.1f * d->clump_radius : d->clump_step_length );
    o.min_distance = (double)( d->min_distance == -1.0f ? 0.02f * d->clump_radius : d->min_distance );
    o.lambda_min = (double)d->min_lambda;
    o.max_depth_change = (double)d->max_depth_change;
    o.dimension = dimension;
    o.gap = d->gap == WISP_GAP_NONE ? FROZEN_ORACLE_GAP_NONE : FROZEN_ORACLE_GAP_ABSOLUTE;
    o.reach = d->reach_nearest ? FROZEN_ORACLE_REACH_NEAREST : FROZEN_ORACLE_REACH_TIP;
    o.deform = d->freeze;
    o.align = d->align;
    o.clump = d->clump && d->clump_iterations > 0;
    o.seed = d->seed;
    o.event = event;
    return o;
}

hair_oracle hair_oracle_create( const hair_groom* groom, const wisp_frozen_hair_def* def, uint64_t event )
{
    const int strands = groom->strand_count;
    hair_oracle oracle = {
        .options = widen_options( def, groom->dimension, event ),
        .vertex_count = groom->vertex_count,
        .rest = hair_widen_all( groom->points, groom->vertex_count ),
        .per_strand = new_memory( 3 * (size_t)strands * sizeof( double ) ),
    };
    double *stretch = oracle.per_strand, *bend = stretch + strands, *intensity = bend + strands;
    for ( int s = 0; s < strands; ++s )
    {
        const float *ks = def->strand_stretch_stiffness, *kb = def->strand_bend_stiffness, *x = def->strand_intensity;
        stretch[s] = (double)( ks != NULL ? ks[s] : def->stretch_stiffness );
        bend[s] = (double)( kb != NULL ? kb[s] : def->bend_stiffness );
        intensity[s] = (double)( x != NULL ? x[s] : def->intensity );
    }
    oracle.hair = ( frozen_oracle_hair ){
        .strand_count = strands,
        .offsets = groom->offsets,
        .rest = oracle.rest,
        .stretch_stiffness = stretch,
        .bend_stiffness = bend,
        .intensity = intensity,
    };
    return oracle;
}

void hair_oracle_destroy( hair_oracle* oracle )
{
    free( oracle->rest );
    free( oracle->per_strand );
    *oracle = ( hair_oracle ){ 0 };
}

// ---- numbers ----

double3* hair_new_points( int count )
{
    return new_memory( (size_t)count * sizeof( double3 ) );
}

double3* hair_widen_all( const wisp_vec3* points, int count )
{
    double3* wide = hair_new_points( count );
    for ( int v = 0; v < count; ++v )
    {
        wide[v] = double3_widen( points[v] );
    }
    return wide;
}

bool hair_same_bits( const wisp_vec3* a, const wisp_vec3* b, int count )
{
    return count == 0 || memcmp( a, b, (size_t)count * sizeof( wisp_vec3 ) ) == 0;
}

double hair_distance( wisp_vec3 a, wisp_vec3 b )
{
    return double3_distance( double3_widen( a ), double3_widen( b ) );
}

void hair_assert_close( double actual, double expected, double tolerance )
{
    if ( !( fabs( actual - expected ) <= tolerance ) )
    {
        fail_msg( "%.9g is not %.9g within %.3g", actual, expected, tolerance );
    }
}

void hair_assert_finite( const wisp_vec3* points, int count )
{
    for ( int v = 0; v < count; ++v )
    {
        if ( !isfinite( points[v].x ) || !isfinite( points[v].y ) || !isfinite( points[v].z ) )
        {
            fail_msg( "vertex %d is (%g, %g, %g)", v, (double)points[v].x, (double)points[v].y, (double)points[v].z );
        }
    }
}
