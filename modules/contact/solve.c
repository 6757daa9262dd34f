// Projection of contact constraints (position based dynamics, Mueller et al. 2007), accumulated and clamped as the
// impulses of Catto 2005. In: rows by colour. Out: moved points, accumulated corrections.
//
// - Push: Dx_i = w_i s_i n l with l = -C / max( sum w_j s_j^2, max w_j |s_j| / 4 ), accumulated in
//   `normal_impulse`, which is never negative. The weights of a row sum to zero, so every correction keeps
//   momentum, and forces on two participants are equal and opposite.
// - Friction takes back the relative tangential displacement of the closest points since the start of the substep,
//   accumulated in `tangential_impulse`, which is never longer than mu times the push (Coulomb).
// - A substep begins with the impulses of the one before (warm start). A sweep goes one layer down a pile; with what is
//   remembered, its weight is with the ground after as many substeps, and it comes to rest.
// - What a body presses on has no mobility along its normal, and bodies have a turn after each sweep, with friction
//   (kernel half_space): bodies win, and their friction feels the load.
// - Recovery parts pairs that are nearer than their gap at `max_push_out_speed`. The previous positions move too: no
//   velocity.
#include "solve.h"

#include "constraints.h"

#include "wisp/module/kernels.h"

#include <string.h>

enum
{
    MAX_LEVER = 4,   // a correction moves no point by more than this many times what the sides lack
    KEPT_LEVER = 64, // beyond, an impulse is not kept: it would throw the point
    BODY_GRAIN = 256,
    WARM_GRAIN = 256,
    ROWS_PER_BLOCK = 64, // bits of a mask
};

// Pairs that press recover up to this fraction of the gap. If they went on, those of a pile would part each other for ever.
static const float PRESSED_GAP = 0.98f;

// A row within so little of its requested distance may have pressed in the substep before.
static const float WARM_GAP = 2.0f;

// A row lacks less than this to press: turns run it.
static const float NEAR_GAP = 0.25f;

// Square of a cosine above which a body holds a point whole.
static const float HELD = 0.99f;
// Of its gap: how far off a half space a point is lifted.
static const float LIFTED = 0.01f;

// Run a row. @return whether it presses, or is nearer to pressing than its gap
typedef bool row_fn( const contact_work* work, contact_row* row );

// Which rows of a block a sweep runs.
typedef enum sweep_rows
{
    ALL_ROWS,
    FOUND_ROWS, // all, and notes which are near
    NEAR_ROWS,  // those that were near in the last sweep that noted it
} sweep_rows;

typedef struct project_loop
{
    const contact_work* work;
    const int32_t* order;
    row_fn* run;
    sweep_rows rows;
} project_loop;

// Return the distance of the two sides along the normal. Sums are relative to one of the points, against
// cancellation.
static inline float distance_of( const float* xyzw, const contact_row* row )
{
    const float* o = xyzw + (size_t)row->point[CONTACT_MAX_POINTS - 1] * 4;
    float d[3] = { 0.0f, 0.0f, 0.0f };
    for ( int i = 0; i + 1 < CONTACT_MAX_POINTS; ++i )
    {
        const float* p = xyzw + (size_t)row->point[i] * 4;
        for ( int k = 0; k < 3; ++k )
        {
            d[k] += row->weight[i] * ( p[k] - o[k] );
        }
    }
    return row->normal[0] * d[0] + row->normal[1] * d[1] + row->normal[2] * d[2];
}

// Find how far the first side moved relative to the second, along the plane.
static void find_slip( const contact_contact_mesh* s, const contact_row* row, float slip[3] )
{
    float along = 0.0f;
    memset( slip, 0, 3 * sizeof( float ) );
    for ( int i = 0; i < CONTACT_MAX_POINTS; ++i )
    {
        const float *p = s->now + (size_t)row->point[i] * 4, *q = s->intersection_free + (size_t)row->point[i] * 4;
        for ( int k = 0; k < 3; ++k )
        {
            slip[k] += row->weight[i] * ( p[k] - q[k] );
        }
    }
    for ( int k = 0; k < 3; ++k )
    {
        along += row->normal[k] * slip[k];
    }
    for ( int k = 0; k < 3; ++k )
    {
        slip[k] -= along * row->normal[k];
    }
}

