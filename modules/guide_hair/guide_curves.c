// Curves through the vertices of strands: how many samples, which lanes they follow, and when they are drawn.
#include "guide_internal.h"

#include <math.h>

enum
{
    CURVE_GRAIN = 4, // groups a block
    MAX_SAMPLES = 64,
    MAX_VERTICES = 1 << 28,
};

void wisp_init_curves_def( wisp_curves_def* def, size_t size )
{
    const wisp_curves_def values = {
        .kind = WISP_CURVE_CATMULL_ROM,
        .samples = 8,
    };
    wisp_def_init( def, size, &values, sizeof( values ) );
}

// ---- passes ----

void guide_run_source( wisp_frame* frame, const wisp_span* span, void* user )
{
    const guide_state* state = user;
    uint64_t* changes = wisp_frame_column( frame, span->entity, state->drawn, 0 );
    *changes += 1;
}

// Draw only if the source strands have changed.
bool guide_curves_are_due( wisp_frame* frame, wisp_entity entity, void* user )
{
    const guide_state* state = user;
    const guide_drawing* d = guide_find_drawing( state, entity );
    if ( d == NULL || d->source.index == 0 )
    {
        return false;
    }
    const uint64_t* drawn = wisp_frame_column( frame, entity, state->curves, 0 );
    const uint64_t* changes = wisp_frame_column( frame, d->source, state->drawn, 0 );
    return *drawn != *changes;
}

typedef struct curve_loop
{
    wisp_strand_curve_args args;
    const wisp_kernels* kernels;
} curve_loop;

static void draw_groups( void* context, int begin, int end, int worker )
{
    (void)worker;
    const curve_loop* loop = context;
    loop->kernels->strand_curve( &loop->args, begin, end );
}

void guide_run_curves( wisp_frame* frame, const wisp_span* span, void* user )
{
    const guide_state* state = user;
    const guide_drawing* d = guide_find_drawing( state, span->entity );
    const wisp_strand_topology* t = wisp_frame_strands( frame, span->entity );
    curve_loop loop = {
        .kernels = wisp_frame_kernels( frame ),
        .args = {
            .group_row = t->group_row,
            .lane_row = d->lane_row,
            .lane_vertices = d->lane_vertices,
            .from = wisp_frame_column( frame, d->source, WISP_STRAND_POSITION, 0 ),
            .to = wisp_frame_column( frame, span->entity, WISP_STRAND_POSITION, 0 ),
            .weight = d->weight,
            .samples = d->samples,
            .shares_ends = d->shares_ends,
        },
    };
    wisp_parallel_for( wisp_frame_parallel( frame, span ), t->group_count, CURVE_GRAIN, draw_groups, &loop );
    uint64_t* drawn = wisp_frame_column( frame, span->entity, state->curves, 0 );
    *drawn = *(uint64_t*)wisp_frame_column( frame, d->source, state->drawn, 0 );
}

// ---- at rest ----

static bool shares_ends( wisp_curve_kind kind )
{
    return kind != WISP_CURVE_CATMULL_ROM;
}

static int segments_of( int vertices, wisp_curve_kind kind )
{
    if ( vertices < 2 )
    {
        return 0;
    }
    return shares_ends( kind ) ? ( vertices + 1 ) / 3 : vertices - 1;
}

// Weights of the four points of a sample: eq. 6 with coefficient 3, or the Catmull-Rom spline of the two in the middle.
static void blend_weights( wisp_curve_kind kind, double t, double weight[4] )
{
    const double s = 1.0 - t;
    if ( shares_ends( kind ) )
    {
        weight[0] = s * s * s;
        weight[1] = 3.0 * s * s * t;
        weight[2] = 3.0 * s * t * t;
        weight[3] = t * t * t;
        return;
    }
    weight[0] = -0.5 * t * s * s;
    weight[1] = 1.0 + t * t * ( 1.5 * t - 2.5 );
    weight[2] = t * ( 0.5 + t * ( 2.0 - 1.5 * t ) );
    weight[3] = -0.5 * t * t * s;
}

static guide_point between( guide_point a, guide_point b, double fraction )
{
    return guide_mul_add( a, fraction, guide_sub( b, a ) );
}

