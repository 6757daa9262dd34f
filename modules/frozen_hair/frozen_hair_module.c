#include "frozen_hair_state.h"

#include <math.h>
#include <string.h>

// ---- depth ----

// 2.5D: how far freezing may move vertices along z, which is depth. A vertex beyond the limit is brought back to it, and its
// segment keeps its length, which is that of eq. 3, by more or less of its x and y. The rest of the strand follows by the
// same shift, so strands that stay within the limit keep their bits.

static const size_t ROW = (size_t)3 * WISP_LANES;

static float within( float z, float centre, float limit )
{
    const float low = centre - limit, high = centre + limit;
    return z < low ? low : z > high ? high : z;
}

// Factor for x and y of a segment whose z became `dz`. One that is steeper than its length allows, or has no x and y, is as
// long as its depth.
static float stretch_in_plane( float dx, float dy, float dz_before, float dz )
{
    const float across = dx * dx + dy * dy;
    const float wanted = across + dz_before * dz_before - dz * dz;
    return across > 1e-24f && wanted > 0.0f ? sqrtf( wanted / across ) : 0.0f;
}

// @param base, rows [row_count][3][16] m, of one lane
static void limit_strand( const float* base, float* rows, int row_count, float limit )
{
    float before[3] = { rows[0], rows[WISP_LANES], rows[2 * WISP_LANES] }, shift[2] = { 0.0f, 0.0f };
    float z_before = before[2];
    for ( int i = 1; i < row_count; ++i )
    {
        base += ROW;
        rows += ROW;
        const float p[3] = { rows[0], rows[WISP_LANES], rows[2 * WISP_LANES] };
        const float z = within( p[2], base[2 * WISP_LANES], limit );
        const float dx = p[0] - before[0], dy = p[1] - before[1], dz = z - z_before, dz_frozen = p[2] - before[2];
        if ( dz != dz_frozen )
        {
            const float more = stretch_in_plane( dx, dy, dz_frozen, dz ) - 1.0f;
            shift[0] += more * dx;
            shift[1] += more * dy;
        }
        rows[0] = p[0] + shift[0];
        rows[WISP_LANES] = p[1] + shift[1];
        rows[2 * WISP_LANES] = z;
        z_before = z;
        before[0] = p[0];
        before[1] = p[1];
        before[2] = p[2];
    }
}

void frozen_limit_depth( wisp_frame* frame, const wisp_span* span, void* user )
{
    const frozen_state* state = user;
    const frozen_depth* depth = wisp_frame_column( frame, span->entity, state->depth, 0 );
    const wisp_strand_topology* t = wisp_frame_strands( frame, span->entity );
    const bool posed = wisp_frame_has( frame, span->entity, WISP_STRAND_POSED );
    const float* base = wisp_frame_column( frame, span->entity, posed ? WISP_STRAND_POSED : WISP_STRAND_REST, 0 );
    float* position = wisp_frame_column( frame, span->entity, WISP_STRAND_POSITION, 0 );
    for ( int group = span->begin; group < span->end; ++group )
    {
        const size_t first = (size_t)t->group_row[group] * ROW;
        for ( int lane = 0; lane < WISP_LANES; ++lane )
        {
            limit_strand( base + first + lane, position + first + lane, t->group_row[group + 1] - t->group_row[group],
                          depth->max_change );
        }
    }
}

// ---- whole turns ----

// How strands that another module moves are turned as a whole: the rotation that takes their roots at rest closest to where
// they are now, in the sense of least squares (Horn 1987, "Closed-form solution of absolute orientation using unit
// quaternions"). A single strand cannot tell how it is turned about itself, the roots of all on a head can.

enum
{
    SWEEPS = 12, // of Jacobi's method, which converges quadratically: a 4 x 4 matrix takes six at most
};

typedef struct roots
{
    const wisp_strand_topology* t;
    const float *rest, *moved; // [row][3][16] m
} roots;

