// Curves through the vertices of strands: how many samples, which lanes they follow, and when they are drawn.
#include "guide_internal.h"

#include <math.h>
#include <string.h>

// ---- resample ----

// Points of a strand at any arc length, so that a ghost may have another number of vertices than its target.

static double segment_length( const wisp_vec3* points, int end )
{
    const guide_point d = guide_sub( guide_widen( points[end] ), guide_widen( points[end - 1] ) );
    return sqrt( guide_dot( d, d ) );
}

void guide_arc( const wisp_vec3* points, int count, double* arc )
{
    double length = 0.0;
    for ( int i = 0; i < count; ++i )
    {
        length += i > 0 ? segment_length( points, i ) : 0.0;
        arc[i] = length;
    }
    for ( int i = 1; i < count; ++i )
    {
        arc[i] = length > 0.0 ? arc[i] / length : (double)i / ( count - 1 );
    }
}

// Add `weight` times the Catmull-Rom tangent of a vertex: the mean of the differences at both sides, one at an end.
static void add_tangent( guide_stencil* stencil, int first, int vertex, int count, double weight )
{
    const int before = vertex > 0 ? vertex - 1 : 0, after = vertex < count - 1 ? vertex + 1 : count - 1;
    weight /= after - before;
    stencil->weight[after - first] += weight;
    stencil->weight[before - first] -= weight;
}

guide_stencil guide_spline_stencil( const wisp_vec3* points, int count, double arc )
{
    guide_stencil stencil = { { 0, 0, 0, 0 }, { 1.0, 0.0, 0.0, 0.0 } };
    if ( count < 2 )
    {
        return stencil;
    }

    // last segment that begins at or before the place
    int segment = 0;
    double length = 0.0, begin = 0.0, walked = 0.0;
    for ( int i = 1; i < count; ++i )
    {
        length += segment_length( points, i );
    }
    for ( int i = 0; i < count - 1 && walked <= arc * length; ++i )
    {
        segment = i;
        begin = walked;
        walked += segment_length( points, i + 1 );
    }
    const double extent = segment_length( points, segment + 1 );
    const double u = extent > 0.0 ? fmin( 1.0, ( arc * length - begin ) / extent ) : 0.0, u2 = u * u, u3 = u2 * u;

    // Hermite between the segment's ends; slots outside the strand repeat its ends with weight 0
    const int first = segment - 1;
    for ( int n = 0; n < 4; ++n )
    {
        const int vertex = first + n;
        stencil.vertex[n] = vertex < 0 ? 0 : vertex < count ? vertex : count - 1;
        stencil.weight[n] = 0.0;
    }
    stencil.weight[1] = 2.0 * u3 - 3.0 * u2 + 1.0;
    stencil.weight[2] = 3.0 * u2 - 2.0 * u3;
    add_tangent( &stencil, first, segment, count, u3 - 2.0 * u2 + u );
    add_tangent( &stencil, first, segment + 1, count, u3 - u2 );
    return stencil;
}

guide_point guide_gather( const guide_stencil* stencil, const wisp_vec3* points )
{
    guide_point sum = { 0.0, 0.0, 0.0 };
    for ( int n = 0; n < 4; ++n )
    {
        sum = guide_mul_add( sum, stencil->weight[n], guide_widen( points[stencil->vertex[n]] ) );
    }
    return sum;
}

// ---- curves ----

enum
{
    CURVE_GRAIN = 4, // groups a block
    MAX_SAMPLES = 64,
    MAX_VERTICES = 1 << 28,
};

static const wisp_field CURVES_FIELDS[] = {
    WISP_CHOICE( wisp_curves_def, kind, WISP_CURVE_CATMULL_ROM, WISP_CURVE_KIND_COUNT ),
    WISP_WHOLE( wisp_curves_def, samples, 8, 1, MAX_SAMPLES ),
};
WISP_DEFINE( curves_def, "curves", CURVES_FIELDS )

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
    const guide_drawing* d = wisp_find_object( state->drawings, entity );
    if ( d == NULL || d->source.index == 0 )
    {
        return false;
    }
    const uint64_t* drawn = wisp_frame_column( frame, entity, state->curves, 0 );
    const uint64_t* changes = wisp_frame_column( frame, d->source, state->drawn, 0 );
    return *drawn != *changes;
}