// Moves a point next to a joint onto the line through it along `tangent`, at the distance that it has.
static guide_point onto_tangent( guide_point joint, guide_point p, guide_point tangent, double sign )
{
    const guide_point d = guide_sub( p, joint );
    const double length = sqrt( guide_dot( tangent, tangent ) ), distance = sqrt( guide_dot( d, d ) );
    return length > 0.0 ? guide_mul_add( joint, sign * distance / length, tangent ) : p;
}

// Rotates the inner points of a group of four about its joints.
static void share_tangents( const wisp_vec3* v, int count, int first, guide_point p[4] )
{
    if ( first > 0 )
    {
        const guide_point along = guide_sub( guide_widen( v[first + 1] ), guide_widen( v[first - 1] ) );
        p[1] = onto_tangent( p[0], p[1], along, 1.0 );
    }
    if ( first + 4 < count )
    {
        const guide_point along = guide_sub( guide_widen( v[first + 4] ), guide_widen( v[first + 2] ) );
        p[2] = onto_tangent( p[3], p[2], along, -1.0 );
    }
}

// The four points that a segment blends, as the kernel has them.
static void segment_points( const wisp_vec3* v, int count, wisp_curve_kind kind, int segment, guide_point p[4] )
{
    const int first = shares_ends( kind ) ? 3 * segment : segment - 1, left = count - 1 - first;
    for ( int n = 0; n < 4; ++n )
    {
        const int i = first + n;
        p[n] = guide_widen( v[i < 0 ? 0 : i < count ? i : count - 1] );
    }
    if ( kind == WISP_CURVE_CATMULL_ROM )
    {
        p[0] = segment == 0 ? between( p[2], p[1], 2.0 ) : p[0];
        p[3] = left < 3 ? between( p[1], p[2], 2.0 ) : p[3];
        return;
    }
    if ( left < 3 )
    {
        const guide_point middle = left == 2 ? p[1] : p[0], end = p[3];
        p[1] = left == 2 ? between( p[0], middle, 2.0 / 3.0 ) : between( p[0], end, 1.0 / 3.0 );
        p[2] = left == 2 ? between( middle, end, 1.0 / 3.0 ) : between( p[0], end, 2.0 / 3.0 );
    }
    share_tangents( v, count, first, p );
}

static void draw_strand( const wisp_vec3* v, int count, const wisp_curves_def* def, wisp_vec3* out )
{
    const int segments = segments_of( count, def->kind );
    if ( segments > 0 )
    {
        *out++ = v[0];
    }
    for ( int n = 0; n < segments * def->samples; ++n )
    {
        guide_point p[4], sum = { 0.0, 0.0, 0.0 };
        double weight[4];
        segment_points( v, count, def->kind, n / def->samples, p );
        blend_weights( def->kind, (double)( n % def->samples + 1 ) / def->samples, weight );
        for ( int k = 0; k < 4; ++k )
        {
            sum = guide_mul_add( sum, weight[k], p[k] );
        }
        *out++ = ( wisp_vec3 ){ (float)sum.x, (float)sum.y, (float)sum.z };
    }
}

// ---- cooking ----

// Find the source lane of each curve. Both sides are sorted by length, so it is nearly always the same lane.
static bool find_lanes( guide_drawing* d, const wisp_strand_topology* curves, const wisp_strand_topology* source )
{
    const size_t lanes = (size_t)curves->group_count * WISP_LANES;
    guide_memory scratch = { .allocator = d->memory.allocator };
    int32_t* lane_of = guide_take( &scratch, (size_t)source->strand_count, sizeof( int32_t ) );
    d->lane_row = guide_take( &d->memory, lanes, sizeof( int32_t ) );
    d->lane_vertices = guide_take( &d->memory, lanes, sizeof( int32_t ) );
    const bool complete = scratch.failed == false && d->memory.failed == false;
    for ( int lane = 0; lane < source->group_count * WISP_LANES && complete; ++lane )
    {
        if ( source->lane_strand[lane] >= 0 )
        {
            lane_of[source->lane_strand[lane]] = lane;
        }
    }
    for ( size_t lane = 0; lane < lanes && complete; ++lane )
    {
        if ( curves->lane_strand[lane] >= 0 )
        {
            const int from = lane_of[curves->lane_strand[lane]];
            d->lane_row[lane] = source->group_row[from / WISP_LANES] * 3 * WISP_LANES + from % WISP_LANES;
            d->lane_vertices[lane] = source->lane_count[from];
        }
    }
    guide_give_back( &scratch );
    return complete;
}