// ---- what bodies hold ----

// Return the half space that holds a point of a row, as a row of the kernel half_space, null if none presses on it.
static inline float* hold_of( const contact_contact_mesh* s, const contact_row* row, int i )
{
    float* half = s->colouring->hold[row->point[i]];
    return half != NULL && half[10] > 0.0f && row->is_squeezed == false ? half : NULL;
}

// Between two sides that bodies hold, what is left of the mobility would throw them aside: bodies do not count.
static void note_squeezed( const contact_contact_mesh* s, contact_row* row )
{
    float held[2] = { 0.0f, 0.0f };
    row->is_squeezed = false;
    for ( int i = 0; i < CONTACT_MAX_POINTS; ++i )
    {
        held[i < row->split ? 0 : 1] += hold_of( s, row, i ) != NULL ? fabsf( row->weight[i] ) : 0.0f;
    }
    row->is_squeezed = held[0] > 0.5f && held[1] > 0.5f;
}

// Return the mobility of a row in a direction, 1/kg: sum w s^2, without what is held along the normal of its body, but
// at least max w |s| / MAX_LEVER. Where the only free point of a triangle is far from the contact, s is small, and a
// correction over sum w s^2 would throw it.
// @param is_lever receives whether a point is a long lever; may be null
static float mobility_along( const contact_contact_mesh* s, const contact_row* row, const float direction[3],
                             bool* is_lever )
{
    float sum = 0.0f, farthest = 0.0f;
    for ( int i = 0; i < CONTACT_MAX_POINTS; ++i )
    {
        const float fraction = s->now[(size_t)row->point[i] * 4 + 3] * row->weight[i];
        const float* half = hold_of( s, row, i );
        const float along = half != NULL ? contact_dot( half + 3, direction ) : 0.0f;
        const float free = along * along < HELD ? 1.0f - along * along : 0.0f;
        sum += fraction * row->weight[i] * free;
        farthest = contact_larger( farthest, fabsf( fraction ) * sqrtf( free ) );
    }
    if ( is_lever != NULL )
    {
        *is_lever = sum < farthest / KEPT_LEVER;
    }
    return contact_larger( sum, farthest / MAX_LEVER );
}

// Move the points of a row by an impulse. What presses a point against the half space that holds it goes to its
// correction instead. @param recovers without velocity
static void push( contact_contact_mesh* s, const contact_row* row, const float impulse[3], bool recovers )
{
    for ( int i = 0; i < CONTACT_MAX_POINTS; ++i )
    {
        const size_t at = (size_t)row->point[i] * 4;
        const float fraction = s->now[at + 3] * row->weight[i];
        float by[3] = { fraction * impulse[0], fraction * impulse[1], fraction * impulse[2] };
        float* half = hold_of( s, row, i );
        if ( half != NULL )
        {
            const float into = -contact_dot( half + 3, by ),
                        held = contact_larger( into, recovers ? 0.0f : -half[10] );
            half[10] += recovers ? 0.0f : held;
            for ( int k = 0; k < 3; ++k )
            {
                by[k] += held * half[3 + k];
            }
        }
        for ( size_t k = 0; k < 3; ++k )
        {
            s->now[at + k] += by[k];
            s->shift[at + k] += recovers ? by[k] : 0.0f;
        }
    }
}

// ---- rows ----

// Find the tangential impulse that takes back slip, up to the friction of the row, and add it to those of the row.
static void add_friction( const contact_contact_mesh* s, contact_row* row, float by[3] )
{
    const float most = row->friction * row->normal_impulse;
    float slip[3], direction[3], wanted[3];
    find_slip( s, row, slip );
    const float length = sqrtf( contact_dot( slip, slip ) );
    for ( int k = 0; k < 3; ++k )
    {
        direction[k] = length > 0.0f ? slip[k] / length : 0.0f;
    }
    const float mobility = mobility_along( s, row, direction, NULL ),
                taken = mobility > 0.0f ? length / mobility : 0.0f;
    for ( int k = 0; k < 3; ++k )
    {
        wanted[k] = row->tangential_impulse[k] - taken * direction[k];
    }
    const float squared = contact_dot( wanted, wanted ),
                scale = squared > most * most ? most / sqrtf( squared ) : 1.0f;
    for ( int k = 0; k < 3; ++k )
    {
        by[k] += scale * wanted[k] - row->tangential_impulse[k];
        row->tangential_impulse[k] = scale * wanted[k];
    }
}