// @return false: the lane has no strand
static bool root_at( const roots* r, int lane, double rest[3], double moved[3] )
{
    const size_t at = (size_t)r->t->group_row[lane / WISP_LANES] * 3 * WISP_LANES + (size_t)( lane % WISP_LANES );
    for ( int k = 0; k < 3 && r->t->lane_count[lane] > 0; ++k )
    {
        rest[k] = (double)r->rest[at + (size_t)k * WISP_LANES];
        moved[k] = (double)r->moved[at + (size_t)k * WISP_LANES];
    }
    return r->t->lane_count[lane] > 0;
}

// Sums products of coordinates at rest and now, both from the mean root.
static void correlate( const roots* r, double sum[3][3] )
{
    const int lanes = r->t->group_count * WISP_LANES;
    double a[3], b[3], mean_a[3] = { 0 }, mean_b[3] = { 0 }, count = 0.0;
    for ( int lane = 0; lane < lanes; ++lane )
    {
        const bool is_there = root_at( r, lane, a, b );
        count += is_there;
        for ( int k = 0; k < 3 && is_there; ++k )
        {
            mean_a[k] += a[k];
            mean_b[k] += b[k];
        }
    }
    memset( sum, 0, 9 * sizeof( double ) );
    for ( int lane = 0; lane < lanes; ++lane )
    {
        const bool is_there = root_at( r, lane, a, b );
        for ( int k = 0; k < 9 && is_there; ++k )
        {
            sum[k / 3][k % 3] += ( a[k / 3] - mean_a[k / 3] / count ) * ( b[k % 3] - mean_b[k % 3] / count );
        }
    }
}

// Diagonalises a symmetric matrix by Jacobi rotations. @param v receives eigenvectors in its columns
static void diagonalise( double n[4][4], double v[4][4] )
{
    for ( int k = 0; k < 16; ++k )
    {
        v[k / 4][k % 4] = k / 4 == k % 4 ? 1.0 : 0.0;
    }
    for ( int k = 0; k < SWEEPS * 16; ++k )
    {
        const int p = k / 4 % 4, q = k % 4;
        if ( p >= q || n[p][q] == 0.0 )
        {
            continue;
        }
        const double theta = ( n[q][q] - n[p][p] ) / ( 2.0 * n[p][q] );
        const double t = ( theta < 0.0 ? -1.0 : 1.0 ) / ( fabs( theta ) + sqrt( theta * theta + 1.0 ) );
        const double c = 1.0 / sqrt( t * t + 1.0 ), s = t * c;
        for ( int i = 0; i < 4; ++i )
        {
            const double x = n[i][p], y = n[i][q], vx = v[i][p], vy = v[i][q];
            n[i][p] = c * x - s * y;
            n[i][q] = s * x + c * y;
            v[i][p] = c * vx - s * vy;
            v[i][q] = s * vx + c * vy;
        }
        for ( int i = 0; i < 4; ++i )
        {
            const double x = n[p][i], y = n[q][i];
            n[p][i] = c * x - s * y;
            n[q][i] = s * x + c * y;
        }
        n[p][q] = n[q][p] = 0.0;
    }
}

// Finds the best rotation. Where several are equally good, as with roots on a line, it is the smallest of them.
static void best_turn( double n[4][4], float turn[4] )
{
    double v[4][4], largest = -HUGE_VAL, scale = 0.0;
    diagonalise( n, v );
    for ( int k = 0; k < 4; ++k )
    {
        largest = fmax( largest, n[k][k] );
        scale = fmax( scale, fabs( n[k][k] ) );
    }

    // the projection of no rotation, or of half a turn about z, y or x, on the rotations that are equally good
    double q[4] = { 1.0, 0.0, 0.0, 0.0 }, length = 0.0;
    for ( int axis = 0; axis < 4 && length < 1e-6; ++axis )
    {
        const int from = ( 4 - axis ) % 4; // w, z, y, x
        memset( q, 0, sizeof( q ) );
        for ( int k = 0; k < 16; ++k )
        {
            const int column = k / 4, i = k % 4;
            q[i] += n[column][column] >= largest - 1e-9 * scale ? v[from][column] * v[i][column] : 0.0;
        }
        length = sqrt( q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3] );
    }
    turn[0] = (float)( q[1] / length );
    turn[1] = (float)( q[2] / length );
    turn[2] = (float)( q[3] / length );
    turn[3] = (float)( q[0] / length );
}

