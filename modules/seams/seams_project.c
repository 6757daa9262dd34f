// The pass. In: predicted positions of the surfaces. Out: positions with seams, which pairs broke.
//
// With d = x_a - x_b, n = d / |d|, L the distance that the pair holds now, w inverse masses, a = compliance / dt^2 and p the impulse
// that the vertex of `a` has received in the substep (Macklin, Mueller, Chentanez 2016, eq. 17-18):
//
//   L > 0:  dp = -( |d| - L + a n.p ) / ( w_a + w_b + a ) n
//   L = 0:  dp = -( d + a p ) / ( w_a + w_b + a )            in which no direction has to be divided by |d|
//   x_a += w_a dp,  x_b -= w_b dp
//
// The force of a pair is p / dt^2. Seams are projected in the order of their entities, each colour by colour, so results do not
// depend on the number of workers. A solver of velocities has moved its particles already: what moves them on is added
// to their velocities.
#include "seams_state.h"

#include <math.h>
#include <string.h>

// ---- pairs ----

// Pairs of a seam. In: pairs of vertices, or how near boundaries have to be. Out: slots in the order of colours.
//
// A vertex is on the boundary if more edges than triangles meet at it. Colours are greedy, in the order of the pairs: the lowest one
// that neither vertex has yet.

static wisp_status out_of_memory( wisp_world* world )
{
    return wisp_world_fail( world, WISP_NO_MEMORY, "out of memory for the pairs of a seam" );
}

// ---- pairs of boundaries ----

// Vertices on the boundary of a surface, by slot.
typedef struct boundary
{
    const wisp_fabric* fabric;
    const float* position; // [slot][4]
    int32_t* slots;        // [count]
    int count;
} boundary;

static void find_boundary( boundary* b, int32_t* balance )
{
    const wisp_fabric* f = b->fabric;
    memset( balance, 0, (size_t)f->slot_count * sizeof( int32_t ) );
    for ( int i = 0; i < 2 * f->edge_count; ++i )
    {
        balance[f->edges[i]] += 1;
    }
    for ( int i = 0; i < 3 * f->triangle_count; ++i )
    {
        balance[f->triangles[i]] -= 1;
    }
    b->count = 0;
    for ( int v = 0; v < f->vertex_count; ++v ) // in the user's order
    {
        const int32_t slot = f->vertex_slot[v];
        if ( balance[slot] > 0 )
        {
            b->slots[b->count++] = slot;
        }
    }
}

static float distance2( const float* p, const float* q )
{
    const float x = p[0] - q[0], y = p[1] - q[1], z = p[2] - q[2];
    return x * x + y * y + z * z;
}

// @return the slot on the boundary that is nearest within a distance, the first of those equally near; -1: there is none
static int32_t find_nearest( const boundary* b, const float* point, float within )
{
    int32_t nearest = -1;
    float best = within * within;
    for ( int i = 0; i < b->count; ++i )
    {
        const float d2 = distance2( point, b->position + (size_t)b->slots[i] * 4 );
        if ( d2 < best || ( d2 == best && nearest < 0 ) )
        {
            best = d2;
            nearest = b->slots[i];
        }
    }
    return nearest;
}

// Pair each boundary vertex of `a` with the nearest one of `b`, and the other way round, each pair once.
// @param pairs [a->count + b->count][2] receives vertices in the user's order
static int pair_boundaries( const boundary* a, const boundary* b, float within, int32_t* pairs )
{
    int count = 0;
    for ( int i = 0; i < a->count; ++i )
    {
        const int32_t slot = find_nearest( b, a->position + (size_t)a->slots[i] * 4, within );
        if ( slot >= 0 )
        {
            pairs[2 * count] = a->fabric->slot_vertex[a->slots[i]];
            pairs[2 * count + 1] = b->fabric->slot_vertex[slot];
            count += 1;
        }
    }
    for ( int i = 0; i < b->count; ++i )
    {
        const float* point = b->position + (size_t)b->slots[i] * 4;
        const int32_t slot = find_nearest( a, point, within );
        if ( slot >= 0 &&
             find_nearest( b, a->position + (size_t)slot * 4, within ) != b->slots[i] ) // that pair is listed
        {
            pairs[2 * count] = a->fabric->slot_vertex[slot];
            pairs[2 * count + 1] = b->fabric->slot_vertex[b->slots[i]];
            count += 1;
        }
    }
    return count;
}