static bool project_row( const contact_work* work, contact_row* row )
{
    contact_contact_mesh* s = work->contact_mesh;
    const float short_by = row->gap - distance_of( s->now, row );
    if ( !( short_by > 0.0f || row->normal_impulse > 0.0f ) )
    {
        return short_by > -NEAR_GAP * row->requested;
    }
    note_squeezed( s, row );
    const float mobility = mobility_along( s, row, row->normal, &row->is_lever );
    if ( !( mobility > 0.0f ) )
    {
        return true;
    }
    const float impulse = contact_larger( 0.0f, row->normal_impulse + short_by / mobility ),
                change = impulse - row->normal_impulse;
    float by[3] = { change * row->normal[0], change * row->normal[1], change * row->normal[2] };
    row->normal_impulse = impulse;
    if ( row->friction > 0.0f )
    {
        add_friction( s, row, by );
    }
    push( s, row, by, false );
    return true;
}

static bool recover_row( const contact_work* work, contact_row* row )
{
    contact_contact_mesh* s = work->contact_mesh;
    const contact_participant* participant = contact_participant_of( work, row->point[0] );
    const float step = participant->settings.max_push_out_speed * work->seconds;
    const float gap = row->normal_impulse > 0.0f ? PRESSED_GAP * row->requested : row->requested;
    const bool may_lack = row->distance < gap || row->normal_impulse > 0.0f;
    const float short_by =
        may_lack ? contact_smaller( gap, row->distance + step ) - distance_of( s->now, row ) : 0.0f;
    const float mobility = short_by > 0.0f ? mobility_along( s, row, row->normal, NULL ) : 0.0f;
    if ( mobility > 0.0f )
    {
        const float length = contact_smaller( short_by, step ) / mobility;
        const float by[3] = { length * row->normal[0], length * row->normal[1], length * row->normal[2] };
        push( s, row, by, true );
    }
    return may_lack;
}

static void run_blocks( void* context, int begin, int end, int worker )
{
    (void)worker;
    const project_loop* loop = context;
    const contact_contact_mesh* s = loop->work->contact_mesh;
    for ( int i = begin; i < end; ++i )
    {
        const int block = loop->order[i], first = s->colouring->begin[block],
                  count = s->colouring->begin[block + 1] - first;
        uint64_t *noted = s->colouring->near + block, near = 0;
        const uint64_t all = count < ROWS_PER_BLOCK ? ( UINT64_C( 1 ) << count ) - 1 : UINT64_MAX;
        for ( uint64_t left = loop->rows == NEAR_ROWS ? *noted : all; left != 0; left &= left - 1 )
        {
            const uint64_t bit = left & -left;
            near |= loop->run( loop->work, s->constraints->rows + first + __builtin_ctzll( left ) ) ? bit : 0;
        }
        *noted = loop->rows == FOUND_ROWS ? near : *noted;
    }
}

static void run_all( const contact_work* work, row_fn* run, sweep_rows rows )
{
    const contact_colouring* blocks = work->contact_mesh->colouring;
    for ( int colour = 0; colour < CONTACT_COLOURS; ++colour )
    {
        const int first = blocks->colour[colour], count = blocks->colour[colour + 1] - first;
        project_loop loop = { work, blocks->order + first, run, rows };
        const int grain = colour + 1 < CONTACT_COLOURS ? 1 : count; // the last colour runs serially
        if ( count > 0 )
        {
            wisp_parallel_for( work->parallel, count, grain, run_blocks, &loop );
        }
    }
}

// ---- bodies ----

typedef struct bodies_loop
{
    const contact_work* work;
    const contact_participant* participant;
    bool presses; // else it lets go of what is lifted
} bodies_loop;

// Return whether a point is off a half space that has pushed it: its edges and triangles were pushed farther. A sweep would take
// back what the half space pushed, and with it what they did.
static bool is_lifted( const float* half, const float* p )
{
    const float away = half[3] * ( p[0] - half[0] ) + half[4] * ( p[1] - half[1] ) + half[5] * ( p[2] - half[2] );
    return away > ( 1.0f + LIFTED ) * half[9];
}