void frozen_find_turn( wisp_frame* frame, const wisp_span* span, void* user )
{
    const frozen_state* state = user;
    frozen_stroke* stroke = wisp_frame_column( frame, span->entity, state->stroke, 0 );
    const roots r = { wisp_frame_strands( frame, span->entity ),
                      wisp_frame_column( frame, span->entity, WISP_STRAND_REST, 0 ),
                      wisp_frame_column( frame, span->entity, WISP_STRAND_POSED, 0 ) };
    if ( r.moved == NULL )
    {
        return;
    }
    double s[3][3];
    correlate( &r, s );
    double n[4][4] = {
        { s[0][0] + s[1][1] + s[2][2], s[1][2] - s[2][1], s[2][0] - s[0][2], s[0][1] - s[1][0] },
        { s[1][2] - s[2][1], s[0][0] - s[1][1] - s[2][2], s[0][1] + s[1][0], s[2][0] + s[0][2] },
        { s[2][0] - s[0][2], s[0][1] + s[1][0], s[1][1] - s[0][0] - s[2][2], s[1][2] + s[2][1] },
        { s[0][1] - s[1][0], s[2][0] + s[0][2], s[1][2] + s[2][1], s[2][2] - s[0][0] - s[1][1] },
    };
    best_turn( n, stroke->turn );
}

// ---- module ----

static size_t row_floats( const wisp_strand_topology* t, int group )
{
    return (size_t)t->group_row[group] * 3 * WISP_LANES;
}

// ---- command: the event of this step ----

static bool command_is_due( wisp_frame* frame, wisp_entity entity, void* user )
{
    const frozen_state* state = user;
    const frozen_settings* settings = wisp_frame_column( frame, entity, state->settings, 0 );
    return settings->pending != 0 || settings->event == WISP_FROZEN_UPDATE_FRAME;
}

static void command( wisp_frame* frame, const wisp_span* span, void* user )
{
    const frozen_state* state = user;
    frozen_settings* settings = wisp_frame_column( frame, span->entity, state->settings, 0 );
    frozen_event* event = wisp_frame_column( frame, span->entity, state->event, 0 );
    wisp_frozen_hair_stats* report = wisp_frame_column( frame, span->entity, state->report, 0 );
    const frozen_stroke* stroke = wisp_frame_column( frame, span->entity, state->stroke, 0 );
    event->number = stroke != NULL ? stroke->number : settings->next;
    event->points = stroke == NULL || settings->points != 0;
    memcpy( event->cursor, settings->cursor, sizeof( event->cursor ) );
    *report = ( wisp_frozen_hair_stats ){ .event = settings->next };
    settings->next += 1;
    settings->pending = 0;
    settings->points = 0;
}

// ---- start: from the rest shape, or from the moved shape ----

static void start( wisp_frame* frame, const wisp_span* span, void* user )
{
    (void)user;
    const wisp_strand_topology* t = wisp_frame_strands( frame, span->entity );
    const bool posed = wisp_frame_has( frame, span->entity, WISP_STRAND_POSED );
    const wisp_component base = posed ? WISP_STRAND_POSED : WISP_STRAND_REST;
    const float* from = wisp_frame_column( frame, span->entity, base, 0 );
    float* position = wisp_frame_column( frame, span->entity, WISP_STRAND_POSITION, 0 );
    size_t begin = row_floats( t, span->begin ), end = row_floats( t, span->end );
    memcpy( position + begin, from + begin, ( end - begin ) * sizeof( float ) );
}

// ---- freeze: eq. 2-7 ----