WISP_KERNEL_LOOP( curve_loop, draw_groups, strand_curve, wisp_strand_curve_args, 1 )

void guide_run_curves( wisp_frame* frame, const wisp_span* span, void* user )
{
    const guide_state* state = user;
    const guide_drawing* d = wisp_find_object( state->drawings, span->entity );
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

void guide_drawing_release( void* memory, const wisp_allocator* allocator )
{
    guide_drawing* drawing = memory;
    if ( drawing != NULL )
    {
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
        guide_drawing_release( d, allocator );
        return NULL;
    }
    return d;
}

// ---- adding ----

static wisp_status check_curves( wisp_world* world, const guide_state* s, const wisp_curves_def* def )
{
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
    const wisp_component_use use = { s->drawn, WISP_USED | WISP_REQUESTED };
    WISP_TRY( wisp_world_set_components( world, source, &use, 1 ) );
    if ( had == false )
    {
        WISP_FILL( world, source, s->drawn, uint64_t, 1 ); // curves start at 0: not drawn yet
    }
    return WISP_OK;
}

wisp_status wisp_add_curves( wisp_world* world, const wisp_curves_def* given, wisp_entity* out )
{
    if ( out != NULL )
    {
        *out = ( wisp_entity ){ 0, 0 };
    }
    wisp_curves_def values;
    const wisp_curves_def* def = &values;
    WISP_TRY( wisp_world_begin_def( world, NULL, &wisp_curves_def_fields, &values, given ) );
    WISP_TRY( wisp_world_check_pointer( world, "out", out ) );
    WISP_FIND_STATE( guide_state, s, world, "guide_hair", NULL, 0 );
    WISP_TRY( check_curves( world, s, def ) );
    guide_memory scratch = { .allocator = wisp_world_allocator( world ) };
    wisp_entity curves = { 0, 0 };
    wisp_status status = add_entity( world, def, &scratch, &curves );
    guide_give_back( &scratch );
    if ( status != WISP_OK )
    {
        return status;
    }
    guide_drawing* drawing = cook_drawing( world, def, curves );
    const bool has_room = drawing != NULL && wisp_reserve_object( s->drawings, curves );
    status = has_room ? wisp_world_attach( world, curves, s->curves )
                      : wisp_world_fail( world, WISP_NO_MEMORY, "out of memory to cook curves" );
    status = status == WISP_OK ? watch_source( world, s, def->source ) : status;
    if ( status != WISP_OK )
    {
        guide_drawing_release( drawing, wisp_world_allocator( world ) );
        wisp_world_remove( world, curves );
        return status;
    }
    double origin[3];
    (void)wisp_read_origin( world, def->source, origin );
    (void)wisp_set_origin( world, curves, origin );
    wisp_world_tie( world, def->source, curves );
    wisp_set_object( s->drawings, curves, drawing );
    *out = curves;
    return WISP_OK;
}

// ---- in between ----

// Interpolation in time (Park and Kim 2024, section II.2.2). Keeps the last two places of ghosts and the velocities of their
// targets' nodes; a place between them lies on a cubic Hermite curve.

enum
{
    GROUP_GRAIN = 16, // groups a block
    // columns of guide_hair.between
    PLACE_BEFORE = 0,
    PLACE,
    VELOCITY_BEFORE,
    VELOCITY,
    COLUMN_COUNT,
};

// ---- cooking ----

bool guide_cook_sources( guide_follower* f, const guide_groups* g )
{
    const wisp_strand_topology* t = g->ghosts->topology;
    const size_t lanes = (size_t)t->group_count * WISP_LANES;
    f->sources.lane_from = guide_take( &f->memory, lanes * (size_t)g->links, sizeof( int32_t ) );
    if ( f->memory.failed )
    {
        return false;
    }
    for ( int n = 0; n < t->group_count * g->links * WISP_LANES; ++n )
    {
        const int link = n / WISP_LANES % g->links, lane = n % WISP_LANES;
        const int ghost = t->lane_strand[n / WISP_LANES / g->links * WISP_LANES + lane];
        const int group = ghost >= 0 ? g->group[(size_t)ghost * (size_t)g->links + (size_t)link] : -1;
        f->sources.lane_from[n] = -1;
        if ( group >= 0 )
        {
            const int from = g->groups[group].lane;
            f->sources.lane_from[n] = f->guides.group_row[from / WISP_LANES] * GUIDE_ROW + from % WISP_LANES;
        }
    }
    return true;
}

// ---- a step ----

typedef struct between_loop
{
    const guide_follower* follower;
    const wisp_strand_topology* topology;
    const float* from;     // m/s, the guides' rows; null: at rest
    const float* position; // m
    float* column[COLUMN_COUNT];
} between_loop;

// Blend the velocity of a vertex with the weights of its place.
static void blend_velocity( const between_loop* loop, int group, int lane, int i, float* to )
{
    const guide_follower* f = loop->follower;
    float sum[3] = { 0.0f, 0.0f, 0.0f };
    for ( int k = 0; k < f->link_count && loop->from != NULL; ++k )
    {
        const size_t at = (size_t)( group * f->link_count + k ) * WISP_LANES + (size_t)lane;
        if ( f->sources.lane_from[at] >= 0 )
        {
            const float* v = loop->from + f->sources.lane_from[at] + (size_t)i * GUIDE_ROW;
            for ( int axis = 0; axis < 3; ++axis )
            {
                sum[axis] += f->lane_fraction[at] * v[axis * WISP_LANES];
            }
        }
    }
    for ( int axis = 0; axis < 3; ++axis )
    {
        to[axis * WISP_LANES] = sum[axis];
    }
}

static void keep_groups( void* context, int begin, int end, int worker )
{
    (void)worker;
    const between_loop* loop = context;
    const wisp_strand_topology* t = loop->topology;
    const size_t first = (size_t)t->group_row[begin] * GUIDE_ROW;
    const size_t bytes = ( (size_t)t->group_row[end] * GUIDE_ROW - first ) * sizeof( float );
    memcpy( loop->column[PLACE_BEFORE] + first, loop->column[PLACE] + first, bytes );
    memcpy( loop->column[VELOCITY_BEFORE] + first, loop->column[VELOCITY] + first, bytes );
    memcpy( loop->column[PLACE] + first, loop->position + first, bytes );
    for ( int lane = begin * WISP_LANES; lane < end * WISP_LANES; ++lane )
    {
        const int group = lane / WISP_LANES;
        float* velocity = loop->column[VELOCITY] + (size_t)t->group_row[group] * GUIDE_ROW + lane % WISP_LANES;
        for ( int i = 0; i < t->lane_count[lane]; ++i )
        {
            blend_velocity( loop, group, lane % WISP_LANES, i, velocity + (size_t)i * GUIDE_ROW );
        }
    }
}

bool guide_between_is_due( wisp_frame* frame, wisp_entity entity, void* user )
{
    (void)frame;
    return guide_active_follower( user, entity ) != NULL;
}

void guide_run_between( wisp_frame* frame, const wisp_span* span, void* user )
{
    const guide_state* state = user;
    const guide_follower* f = guide_active_follower( state, span->entity );
    between_loop loop = {
        .follower = f,
        .topology = wisp_frame_strands( frame, span->entity ),
        .position = wisp_frame_column( frame, span->entity, WISP_STRAND_POSITION, 0 ),
    };
    for ( int c = 0; c < COLUMN_COUNT; ++c )
    {
        loop.column[c] = wisp_frame_column( frame, span->entity, state->between, c );
    }
    if ( wisp_frame_has( frame, f->targets, WISP_STRAND_VELOCITY ) )
    {
        loop.from =
            f->resampled ? f->guides.velocity : wisp_frame_column( frame, f->targets, WISP_STRAND_VELOCITY, 0 );
    }
    float* seconds = wisp_frame_column( frame, span->entity, state->interval, 0 );
    *seconds = wisp_frame_dt( frame, span->entity ) * (float)wisp_frame_substeps( frame, span->entity );
    wisp_parallel_for( wisp_frame_parallel( frame, span ), loop.topology->group_count, GROUP_GRAIN, keep_groups,
                       &loop );
}

// ---- the host ----

void guide_begin_between( wisp_world* world, const guide_state* state, const guide_follower* f )
{
    const size_t bytes = (size_t)wisp_world_strands( world, f->ghosts )->row_count * GUIDE_ROW * sizeof( float );
    const float* position = wisp_world_column( world, f->ghosts, WISP_STRAND_POSITION, 0 );
    float* seconds = wisp_world_column( world, f->ghosts, state->interval, 0 );
    *seconds = 0.0f;
    for ( int c = 0; c < COLUMN_COUNT; ++c )
    {
        float* column = wisp_world_column( world, f->ghosts, state->between, c );
        if ( c == PLACE_BEFORE || c == PLACE )
        {
            memcpy( column, position, bytes );
        }
        else
        {
            memset( column, 0, bytes );
        }
    }
}

// Weights of the place before, now, and of the velocities before and now, at a fraction of the interval.
static void hermite_weights( double u, double seconds, double weight[COLUMN_COUNT] )
{
    const double u2 = u * u, u3 = u2 * u;
    weight[PLACE] = 3.0 * u2 - 2.0 * u3;
    weight[PLACE_BEFORE] = 1.0 - weight[PLACE];
    weight[VELOCITY_BEFORE] = seconds * ( u3 - 2.0 * u2 + u );
    weight[VELOCITY] = seconds * ( u3 - u2 );
}

wisp_status wisp_ghosts_between( wisp_world* world, wisp_entity ghosts, float fraction, wisp_vec3* points )
{
    WISP_FIND_STATE( const guide_state, state, world, "guide_hair", &ghosts, 0 );
    WISP_TRY( wisp_world_check_pointer( world, "points", points ) );
    const guide_follower* f = wisp_find_object( state->followers, ghosts );
    if ( f == NULL )
    {
        return wisp_world_fail( world, WISP_CONFLICT, "ghosts: entity %u has no targets", ghosts.index );
    }
    if ( f->is_between == false )
    {
        return wisp_world_fail( world, WISP_CONFLICT, "ghosts: entity %u does not store states between steps",
                                ghosts.index );
    }
    if ( !( fraction >= 0.0f && fraction <= 1.0f ) )
    {
        return wisp_world_fail( world, WISP_BAD_INPUT, "ghosts: fraction: got %g, expected 0 to 1",
                                (double)fraction );
    }
    const wisp_vec3 o = wisp_world_offset( world, ghosts );
    const double offset[3] = { (double)o.x, (double)o.y, (double)o.z };
    const wisp_strand_topology* t = wisp_world_strands( world, ghosts );
    const float* seconds = wisp_world_column( world, ghosts, state->interval, 0 );
    const float* column[COLUMN_COUNT];
    double weight[COLUMN_COUNT];
    hermite_weights( (double)fraction, (double)*seconds, weight );
    for ( int c = 0; c < COLUMN_COUNT; ++c )
    {
        column[c] = wisp_world_column( world, ghosts, state->between, c );
    }
    for ( int lane = 0; lane < t->group_count * WISP_LANES; ++lane )
    {
        size_t at = (size_t)t->group_row[lane / WISP_LANES] * GUIDE_ROW + (size_t)( lane % WISP_LANES );
        for ( int i = 0; i < t->lane_count[lane]; ++i, at += GUIDE_ROW )
        {
            double sum[3] = { 0.0, 0.0, 0.0 };
            for ( int n = 0; n < 3 * COLUMN_COUNT; ++n )
            {
                sum[n % 3] += weight[n / 3] * (double)column[n / 3][at + (size_t)( n % 3 * WISP_LANES )];
            }
            points[t->offsets[t->lane_strand[lane]] + i] =
                ( wisp_vec3 ){ (float)( sum[0] - offset[0] ), (float)( sum[1] - offset[1] ),
                               (float)( sum[2] - offset[2] ) };
        }
    }
    return WISP_OK;
}