// Note which half space presses most on each point.
static void find_holds( const bodies_loop* loop, int begin, int end )
{
    const contact_participant* participant = loop->participant;
    const contact_contact_mesh* s = loop->work->contact_mesh;
    for ( int n = begin; n < end; ++n )
    {
        const int i = s->held[participant->first_point + n], point = participant->first_point + i;
        float **hold = s->colouring->hold + point, most = 0.0f;
        *hold = NULL;
        for ( int k = 0; k < participant->half_spaces[i] && k < WISP_MAX_HALF_SPACES; ++k )
        {
            float* half = participant->half_space_row + 16 * ( (size_t)i * WISP_MAX_HALF_SPACES + (size_t)k );
            if ( loop->presses == false && is_lifted( half, s->now + (size_t)point * 4 ) )
            {
                memset( half + 10, 0, 4 * sizeof( float ) ); // corrections along the normal and across it
            }
            *hold = half[10] > most ? half : *hold;
            most = contact_larger( most, half[10] );
        }
    }
}

// Note whom and what rows may push. What they do not push needs no further sweep: being counted changes no motion.
static void find_pushed( const contact_work* work )
{
    contact_contact_mesh* s = work->contact_mesh;
    memset( s->is_pushed, 0, (size_t)s->point_count );
    for ( int g = 0; g < work->participant_count; ++g )
    {
        work->participants[g].is_pushed = false;
    }
    const contact_constraints* c = s->constraints;
    for ( int r = 0; r < c->row_count; ++r )
    {
        const contact_row* row = c->rows + r;
        contact_participant_of( work, row->point[0] )->is_pushed = true;
        contact_participant_of( work, row->point[CONTACT_MAX_POINTS - 1] )->is_pushed = true;
        for ( int i = 0; i < CONTACT_MAX_POINTS; ++i )
        {
            s->is_pushed[row->point[i]] = 1;
        }
    }
}

// List the free points in half spaces of participants that are pushed.
static void list_held( const contact_work* work )
{
    const contact_contact_mesh* s = work->contact_mesh;
    memset( s->colouring->hold, 0, (size_t)s->point_count * sizeof( float* ) );
    for ( int g = 0; g < work->participant_count; ++g )
    {
        contact_participant* participant = work->participants + g;
        const bool is_held =
            participant->is_pushed && participant->half_spaces != NULL && participant->half_space_row != NULL;
        participant->held_count = 0;
        for ( int i = 0, point = participant->first_point; i < participant->point_count && is_held; ++i, ++point )
        {
            s->held[participant->first_point + participant->held_count] = i;
            participant->held_count +=
                participant->half_spaces[i] > 0 && s->now[(size_t)point * 4 + 3] > 0.0f ? 1 : 0;
        }
    }
}

// Another sweep over the half spaces of points: what rows pushed into bodies comes out, with friction.
static void press_on_bodies( void* context, int begin, int end, int worker )
{
    (void)worker;
    const bodies_loop* loop = context;
    const contact_participant* participant = loop->participant;
    contact_contact_mesh* s = loop->work->contact_mesh;
    const int32_t* held = s->held + participant->first_point;
    const size_t first = (size_t)participant->first_point * 4;
    int32_t particle_x4[BODY_GRAIN + WISP_SLICE], row_x16[BODY_GRAIN + WISP_SLICE];
    const wisp_half_space_args args = { s->now + first, s->intersection_free + first, participant->half_space_row,
                                        particle_x4, row_x16 };
    for ( int k = 0, count = 1; k < WISP_MAX_HALF_SPACES && count > 0 && loop->presses; ++k )
    {
        count = 0;
        for ( int n = begin; n < end; ++n )
        {
            particle_x4[count] = 4 * held[n];
            row_x16[count] = 16 * ( WISP_MAX_HALF_SPACES * held[n] + k );
            count += participant->half_spaces[held[n]] > k ? 1 : 0;
        }
        for ( int i = count; count > 0 && i % WISP_SLICE != 0; ++i )
        {
            particle_x4[i] = particle_x4[count - 1];
            row_x16[i] = row_x16[count - 1];
        }
        wisp_frame_kernels( loop->work->frame )->half_space( &args, 0, count );
    }
    find_holds( loop, begin, end );
}