static void freeze( wisp_frame* frame, const wisp_span* span, void* user )
{
    const frozen_state* state = user;
    const frozen_settings* settings = wisp_frame_column( frame, span->entity, state->settings, 0 );
    const frozen_event* event = wisp_frame_column( frame, span->entity, state->event, 0 );
    const frozen_freeze* f = wisp_frame_column( frame, span->entity, state->freeze, 0 );
    const wisp_strand_topology* t = wisp_frame_strands( frame, span->entity );
    wisp_strand_jitter_args args = {
        .group_row = t->group_row,
        .lane_strand = t->lane_strand,
        .rest = wisp_frame_column( frame, span->entity, WISP_STRAND_REST, 0 ),
        .position = wisp_frame_column( frame, span->entity, WISP_STRAND_POSITION, 0 ),
        .stretch = wisp_frame_column( frame, span->entity, WISP_STRAND_STIFFNESS, 0 ),
        .bend = wisp_frame_column( frame, span->entity, WISP_STRAND_STIFFNESS, 1 ),
        .length_key = wisp_random_make_key( settings->seed, FROZEN_STREAM_LENGTH, event->number ),
        .angle_key = wisp_random_make_key( settings->seed, FROZEN_STREAM_ANGLE, event->number ),
        .axis_key = wisp_random_make_key( settings->seed, FROZEN_STREAM_AXIS, 0 ),
        .angle_max = f->bend_angle_max,
        .dimension = t->dimension,
        .in_plane = wisp_frame_has( frame, span->entity, state->depth ),
    };
    wisp_frame_kernels( frame )->strand_jitter( &args, span->begin, span->end );
}

// ---- align: eq. 8-13; with base stroke, strands keep their turns ----

static void align( wisp_frame* frame, const wisp_span* span, void* user )
{
    const frozen_state* state = user;
    const frozen_event* event = wisp_frame_column( frame, span->entity, state->event, 0 );
    const frozen_align* a = wisp_frame_column( frame, span->entity, state->align, 0 );
    const wisp_strand_topology* t = wisp_frame_strands( frame, span->entity );
    const wisp_vec3 cursor = { event->cursor[0], event->cursor[1], event->cursor[2] };
    const bool in_plane = t->dimension == 2 || wisp_frame_has( frame, span->entity, state->depth );
    wisp_strand_align_args args = {
        .group_row = t->group_row,
        .lane_count = t->lane_count,
        .position = wisp_frame_column( frame, span->entity, WISP_STRAND_POSITION, 0 ),
        .intensity = wisp_frame_column( frame, span->entity, state->intensity, 0 ),
        .target = wisp_to_rows( cursor, wisp_frame_offset( frame, span->entity ) ),
        .radius = event->points ? a->reach : -1.0f,
        .nearest = a->reach_nearest != 0,
        .dimension = in_plane ? 2 : 3,
        .in_plane = in_plane,
        .swept = wisp_frame_column( frame, span->entity, state->swept, 0 ),
    };
    if ( args.swept != NULL && wisp_frame_has( frame, span->entity, WISP_STRAND_POSED ) )
    {
        const frozen_stroke* stroke = wisp_frame_column( frame, span->entity, state->stroke, 0 );
        args.rest = wisp_frame_column( frame, span->entity, WISP_STRAND_REST, 0 );
        args.moved = wisp_frame_column( frame, span->entity, WISP_STRAND_POSED, 0 );
        memcpy( args.turn, stroke->turn, sizeof( args.turn ) );
    }
    wisp_frame_kernels( frame )->strand_align( &args, span->begin, span->end );
}

// ---- declaration ----

FROZEN_COMPONENTS( WISP_COMPONENT_COLUMNS )