// ---- colours ----

static int lowest_free( uint64_t taken )
{
    int colour = 0;
    while ( colour < SEAM_COLOURS - 1 && ( taken >> colour & 1 ) != 0 )
    {
        colour += 1;
    }
    return colour;
}

// @param masks [slots of a] or [slots of a, slots of b], zero @param colours [pair_count] receives the colour of each pair
static void colour_pairs( const int32_t* ends_x4, int pair_count, uint64_t* masks, size_t first_b, uint8_t* colours )
{
    for ( int p = 0; p < pair_count; ++p )
    {
        uint64_t *a = masks + ends_x4[2 * p] / 4, *b = masks + first_b + ends_x4[2 * p + 1] / 4;
        const int colour = lowest_free( *a | *b );
        *a |= UINT64_C( 1 ) << colour;
        *b |= UINT64_C( 1 ) << colour;
        colours[p] = (uint8_t)colour;
    }
}

static void order_pairs( seam_topology* s, const int32_t* given_x4, const uint8_t* colours )
{
    int next[SEAM_COLOURS] = { 0 };
    for ( int p = 0; p < s->pair_count; ++p )
    {
        s->colour_begin[colours[p] + 1] += 1;
    }
    for ( int c = 0; c < SEAM_COLOURS; ++c )
    {
        s->colour_count = s->colour_begin[c + 1] > 0 ? c + 1 : s->colour_count;
        s->colour_begin[c + 1] += s->colour_begin[c];
        next[c] = s->colour_begin[c];
    }
    for ( int p = 0; p < s->pair_count; ++p )
    {
        const int row = next[colours[p]]++;
        s->ends_x4[2 * row] = given_x4[2 * p];
        s->ends_x4[2 * row + 1] = given_x4[2 * p + 1];
    }
}

// ---- cooking ----

static wisp_status check_pair( wisp_world* world, const wisp_fabric* const fabrics[2], const int32_t* pair,
                               int number )
{
    for ( int k = 0; k < 2; ++k )
    {
        if ( pair[k] < 0 || pair[k] >= fabrics[k]->vertex_count )
        {
            return wisp_world_fail( world, WISP_BAD_INPUT,
                                    "seams: pair %d: got vertex %d of surface %c, which has %d vertices", number,
                                    pair[k], "ab"[k], fabrics[k] -> vertex_count );
        }
    }
    return WISP_OK;
}

static wisp_status check_pairs( wisp_world* world, const wisp_seam_def* def, const wisp_fabric* const fabrics[2] )
{
    const bool is_same = wisp_entity_equal( def->a, def->b );
    for ( int p = 0; p < def->pair_count; ++p )
    {
        const int32_t* pair = def->pairs + 2 * (size_t)p;
        WISP_TRY( check_pair( world, fabrics, pair, p ) );
        if ( is_same && pair[0] == pair[1] )
        {
            return wisp_world_fail( world, WISP_BAD_INPUT, "seams: pair %d: got vertex %d twice", p, pair[0] );
        }
    }
    return WISP_OK;
}