static void project_bodies( const contact_work* work, bool presses )
{
    for ( int g = 0; g < work->participant_count; ++g )
    {
        bodies_loop loop = { work, work->participants + g, presses };
        wisp_parallel_for( work->parallel, loop.participant->held_count, BODY_GRAIN, press_on_bodies, &loop );
    }
}

static bool press_row( const contact_work* work, contact_row* row )
{
    return row->normal_impulse > 0.0f && project_row( work, row );
}

void contact_project_rows( const contact_work* work, bool is_turn )
{
    run_all( work, project_row, is_turn ? NEAR_ROWS : FOUND_ROWS );
    project_bodies( work, true );
    if ( work->memory->tangled == 0 ) // else it would press on what is drawn apart
    {
        run_all( work, press_row, NEAR_ROWS ); // a heavy sheet on two light ones comes to rest by it
        project_bodies( work, true );
    }
}

// ---- impulses that outlive the substep ----

// Return where a pair keeps its impulse, or else the first free place for it, or null. The first point with a free place
// ends the search. Strands keep none.
static float* find_kept( const contact_work* work, const contact_row* row, bool is_new )
{
    for ( int i = 0; i < CONTACT_MAX_POINTS; ++i )
    {
        const contact_participant* participant = contact_participant_of( work, row->point[i] );
        contact_load* load =
            participant->loads != NULL ? participant->loads + ( row->point[i] - participant->first_point ) : NULL;
        for ( int k = 0; k < CONTACT_KEPT && load != NULL; ++k )
        {
            if ( load->key[k] == row->key )
            {
                return load->impulse[k];
            }
            if ( load->key[k] == 0 )
            {
                if ( is_new )
                {
                    load->key[k] = row->key;
                }
                return is_new ? load->impulse[k] : NULL;
            }
        }
    }
    return NULL;
}

static void warm_rows( void* context, int begin, int end, int worker )
{
    (void)worker;
    const contact_work* work = context;
    for ( int r = begin; r < end; ++r )
    {
        contact_row* row = work->contact_mesh->constraints->rows + r;
        const bool may_press = row->distance < WARM_GAP * row->requested;
        const float* kept = may_press ? find_kept( work, row, false ) : NULL;
        if ( kept != NULL )
        {
            row->normal_impulse = kept[0];
            memcpy( row->tangential_impulse, kept + 1, sizeof( row->tangential_impulse ) );
        }
    }
}

static bool push_warm( const contact_work* work, contact_row* row )
{
    float by[3];
    for ( int k = 0; k < 3; ++k )
    {
        by[k] = row->normal_impulse * row->normal[k] + row->tangential_impulse[k];
    }
    if ( row->normal_impulse > 0.0f )
    {
        note_squeezed( work->contact_mesh, row );
        push( work->contact_mesh, row, by, false );
    }
    return row->normal_impulse > 0.0f;
}

void contact_begin_rows( const contact_work* work, bool is_first )
{
    if ( is_first )
    {
        // kept impulses would hold what is drawn apart
        const int count = work->memory->tangled == 0 ? work->contact_mesh->constraints->row_count : 0;
        wisp_parallel_for( work->parallel, count, WARM_GRAIN, warm_rows, (void*)(uintptr_t)work );
        find_pushed( work );
    }
    list_held( work );
    project_bodies( work, false );
    if ( is_first )
    {
        run_all( work, push_warm, ALL_ROWS );
        project_bodies( work, true );
    }
}

void contact_keep_impulses( const contact_work* work )
{
    const contact_contact_mesh* s = work->contact_mesh;
    for ( int g = 0; g < work->participant_count; ++g )
    {
        const contact_participant* participant = work->participants + g;
        if ( participant->loads != NULL && participant->is_left_out == false )
        {
            memset( participant->loads, 0, (size_t)participant->point_count * sizeof( contact_load ) );
        }
    }
    for ( int r = 0; r < s->constraints->row_count; ++r )
    {
        const contact_row* row = s->constraints->rows + r;
        const bool keeps = row->normal_impulse > 0.0f && ( row->is_lever || row->is_squeezed ) == false;
        float* kept = keeps ? find_kept( work, row, true ) : NULL;
        if ( kept != NULL )
        {
            kept[0] = row->normal_impulse;
            memcpy( kept + 1, row->tangential_impulse, sizeof( row->tangential_impulse ) );
        }
    }
}