static bool cook_weights( guide_drawing* d, wisp_curve_kind kind )
{
    d->weight = guide_take( &d->memory, (size_t)d->samples * 4, sizeof( float ) );
    for ( int n = 0; n < d->samples && d->weight != NULL; ++n )
    {
        double weight[4];
        blend_weights( kind, (double)( n + 1 ) / d->samples, weight );
        for ( int k = 0; k < 4; ++k )
        {
            d->weight[4 * n + k] = (float)weight[k];
        }
    }
    return d->weight != NULL;
}

void guide_drawing_release( guide_drawing* drawing )
{
    if ( drawing != NULL )
    {
        const wisp_allocator* allocator = drawing->memory.allocator;
        guide_give_back( &drawing->memory );
        allocator->release( allocator->user, drawing, sizeof( *drawing ) );
    }
}

static guide_drawing* cook_drawing( wisp_world* world, const wisp_curves_def* def, wisp_entity curves )
{
    const wisp_allocator* allocator = wisp_world_allocator( world );
    guide_drawing* d = allocator->allocate( allocator->user, sizeof( *d ), 64 );
    if ( d == NULL )
    {
        return NULL;
    }
    *d = ( guide_drawing ){
        .memory = { .allocator = allocator },
        .curves = curves,
        .source = def->source,
        .samples = def->samples,
        .shares_ends = shares_ends( def->kind ),
    };
    if ( cook_weights( d, def->kind ) == false ||
         find_lanes( d, wisp_world_strands( world, curves ), wisp_world_strands( world, def->source ) ) == false )
    {
        guide_drawing_release( d );
        return NULL;
    }
    return d;
}

// ---- adding ----

static wisp_status check_curves( wisp_world* world, const guide_state* s, const wisp_curves_def* def )
{
    if ( s == NULL )
    {
        return wisp_world_fail( world, WISP_CONFLICT, "module guide_hair: not registered in this world" );
    }
    if ( def->kind < 0 || def->kind >= WISP_CURVE_KIND_COUNT )
    {
        return wisp_world_fail( world, WISP_BAD_INPUT, "curves: kind: got %d, which does not exist", (int)def->kind );
    }
    if ( def->samples < 1 || def->samples > MAX_SAMPLES )
    {
        return wisp_world_fail( world, WISP_BAD_INPUT, "curves: samples: got %d, expected 1 to %d", def->samples,
                                MAX_SAMPLES );
    }
    if ( wisp_is_alive( world, def->source ) == false )
    {
        return wisp_world_fail( world, def->source.index == 0 ? WISP_CONFLICT : WISP_STALE_ID,
                                "curves: source: entity %u does not exist or was removed", def->source.index );
    }
    if ( wisp_world_strands( world, def->source ) == NULL )
    {
        return wisp_world_fail( world, WISP_CONFLICT, "curves: source: entity %u has no strands", def->source.index );
    }
    // they would be drawn at the same time as their source
    if ( wisp_world_has( world, def->source, s->curves ) )
    {
        return wisp_world_fail( world, WISP_CONFLICT, "curves: source: entity %u holds curves, expected strands",
                                def->source.index );
    }
    return WISP_OK;
}

static wisp_status count_vertices( wisp_world* world, const wisp_strand_topology* t, const wisp_curves_def* def,
                                   int32_t* offsets )
{
    int64_t count = 0;
    for ( int s = 0; s < t->strand_count; ++s )
    {
        const int64_t segments = segments_of( t->offsets[s + 1] - t->offsets[s], def->kind );
        count += segments > 0 ? segments * def->samples + 1 : 0;
        if ( count > MAX_VERTICES )
        {
            return wisp_world_fail( world, WISP_BAD_INPUT, "curves: strand %d: got more samples than the limit of %d",
                                    s, MAX_VERTICES );
        }
        offsets[s + 1] = (int32_t)count;
    }
    // offsets in floats must fit 32 bits
    return (int64_t)t->row_count * 3 * WISP_LANES <= INT32_MAX
               ? WISP_OK
               : wisp_world_fail( world, WISP_BAD_INPUT, "curves: source: got %d rows, which is too many",
                                  t->row_count );
}