static wisp_status declare_stages( wisp_registry* r, frozen_state* s )
{
    const wisp_pass passes[] = {
        {
            WISP_PASS( "frozen_hair.command", INPUT, ENTITY, command ),
            .required = { s->settings },
            .reads = { s->settings },
            .writes = { s->event },
            .detail = WISP_PASS_WITHOUT_MOTION,
            .should_run = command_is_due,
        },
        {
            WISP_PASS( "frozen_hair.start", SHAPE, STRAND_GROUP, start ),
            .required = { s->settings, WISP_STRAND_REST },
            .reads = { s->event, WISP_STRAND_REST },
            .writes = { WISP_STRAND_POSITION },
            .detail = WISP_PASS_WITHOUT_MOTION,
            .on_change = s->event,
        },
        {
            WISP_PASS( "frozen_hair.freeze", SHAPE, STRAND_GROUP, freeze ),
            .required = { s->freeze },
            .reads = { s->event, WISP_STRAND_STIFFNESS, WISP_STRAND_REST, WISP_STRAND_POSITION },
            .writes = { WISP_STRAND_POSITION },
            .detail = WISP_PASS_WITHOUT_MOTION,
            .on_change = s->event,
        },
        {
            WISP_PASS( "frozen_hair.depth", SHAPE, STRAND_GROUP, frozen_limit_depth ),
            .required = { s->freeze, s->depth },
            .reads = { s->event, WISP_STRAND_REST, WISP_STRAND_POSITION },
            .writes = { WISP_STRAND_POSITION },
            .detail = WISP_PASS_WITHOUT_MOTION,
            .on_change = s->event,
        },
        {
            WISP_PASS( "frozen_hair.align", SHAPE, STRAND_GROUP, align ),
            .required = { s->align },
            .excluded = { s->swept },
            .reads = { s->event, s->intensity, WISP_STRAND_POSITION },
            .writes = { WISP_STRAND_POSITION },
            .detail = WISP_PASS_WITHOUT_MOTION,
            .on_change = s->event,
        },
        {
            // It reads the moved shape too, where there is one. Positions put it behind the start, which waits for what moves it.
            WISP_PASS( "frozen_hair.turn", SHAPE, ENTITY, frozen_find_turn ),
            .required = { s->align, s->swept },
            .reads = { s->event, WISP_STRAND_REST, WISP_STRAND_POSITION },
            .writes = { s->stroke },
            .detail = WISP_PASS_WITHOUT_MOTION,
            .on_change = s->event,
        },
        {
            WISP_PASS( "frozen_hair.stroke", SHAPE, STRAND_GROUP, align ),
            .required = { s->align, s->swept },
            .reads = { s->event, s->stroke, s->intensity, WISP_STRAND_REST, WISP_STRAND_POSITION },
            .writes = { s->swept, WISP_STRAND_POSITION },
            .detail = WISP_PASS_WITHOUT_MOTION,
            .on_change = s->event,
        },
        {
            WISP_PASS( "frozen_hair.clump", SHAPE, ENTITY, frozen_clump_run ),
            .required = { s->clump },
            .reads = { s->event, WISP_STRAND_POSITION },
            .writes = { WISP_STRAND_POSITION, s->report },
            .detail = WISP_PASS_WITHOUT_MOTION,
            .on_change = s->event,
        },
    };
    return wisp_declare_passes( r, passes, WISP_COUNT( passes ), s );
}

static wisp_status declare( wisp_registry* r )
{
    frozen_state* s = wisp_declare_state( r, sizeof( frozen_state ) );
    if ( s == NULL )
    {
        return WISP_NO_MEMORY;
    }
    FROZEN_COMPONENTS( WISP_COMPONENT_DECLARE )
    const wisp_index_range ranges[] = {
        WISP_MEMBER_RANGE( s->settings, frozen_settings, base, 0, WISP_FROZEN_BASE_COUNT - 1 ),
        WISP_MEMBER_RANGE( s->settings, frozen_settings, event, 0, WISP_FROZEN_UPDATE_COUNT - 1 ),
        WISP_MEMBER_RANGE( s->settings, frozen_settings, pending, 0, 1 ),
        WISP_MEMBER_RANGE( s->settings, frozen_settings, points, 0, 1 ),
        WISP_MEMBER_RANGE( s->event, frozen_event, points, 0, 1 ),
        WISP_MEMBER_RANGE( s->align, frozen_align, reach_nearest, 0, 1 ),
        WISP_MEMBER_RANGE( s->clump, frozen_clump, iterations, 0, 1000 ),
        WISP_MEMBER_RANGE( s->clump, frozen_clump, brakes, 0, 1 ),
        WISP_MEMBER_RANGE( s->clump, frozen_clump, neighbour_limit, 1, 4096 ),
    };
    WISP_TRY( wisp_declare_indices( r, ranges, WISP_COUNT( ranges ) ) );
    s->workspace = wisp_declare_workspace( r, frozen_clump_workspace_size(), frozen_clump_workspace_release,
                                           frozen_clump_workspace_bytes );
    return s->workspace < 0 ? WISP_NO_MEMORY : declare_stages( r, s );
}

const wisp_module wisp_frozen_hair_module = { .name = "frozen_hair", .declare = declare };