static wisp_status cook( wisp_world* world, const wisp_seam_def* def, const wisp_fabric* const fabrics[2],
                         seam_topology** out )
{
    WISP_TRY( check_pairs( world, def, fabrics ) );
    const wisp_allocator* allocator = wisp_world_allocator( world );
    const seam_topology first = { .a = def->a, .b = def->b, .pair_count = def->pair_count };
    const size_t first_b = wisp_entity_equal( def->a, def->b ) ? 0 : (size_t)fabrics[0]->slot_count,
                 slots = first_b + (size_t)fabrics[1]->slot_count, pairs = (size_t)def->pair_count;
    // masks of the vertices, slots of the pairs, their colours
    const size_t bytes = slots * sizeof( uint64_t ) + pairs * ( 2 * sizeof( int32_t ) + 1 );
    uint64_t* masks = allocator->allocate( allocator->user, bytes, sizeof( uint64_t ) );
    seam_topology* s = allocator->allocate( allocator->user, seams_bytes( &first ), sizeof( uint64_t ) );
    if ( masks == NULL || s == NULL )
    {
        wisp_release( allocator, s, seams_bytes( &first ) );
        wisp_release( allocator, masks, bytes );
        return out_of_memory( world );
    }
    int32_t* given_x4 = (int32_t*)( masks + slots );
    uint8_t* colours = (uint8_t*)( given_x4 + 2 * pairs );
    memset( masks, 0, slots * sizeof( uint64_t ) );
    for ( int i = 0; i < 2 * def->pair_count; ++i )
    {
        given_x4[i] = 4 * fabrics[i % 2]->vertex_slot[def->pairs[i]];
    }
    *s = first;
    colour_pairs( given_x4, s->pair_count, masks, first_b, colours );
    order_pairs( s, given_x4, colours );
    allocator->release( allocator->user, masks, bytes );
    *out = s;
    return WISP_OK;
}

static wisp_status cook_found( wisp_world* world, const wisp_seam_def* def, const boundary sides[2], int32_t* pairs,
                               seam_topology** out )
{
    wisp_seam_def found = *def;
    found.pairs = pairs;
    found.pair_count = pair_boundaries( sides, sides + 1, def->within, pairs );
    if ( found.pair_count == 0 )
    {
        return wisp_world_fail( world, WISP_BAD_INPUT,
                                "seams: no boundary vertex of one surface is within %g m of one of the other",
                                (double)def->within );
    }
    const wisp_fabric* const fabrics[2] = { sides[0].fabric, sides[1].fabric };
    return cook( world, &found, fabrics, out );
}

// Find pairs before cooking. Temporary memory: boundaries of both surfaces, pairs, a balance of edges and triangles by slot.
static wisp_status cook_within( wisp_world* world, const wisp_seam_def* def, const wisp_fabric* const fabrics[2],
                                seam_topology** out )
{
    WISP_TRY( wisp_world_need_fabric( world, def->a, WISP_FABRIC_EDGES ) );
    WISP_TRY( wisp_world_need_fabric( world, def->b, WISP_FABRIC_EDGES ) );
    const size_t most = (size_t)fabrics[0]->slot_count + (size_t)fabrics[1]->slot_count,
                 bytes = 4 * most * sizeof( int32_t );
    const wisp_allocator* allocator = wisp_world_allocator( world );
    int32_t* memory = allocator->allocate( allocator->user, bytes, sizeof( int32_t ) );
    if ( memory == NULL )
    {
        return out_of_memory( world );
    }
    boundary sides[2];
    for ( int k = 0; k < 2; ++k )
    {
        sides[k] =
            ( boundary ){ .fabric = fabrics[k],
                          .position = wisp_world_column( world, k == 0 ? def->a : def->b, WISP_PARTICLE_POSITION, 0 ),
                          .slots = memory + ( k == 0 ? 0 : (size_t)fabrics[0]->slot_count ) };
        find_boundary( sides + k, memory + 3 * most );
    }
    const wisp_status status = cook_found( world, def, sides, memory + most, out );
    allocator->release( allocator->user, memory, bytes );
    return status;
}