// Add the entity, with the curves of the rest shape.
static wisp_status add_entity( wisp_world* world, const wisp_curves_def* def, guide_memory* scratch,
                               wisp_entity* out )
{
    const wisp_strand_topology* t = wisp_world_strands( world, def->source );
    guide_shape shape;
    int32_t* offsets = guide_take( scratch, (size_t)t->strand_count + 1, sizeof( int32_t ) );
    if ( offsets == NULL || guide_read_shape( world, def->source, scratch, &shape ) == false )
    {
        return wisp_world_fail( world, WISP_NO_MEMORY, "out of memory for curves of %d strands", t->strand_count );
    }
    WISP_TRY( count_vertices( world, t, def, offsets ) );
    wisp_vec3* points = guide_take( scratch, (size_t)offsets[t->strand_count], sizeof( wisp_vec3 ) );
    if ( points == NULL )
    {
        return wisp_world_fail( world, WISP_NO_MEMORY, "out of memory for %d samples", offsets[t->strand_count] );
    }
    for ( int s = 0; s < t->strand_count; ++s )
    {
        draw_strand( guide_strand( &shape, s ), guide_vertices( &shape, s ), def, points + offsets[s] );
    }
    wisp_strands_def strands = wisp_default_strands_def();
    strands.points = points;
    strands.offsets = offsets;
    strands.strand_count = t->strand_count;
    strands.dimension = t->dimension;
    return wisp_add_strands( world, &strands, out );
}

// Request the pass that counts changes of the source.
static wisp_status watch_source( wisp_world* world, const guide_state* s, wisp_entity source )
{
    const bool had = wisp_world_has( world, source, s->drawn );
    wisp_status status = wisp_world_attach( world, source, s->drawn );
    status = status == WISP_OK ? wisp_world_request( world, source, s->drawn ) : status;
    if ( status == WISP_OK && had == false )
    {
        uint64_t* changes = wisp_world_column( world, source, s->drawn, 0 );
        *changes = 1; // curves start at 0: not drawn yet
    }
    return status;
}

wisp_status wisp_add_curves( wisp_world* world, const wisp_curves_def* given, wisp_entity* out )
{
    if ( out != NULL )
    {
        *out = ( wisp_entity ){ 0, 0 };
    }
    wisp_curves_def values = wisp_default_curves_def();
    const wisp_curves_def* def = &values;
    WISP_TRY( wisp_world_begin_def( world, "wisp_default_curves_def", &values, given ) );
    WISP_TRY( wisp_world_check_pointer( world, "out", out ) );
    guide_state* s = wisp_world_module_state( world, "guide_hair" );
    WISP_TRY( check_curves( world, s, def ) );
    if ( wisp_world_reserve( world, (void**)&s->drawings, &s->drawing_capacity, s->drawing_count,
                             sizeof( *s->drawings ) ) == false )
    {
        return wisp_world_fail( world, WISP_NO_MEMORY, "out of memory for %d entities of curves",
                                s->drawing_count + 1 );
    }
    guide_memory scratch = { .allocator = wisp_world_allocator( world ) };
    wisp_entity curves = { 0, 0 };
    wisp_status status = add_entity( world, def, &scratch, &curves );
    guide_give_back( &scratch );
    if ( status != WISP_OK )
    {
        return status;
    }
    guide_drawing* drawing = cook_drawing( world, def, curves );
    status = drawing != NULL ? wisp_world_attach( world, curves, s->curves )
                             : wisp_world_fail( world, WISP_NO_MEMORY, "out of memory to cook curves" );
    status = status == WISP_OK ? watch_source( world, s, def->source ) : status;
    if ( status != WISP_OK )
    {
        guide_drawing_release( drawing );
        wisp_world_remove( world, curves );
        return status;
    }
    double origin[3];
    (void)wisp_read_origin( world, def->source, origin );
    (void)wisp_set_origin( world, curves, origin );
    wisp_world_tie( world, def->source, curves );
    s->drawings[s->drawing_count++] = drawing;
    *out = curves;
    return WISP_OK;
}