void contact_recover( const contact_work* work )
{
    run_all( work, recover_row, ALL_ROWS );
}

// Colouring: constraints in blocks of 64 that one worker projects from first to last, coloured greedily so that
// blocks of one colour share no point. In: rows. Out: blocks in the order of their colours. Blocks do not depend on
// the number of workers.

static void cut_blocks( contact_colouring* blocks, int split, int count )
{
    blocks->count = 0;
    for ( int begin = 0; begin < count; )
    {
        const int most = begin < split ? split : count;
        blocks->begin[blocks->count++] = begin;
        begin = begin + ROWS_PER_BLOCK < most ? begin + ROWS_PER_BLOCK : most;
    }
    blocks->begin[blocks->count] = count;
}

// Take the lowest colour that no point of the block has yet. Blocks without one get the last colour, which runs
// serially.
static int colour_block( contact_contact_mesh* s, int begin, int end )
{
    uint64_t taken = 0;
    for ( int r = begin; r < end; ++r )
    {
        for ( int i = 0; i < CONTACT_MAX_POINTS; ++i )
        {
            taken |= s->colouring->of_point[s->constraints->rows[r].point[i]];
        }
    }
    int colour = 0;
    while ( colour < CONTACT_COLOURS - 1 && ( taken >> colour & 1 ) != 0 )
    {
        colour += 1;
    }
    for ( int r = begin; r < end; ++r )
    {
        for ( int i = 0; i < CONTACT_MAX_POINTS; ++i )
        {
            s->colouring->of_point[s->constraints->rows[r].point[i]] |= UINT64_C( 1 ) << colour;
        }
    }
    return colour;
}

static void colour_blocks( contact_contact_mesh* s )
{
    contact_colouring* blocks = s->colouring;
    memset( blocks->colour, 0, sizeof( blocks->colour ) );
    memset( blocks->of_point, 0, (size_t)s->point_count * sizeof( *blocks->of_point ) );
    for ( int b = 0; b < blocks->count; ++b )
    {
        blocks->colour_of[b] = colour_block( s, blocks->begin[b], blocks->begin[b + 1] );
        blocks->colour[blocks->colour_of[b] + 1] += 1;
    }
    for ( int i = 0; i < CONTACT_COLOURS; ++i )
    {
        blocks->colour[i + 1] += blocks->colour[i];
    }
    int next[CONTACT_COLOURS];
    memcpy( next, blocks->colour, sizeof( next ) );
    for ( int b = 0; b < blocks->count; ++b )
    {
        blocks->order[next[blocks->colour_of[b]]++] = b;
    }
}

bool contact_reserve_colouring( const contact_work* work )
{
    contact_colouring* c = work->contact_mesh->colouring;
    const size_t points = (size_t)work->contact_mesh->point_count;
    const bool enough = contact_reserve(
        work, &c->point_buffer, points * ( sizeof( *c->of_point ) + sizeof( *c->hold ) ), (void**)&c->of_point );
    c->hold = enough ? (float**)( c->of_point + points ) : NULL;
    return enough;
}

wisp_status contact_colour_rows( const contact_work* work, wisp_error* error )
{
    contact_contact_mesh* s = work->contact_mesh;
    contact_colouring* c = s->colouring;
    c->count = 0;
    const size_t most = (size_t)( s->constraints->row_count / ROWS_PER_BLOCK + 2 ), index = sizeof( int32_t );
    wisp_buffer* b = c->buffers;
    if ( contact_reserve( work, b++, ( most + 1 ) * index, (void**)&c->begin ) == false ||
         contact_reserve( work, b++, most * index, (void**)&c->colour_of ) == false ||
         contact_reserve( work, b++, most * index, (void**)&c->order ) == false ||
         contact_reserve( work, b++, most * sizeof( *c->near ), (void**)&c->near ) == false )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "out of memory for blocks of %d pairs", s->constraints->row_count );
    }
    cut_blocks( c, s->constraints->split, s->constraints->row_count );
    colour_blocks( s );
    return WISP_OK;
}