wisp_status seams_cook_pairs( wisp_world* world, const wisp_seam_def* def, seam_topology** out )
{
    const wisp_fabric* const fabrics[2] = { wisp_world_fabric( world, def->a ), wisp_world_fabric( world, def->b ) };
    return def->within > 0.0f ? cook_within( world, def, fabrics, out ) : cook( world, def, fabrics, out );
}

// ---- projection ----

enum
{
    PAIR_GRAIN = 512, // pairs per block
};

// m^2: pairs farther apart, and those whose distance is not finite, are left alone. The engine halts the surface that strayed, and the
// other one does not see its numbers.
static const float FARTHEST2 = 1e12f;

// One of the two surfaces.
typedef struct seam_side
{
    float* position; // [slot][4]
    float* velocity; // [slot][4] of a surface that a solver of velocities has moved; null otherwise
    float mobility;  // 0: the surface is halted
} seam_side;

typedef struct seam_loop
{
    seam_side side[2];
    const int32_t* ends_x4;
    float *rest, *impulse;
    int32_t* broken;
    seam_settings settings;
    float alpha;      // m^2/(N s^2)
    float inverse_dt; // 1/s
    float closing;    // m, in the substep
    bool is_first;
    int first_row; // of the colour
} seam_loop;

static void move_end( const seam_side* side, int32_t x4, const float change[3], float weight, float inverse_dt )
{
    for ( int k = 0; k < 3; ++k )
    {
        side->position[x4 + k] += weight * change[k];
        if ( side->velocity != NULL )
        {
            side->velocity[x4 + k] += weight * change[k] * inverse_dt;
        }
    }
}

// Bring the distance that a pair holds nearer to that of the seam.
static float approach( float rest, float distance, float step )
{
    return rest > distance ? fmaxf( rest - step, distance ) : fminf( rest + step, distance );
}

static float dot( const float* a, const float* b )
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void project_pair( const seam_loop* loop, int row )
{
    const int32_t a = loop->ends_x4[2 * row], b = loop->ends_x4[2 * row + 1];
    const float *xa = loop->side[0].position + a, *xb = loop->side[1].position + b;
    const float wa = loop->side[0].mobility * xa[3], wb = loop->side[1].mobility * xb[3], rest = loop->rest[row];
    const float d[3] = { xa[0] - xb[0], xa[1] - xb[1], xa[2] - xb[2] }, length2 = dot( d, d );
    float* p = loop->impulse + 3 * (size_t)row;
    if ( wa + wb == 0.0f || !( length2 <= FARTHEST2 ) || ( rest > 0.0f && length2 == 0.0f ) )
    {
        return; // the last: it has no direction
    }
    const float scale = -1.0f / ( wa + wb + loop->alpha );
    float change[3];
    if ( rest > 0.0f )
    {
        const float length = sqrtf( length2 );
        const float excess = length - rest + loop->alpha * dot( d, p ) / length;
        for ( int k = 0; k < 3; ++k )
        {
            change[k] = scale * excess * ( d[k] / length );
        }
    }
    else
    {
        for ( int k = 0; k < 3; ++k )
        {
            change[k] = scale * ( d[k] + loop->alpha * p[k] );
        }
    }
    for ( int k = 0; k < 3; ++k )
    {
        p[k] += change[k];
    }
    move_end( loop->side, a, change, wa, loop->inverse_dt );
    move_end( loop->side + 1, b, change, -wb, loop->inverse_dt );
}

float seams_pull( const float impulse[3], const float d[3], float rest, float inverse_dt2 )
{
    const float force = sqrtf( dot( impulse, impulse ) ) * inverse_dt2;
    return rest > 0.0f && dot( impulse, d ) > 0.0f ? -force : force;
}

static float pull_of( const seam_loop* loop, int row )
{
    const float *xa = loop->side[0].position + loop->ends_x4[2 * row],
                *xb = loop->side[1].position + loop->ends_x4[2 * row + 1];
    const float d[3] = { xa[0] - xb[0], xa[1] - xb[1], xa[2] - xb[2] };
    return seams_pull( loop->impulse + 3 * (size_t)row, d, loop->rest[row], loop->settings.inverse_dt2 );
}

static void project_rows( void* context, int begin, int end, int worker )
{
    (void)worker;
    const seam_loop* loop = context;
    for ( int row = loop->first_row + begin; row < loop->first_row + end; ++row )
    {
        if ( loop->broken[row] != 0 )
        {
            continue;
        }
        if ( loop->is_first )
        {
            loop->rest[row] = approach( loop->rest[row], loop->settings.distance, loop->closing );
            loop->impulse[3 * row] = loop->impulse[3 * row + 1] = loop->impulse[3 * row + 2] = 0.0f;
        }
        project_pair( loop, row );
    }
}

// Break the pairs that are pulled by more than the strength.
static void break_rows( void* context, int begin, int end, int worker )
{
    (void)worker;
    const seam_loop* loop = context;
    for ( int row = begin; row < end; ++row )
    {
        if ( loop->broken[row] == 0 && pull_of( loop, row ) > loop->settings.strength )
        {
            loop->broken[row] = 1;
            loop->impulse[3 * row] = loop->impulse[3 * row + 1] = loop->impulse[3 * row + 2] = 0.0f;
        }
    }
}

static seam_side open_side( wisp_frame* frame, wisp_entity surface )
{
    const bool is_halted = wisp_frame_is_halted( frame, surface );
    const bool is_external = is_halted == false && wisp_frame_has( frame, surface, WISP_PARTICLE_EXTERNAL_SOLVER );
    return ( seam_side ){
        .position = wisp_frame_column( frame, surface, WISP_PARTICLE_POSITION, 0 ),
        .velocity = is_external ? wisp_frame_column( frame, surface, WISP_PARTICLE_VELOCITY, 0 ) : NULL,
        .mobility = is_halted ? 0.0f : 1.0f,
    };
}

static void project_seam( wisp_frame* frame, const wisp_span* span, const seams_state* state, const seam_topology* s )
{
    const wisp_parallel* parallel = wisp_frame_parallel( frame, span );
    seam_settings* settings = wisp_frame_column( frame, s->entity, state->settings, 0 );
    const float dt = wisp_frame_dt( frame, span->entity ), inverse_dt = 1.0f / dt;
    settings->inverse_dt2 = inverse_dt * inverse_dt;
    seam_loop loop = {
        .side = { open_side( frame, s->a ), open_side( frame, s->b ) },
        .ends_x4 = s->ends_x4,
        .rest = wisp_frame_column( frame, s->entity, state->pairs, 0 ),
        .impulse = wisp_frame_column( frame, s->entity, state->pairs, 1 ),
        .broken = wisp_frame_column( frame, s->entity, state->pairs, 2 ),
        .settings = *settings,
        .alpha = settings->compliance * settings->inverse_dt2,
        .inverse_dt = inverse_dt,
        .closing = settings->closing_speed * dt,
        .is_first = span->iteration == 0,
    };
    for ( int c = 0; c < s->colour_count; ++c )
    {
        const int count = s->colour_begin[c + 1] - s->colour_begin[c];
        loop.first_row = s->colour_begin[c];
        wisp_parallel_for( parallel, count, c == SEAM_COLOURS - 1 ? count : PAIR_GRAIN, project_rows, &loop );
    }
    if ( settings->strength < INFINITY && span->iteration + 1 == wisp_frame_iterations( frame ) )
    {
        wisp_parallel_for( parallel, s->pair_count, PAIR_GRAIN, break_rows, &loop );
    }
}

void seams_project( wisp_frame* frame, const wisp_span* span, void* user )
{
    const seams_state* state = user;
    const seam_topology* s;
    for ( int place = 0; ( s = wisp_next_object( state->seams, &place ) ) != NULL; )
    {
        if ( s->a.index != 0 )
        {
            project_seam( frame, span, state, s );
        }
    }
}
